/// Table of the virtual tool on triangles against the god-object of core/reference, both with the
/// same mesh as tool.
#include <algorithm>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "tests/experiments/exact_truth/comparison.hpp"

namespace voxtouch::exact_truth {
namespace {

double at_part(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

void print_miss(const Comparison& c) {
  const Vec3& p = c.hand.position;
  const Quat& q = c.hand.orientation;
  fmt::print(
      "    missed at ({:.6f} {:.6f} {:.6f}), w x y z {:.6f} {:.6f} {:.6f} {:.6f}: {:.3f} deg, "
      "{:+.3f} %, energy {:+.4f} %{}{}\n",
      p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(), c.difference.direction_deg,
      100.0 * c.difference.force_ratio, 100.0 * c.energy_ratio,
      c.converged ? "" : ", virtual tool not converged",
      c.settled ? "" : ", reference not settled");
  if (c.from_its_pose)
    fmt::print("      from its own pose: {:.4f} deg, {:+.4f} %\n", c.from_its_pose->direction_deg,
               100.0 * c.from_its_pose->force_ratio);
}

/// \returns how many places are beyond the bounds.
int print_surface(const Surface& surface, int levels, double depth_m, int places,
                  std::uint64_t seed) {
  Comparer comparer(surface, levels);
  std::mt19937_64 random(seed);
  std::vector<double> directions, forces, arms;
  int misses = 0, other_minima = 0;
  double reference_s = 0.0;
  for (int tried = 0; tried < 10 * places && std::ssize(directions) < places; ++tried) {
    const auto c = comparer.at_random(random, depth_m);
    if (!c)
      continue;
    directions.push_back(c->difference.direction_deg);
    forces.push_back(std::abs(c->difference.force_ratio));
    arms.push_back(c->difference.arm_m);
    reference_s += c->reference_s;
    if (c->difference.agrees() && c->settled)
      continue;
    ++misses;
    other_minima += c->from_its_pose && c->from_its_pose->agrees() ? 1 : 0;
    print_miss(*c);
  }
  fmt::print(
      "  {:<14} {:>6} {:>7.3f} {:>6} {:>9.4f} {:>9.4f} {:>8.3f} {:>8.3f} {:>8.4f} {:>7} {:>7} "
      "{:>7.0f}\n",
      surface.name, comparer.tool_vertices(), 1e3 * depth_m, directions.size(),
      at_part(directions, 0.5), at_part(directions, 1.0), 100.0 * at_part(forces, 0.5),
      100.0 * at_part(forces, 1.0), 1e3 * at_part(arms, 1.0), misses, other_minima,
      1e3 * reference_s / static_cast<double>(directions.size()));
  std::fflush(stdout);
  return misses;
}

}  // namespace
}  // namespace voxtouch::exact_truth

int main(int argc, char** argv) {
  using namespace voxtouch::exact_truth;
  CLI::App app("Compares the virtual tool on triangles with the god-object of the same meshes");
  std::vector<std::string> names{"plane", "cylinder", "fine_cylinder", "cup"};
  std::vector<int> levels{3, 4};
  std::vector<double> depths{1e-3};
  int places = 50;
  std::uint64_t seed = 1;
  app.add_option("--surfaces", names, "plane, cylinder, fine_cylinder, cup")->delimiter(',');
  app.add_option("--levels", levels, "Subdivisions of the ball: 3 has 642 vertices, 4 has 2562")
      ->delimiter(',');
  app.add_option("--depths", depths, "Depths of the hand [m]")->delimiter(',');
  app.add_option("--places", places, "Places per surface")->check(CLI::Range(1, 1'000'000));
  app.add_option("--seed", seed, "Seed of the places");
  CLI11_PARSE(app, argc, argv);
  fmt::print(
      "  surface         points  depth  places   direction [deg]      force [%]        torque "
      " misses   other  reference\n"
      "                          [mm]            median     worst   median    worst     [mm]  "
      "        minimum  [ms]\n");
  int misses = 0;
  for (const std::string& name : names)
    for (const int level : levels)
      for (const double depth : depths)
        misses += print_surface(surface(name), level, depth, places, seed);
  fmt::print("{} ({} places beyond {} deg or {} %)\n", misses == 0 ? "PASSED" : "FAILED", misses,
             kDirectionDeg, 100.0 * kForceRatio);
  return misses == 0 ? 0 : 1;
}
