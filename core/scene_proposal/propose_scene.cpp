#include "core/scene_proposal/propose_scene.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "core/scene_proposal/measure_part.hpp"
#include "core/types/motion.hpp"

namespace voxtouch::scene_proposal {
namespace {

constexpr double kVoxelsInWall = 4.0;  ///< of a wall, for the distances in it to be right
constexpr double kCoarsest = 100.0,
                 kFinest =
                     220.0;  ///< voxels along the part's largest extent: 220 cubed are 11 million
constexpr double kSmallestSphereVoxels = 4.0, kSphereRatio = 15.0, kLargestSphereM = 0.015;
constexpr double kPressM = 0.01, kSlideM = 0.005;  ///< how deep the hand wants to go
constexpr double kApproachS = 1.5, kSlowest = 0.03,
                 kFastest = 0.15;  ///< to the surface and in; peak speeds [m/s]

/// Rounds down to two digits.
double rounded_down(double x) {
  const double digit = std::pow(10.0, std::floor(std::log10(x)) - 1.0);
  return std::floor(x / digit * (1.0 + 1e-12)) * digit;
}

}  // namespace

Tool tool_of(const mesh::TriangleMesh& mesh) {
  Vec3 low = mesh.vertices.front(), high = low, lowest = low;
  for (const Vec3& x : mesh.vertices) {
    low = low.cwiseMin(x), high = high.cwiseMax(x);
    if (x.z() < lowest.z())
      lowest = x;
  }
  return {.sphere = false, .reach_m = 0.5 * (high - low).maxCoeff(), .lowest_T = lowest};
}

ProposedScene propose_scene(const mesh::TriangleMesh& part, const mesh::MeshReport& report,
                            Tool tool) {
  const Vec3 extents = report.max - report.min;
  const double largest = extents.maxCoeff();
  if (!(largest > 0.0))
    throw std::invalid_argument("the part has no extent: all its vertices coincide");
  ProposedScene scene;
  const auto because = [&](std::string reason) { scene.reasons.push_back(std::move(reason)); };

  const auto wall = report.closed ? wall_thickness_m(part) : std::nullopt;
  const double requested = wall ? *wall / kVoxelsInWall : largest / kCoarsest;
  scene.voxel_size_m = rounded_down(std::clamp(requested, largest / kFinest, largest / kCoarsest));
  const double e = scene.voxel_size_m;
  if (wall)
    because(
        fmt::format("Nine tenths of the part are at least {:.3g} mm thick. Voxel edge {:.3g} mm: "
                    "{:.1f} voxels in such a wall.",
                    1e3 * *wall, 1e3 * e, *wall / e));
  if (wall && *wall < 2.0 * e)
    because(
        fmt::format("This is too few for thin walls: voxels finer than 1/{:.0f} of the part need "
                    "much memory. Set voxel_size to change it.",
                    kFinest));
  because(
      report.closed
          ? "The part is closed: the virtual tool stays outside."
          : "The part is open: its sheets stop the virtual tool from both sides, like thin walls.");

  if (tool.sphere) {
    tool.reach_m = rounded_down(
        std::max(kSmallestSphereVoxels * e, std::min(largest / kSphereRatio, kLargestSphereM)));
    tool.lowest_T = Vec3(0.0, 0.0, -tool.reach_m);
    because(fmt::format("The tool is a sphere of radius {:.3g} mm.", 1e3 * tool.reach_m));
  }
  scene.tool = tool;

  // W is the part's frame. The tool's lowest point moves down onto `touch`.
  const Vec3 touch = place_to_touch(part), at = touch - tool.lowest_T;
  const double top = report.max.z() - touch.z();  // height of the part above that place
  const double clear = top + std::max(4.0 * e, 0.3 * tool.reach_m);
  const auto along_z = [&](const Vec3& x, double z) { return Vec3(x + z * Vec3::UnitZ()); };
  scene.press_W = {along_z(at, clear), along_z(at, -kPressM)};
  const Vec3 aside = at + Vec3(extents.x() / 6.0, 0.0, 0.0),
             back = at - Vec3(extents.x() / 6.0, 0.0, 0.0);
  scene.slide_W = {along_z(back, clear), along_z(back, -kSlideM), along_z(aside, -kSlideM),
                   along_z(aside, clear)};
  scene.press_speed_m_per_s =
      std::clamp(kMinimumJerkPeak * (clear + kPressM) / kApproachS, kSlowest, kFastest);
  scene.slide_speed_m_per_s = std::max(scene.press_speed_m_per_s, 0.05);
  because(
      fmt::format("Motion `press` moves down at ({:.3g}, {:.3g}) mm to {:.3g} mm below the "
                  "surface; `slide` moves {:.3g} mm across.",
                  1e3 * at.x(), 1e3 * at.y(), 1e3 * kPressM, 1e3 * extents.x() / 3.0));
  return scene;
}

}  // namespace voxtouch::scene_proposal
