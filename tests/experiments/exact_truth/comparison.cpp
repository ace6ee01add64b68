#include "tests/experiments/exact_truth/comparison.hpp"

#include <cmath>
#include <ctime>

namespace voxtouch::exact_truth {
namespace {

double cpu_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

reference::ReferenceMesh solid(const mesh::TriangleMesh& mesh) {
  return reference::make_reference_mesh(mesh.vertices, mesh.triangles, "mesh of an experiment");
}

Difference difference(const Wrench& given, const Wrench& truth) {
  return {exact::angle_between(given.force, truth.force) / exact::kDegree,
          given.force.norm() / truth.force.norm() - 1.0,
          (given.torque - truth.torque).norm() / truth.force.norm()};
}

double energy(const Vec3& shift, const Vec3& rotation, double lever_m) {
  return shift.squaredNorm() + lever_m * lever_m * rotation.squaredNorm();
}

}  // namespace

Comparer::Comparer(const Surface& surface, int levels, double offset_m)
    : surface_(surface),
      rig_(test::ball(kRadius, levels),
           test::moved(surface.mesh, {{0.0, 0.0, offset_m}, Quat::Identity()})),
      god_object_(solid(test::ball(kRadius, levels)), solid(surface.mesh)),
      inside_(solid(surface.mesh)) {}

std::optional<Comparison> Comparer::at_random(std::mt19937_64& random, double depth_m) {
  constexpr double kStartM = 1e-3, kStepM = 2.5e-4;
  constexpr int kRestFrames = 300;
  const Spot spot = random_spot(surface_, random);
  const Quat turn = random_rotation(random);
  const auto at = [&](double gap_m) {
    return Pose{spot.point + (kRadius + gap_m) * spot.normal, turn};
  };
  if (inside_.inside(at(kStartM).position))
    return std::nullopt;
  Comparison out;
  out.hand = at(-depth_m);
  const double begin = cpu_s();
  const auto truth = god_object_.led(at(kStartM), out.hand);
  out.reference_s = cpu_s() - begin;
  if (!truth || !rig_.virtual_tool.place(at(kStartM), {&rig_.object_pose, 1}))
    return std::nullopt;
  rig_.lead(at(kStartM), out.hand, static_cast<int>(std::ceil((kStartM + depth_m) / kStepM)));
  const exact::VirtualToolFrame frame = rig_.rest(out.hand, kRestFrames);
  const Wrench given = frame.wrench(1.0);
  out.difference = difference(given, truth->wrench());
  out.energy_ratio = energy(frame.shift, frame.rotation, frame.lever_m) /
                         energy(truth->shift, truth->rotation, truth->lever_m) -
                     1.0;
  out.settled = truth->settled && truth->apart_m > 0.0;
  out.converged = !frame.not_converged;
  if (!out.difference.agrees())
    if (const auto same = god_object_.pulled(frame.tool, out.hand))
      out.from_its_pose = difference(given, same->wrench());
  return out;
}

}  // namespace voxtouch::exact_truth
