#include "tests/validator/walks.hpp"

#include <fmt/format.h>

#include <cmath>
#include <random>

#include "core/types/motion.hpp"

namespace voxtouch::test {
namespace {

constexpr double kDurationS = 10.0, kSampleTimeS = 1e-3;
constexpr double kOffsetInEdges = 1.5;

/// Uniform in [low, high), the same on every standard library.
double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
}

Quat random_rotation(std::mt19937_64& random) {
  for (;;) {
    const auto any = [&] { return uniform(random, -1, 1); };
    Quat q;
    for (double& c : q.coeffs())
      c = any();
    if (q.norm() > 0.1 && q.norm() < 1.0)
      return q.normalized();
  }
}

Perturbation random_perturbation(std::mt19937_64& random, double edge_m) {
  const double reach = kOffsetInEdges * edge_m;
  Perturbation out;
  for (double& x : out.offset)
    x = uniform(random, -reach, reach);
  out.turn = random_rotation(random);
  return out;
}

/// As the rendering node publishes a frame and the validator reads it.
reference::ReportedContact to_report(const contact::StageResult& result, const Pose& tool) {
  const contact::ContactResult& c = result.contact;
  reference::ReportedContact report;
  report.pose_WT = tool;
  report.wrench = c.wrench;
  report.mean_normal = c.mean_normal;
  report.deepest_depth_m = c.deepest_depth_m;
  report.coherence = c.coherence;
  report.surface_hits = c.surface_hits;
  report.interior_hits = c.interior_hits;
  report.latched = result.latched;
  report.fallback = c.fallback;
  return report;
}

scene::Scene on_handle(scene::Scene scene, const Vec3& tool_to_sphere) {
  scene.dynamic_mesh.pose.position += tool_to_sphere;
  return scene;
}

}  // namespace

std::size_t Walk::contacts() const {
  std::size_t count = 0;
  for (const reference::GapResult& gap : gaps)
    count += gap.gap_m < 0;
  return count;
}

Outcome& Outcome::operator+=(const Outcome& other) {
  const reference::ValidationCounts& more = other.counts;
  counts.checked += more.checked, counts.decided += more.decided, counts.agree += more.agree;
  counts.in_band += more.in_band, counts.disagree += more.disagree;
  counts.rendering += more.rendering, counts.reference += more.reference;
  if (first.empty())
    first = other.first;
  return *this;
}

Ground::Ground(scene::Scene scene, const Vec3& tool_to_sphere)
    : scene_(on_handle(std::move(scene), tool_to_sphere)),
      tool_to_sphere_(tool_to_sphere),
      built_(rendering::build_scene(scene_, serial_for())),
      reference_(scene_) {}

reference::ValidatorSettings Ground::settings() const {
  reference::ValidatorSettings settings;
  const double e = settings.edge_m = scene_.voxel_size_m;
  settings.chord_error_m = reference_.chord_error_m();
  settings.shell_gap_m = std::min(built_->largest_shell_gap_m(), std::sqrt(3.0) * e);
  settings.shell_offset_m = scene_.shell == scene::ShellKind::kNaive ? std::sqrt(3.0) / 2 * e : 0.0;
  return settings;
}

Pose Ground::tool_for(const Vec3& sphere_centre, const Quat& orientation) const {
  return {sphere_centre - orientation * tool_to_sphere_, orientation};
}

void Ground::add_gaps(Walk& walk) const {
  for (std::size_t n = 0; n < walk.poses.size(); n += walk.every)
    walk.gaps.push_back(reference_.gap(walk.poses[n]));
}

Walk Ground::motion(const std::string& name, const Perturbation& perturbation) const {
  const Motion& motion = scene_.motions.at(name);
  Walk walk{name, {}, 20, false, {}};
  const Quat orientation = perturbation.turn * motion.orientation;
  for (int n = 0; n < static_cast<int>(kDurationS / kSampleTimeS); ++n)
    walk.poses.push_back(
        tool_for(motion_at(motion, n * kSampleTimeS).position + perturbation.offset, orientation));
  add_gaps(walk);
  return walk;
}

Walk Ground::scattered(const std::string& name, std::size_t count, unsigned seed) const {
  const Motion& motion = scene_.motions.at(name);
  Walk walk{name + ", scattered", {}, 1, true, {}};
  std::mt19937_64 random(seed);
  for (std::size_t n = 0; n < count; ++n) {
    const Vec3 target = motion_at(motion, uniform(random, 0, kDurationS)).position;
    const Perturbation by = random_perturbation(random, scene_.voxel_size_m);
    walk.poses.push_back(tool_for(target + by.offset, by.turn * motion.orientation));
  }
  add_gaps(walk);
  return walk;
}

std::vector<Walk> Ground::walks() const {
  std::vector<Walk> walks;
  std::mt19937_64 random(20240611);
  unsigned seed = 1;
  for (const char* name : {"hit", "slide", "circle", "free"}) {
    walks.push_back(motion(name));
    walks.push_back(motion(name, random_perturbation(random, scene_.voxel_size_m)));
    walks.back().name += ", displaced";
    walks.push_back(scattered(name, 300, seed++));
  }
  return walks;
}

Outcome Ground::judged(const Walk& walk, const Fault& fault) const {
  contact::ContactRenderer& renderer = fault.renderer ? *fault.renderer : built_->renderer();
  const Fault::Tamper tamper =
      fault.tamper ? fault.tamper() : [](std::size_t, reference::ReportedContact&) {};
  reference::ContactValidator validator(settings());
  Outcome outcome;
  renderer.reset();
  for (std::size_t n = 0; n < walk.poses.size(); ++n) {
    if (walk.jumps)
      renderer.reset();
    Pose seen = walk.poses[n];
    seen.position -=
        fault.grid_shift;  // a grid displaced in one direction equals a tool displaced in the other
    reference::ReportedContact report = to_report(renderer.render(seen), walk.poses[n]);
    tamper(n, report);
    if (n % walk.every != 0)
      continue;
    const reference::GapResult& gap = walk.gaps[n / walk.every];
    const reference::Validation found = validator.validate(gap, report);
    if (found.verdict != reference::Verdict::kDisagree || !outcome.first.empty())
      continue;
    const char* const whose =
        found.cause == reference::Cause::kReference ? "reference" : "rendering";
    outcome.first = fmt::format("{}, pose {} ({}): {}; the gap is {:.3f} e", walk.name, n, whose,
                                found.explanation, gap.gap_m / scene_.voxel_size_m);
  }
  outcome.counts = validator.counts();
  return outcome;
}

Outcome Ground::judged(const std::vector<Walk>& walks, const Fault& fault) const {
  Outcome all;
  for (const Walk& walk : walks)
    all += judged(walk, fault);
  return all;
}

pointshell::Pointshell flipped(const pointshell::Pointshell& shell) {
  pointshell::Pointshell out = shell;
  for (auto* normals : {&out.nx, &out.ny, &out.nz})
    for (double& n : *normals)
      n = -n;
  return out;
}

}  // namespace voxtouch::test
