#pragma once
/// Places at which a tool may touch a scene, found by the reference, independent of the contact
/// model.
#include <cstdint>
#include <functional>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::accuracy {

/// A tool that just touches, and the direction into the surface.
struct ContactPlace {
  Pose touch;                ///< T in W, with a gap of nothing
  Vec3 into = Vec3::Zero();  ///< unit; opposite to the static surface's normal at the target point

  /// The tool `depth_m` further in (negative: before the touch).
  Pose at(double depth_m) const noexcept {
    return {touch.position + depth_m * into, touch.orientation};
  }
};

/// Up to `count` places; fewer if most of the surface cannot be reached (a narrow slot).
/// Deterministic for a seed on every machine. Reads the scene's meshes; `progress` receives the
/// fraction found. Throws std::runtime_error naming an unreadable file.
std::vector<ContactPlace> contact_places(const scene::Scene& scene, std::uint32_t count,
                                         std::uint64_t seed,
                                         const std::function<void(double fraction)>& progress = {});

}  // namespace voxtouch::accuracy
