#pragma once
/// Where a tool may touch a scene: places found by the reference alone, the same for every contact
/// model.
#include <cstdint>
#include <functional>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::accuracy {

/// A tool that just touches, and the way in.
struct ContactPlace {
  Pose touch;                ///< T in W, with a gap of nothing
  Vec3 into = Vec3::Zero();  ///< unit: against the static surface's normal where it was aimed at

  /// The tool `depth_m` further in (negative: before the touch).
  Pose at(double depth_m) const noexcept {
    return {touch.position + depth_m * into, touch.orientation};
  }
};

/// Up to `count` places; fewer where most of the surface cannot be reached (a narrow slot). The
/// same for the same seed, everywhere. Reads the scene's meshes itself; `progress` receives the
/// fraction that has been found. Throws std::runtime_error naming a file that cannot be read.
std::vector<ContactPlace> contact_places(const scene::Scene& scene, std::uint32_t count,
                                         std::uint64_t seed,
                                         const std::function<void(double fraction)>& progress = {});

}  // namespace voxtouch::accuracy
