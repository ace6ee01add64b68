#pragma once
/// The virtual tool on triangles and the god-object of core/reference, led by the same hand.
#include <memory>
#include <optional>
#include <vector>

#include "core/reference/god_object.hpp"
#include "core/reference/inside_test.hpp"
#include "tests/experiments/exact_truth/surfaces.hpp"
#include "tests/unit/exact/rig.hpp"

namespace voxtouch::exact_truth {

/// Bounds of an agreement.
inline constexpr double kDirectionDeg = 0.1, kForceRatio = 0.003;

/// Angle between two forces and relative difference of their sizes.
struct Difference {
  double direction_deg = 0.0, force_ratio = 0.0;
  double arm_m = 0.0;  ///< difference of the torques over the force
  bool agrees() const {
    return direction_deg <= kDirectionDeg && std::abs(force_ratio) <= kForceRatio;
  }
};

struct Comparison {
  Pose hand;
  Difference difference;  ///< of the virtual tool from the reference, both led by the same hand
  /// Distance of the virtual tool from a reference that starts at the virtual tool's pose: small if
  /// that pose is a minimum, even if the reference found another one.
  std::optional<Difference> from_its_pose;
  double energy_ratio = 0.0;  ///< of the virtual tool over the reference, minus 1
  bool settled = false;       ///< the reference did
  bool converged = false;     ///< the virtual tool did
  double reference_s = 0.0;   ///< CPU time
};

/// A ball of `levels` subdivisions on a surface.
class Comparer {
 public:
  /// `offset_m`: the virtual tool's surface is moved so far along z, the reference's is not.
  Comparer(const Surface& surface, int levels, double offset_m = 0.0);

  /// Pressed `depth_m` deep at a random spot with a random attitude. None if the ball has no room
  /// there.
  std::optional<Comparison> at_random(std::mt19937_64& random, double depth_m);

  std::size_t tool_vertices() const { return rig_.tool.features().points.size(); }

  static constexpr double kRadius = 0.01;  ///< of the ball [m]

 private:
  Surface surface_;
  exact::Rig rig_;
  reference::GodObject god_object_;
  reference::InsideTest inside_;
};

}  // namespace voxtouch::exact_truth
