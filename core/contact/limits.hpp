#pragma once
#include <cstddef>

/// All thresholds of the contact models. Lengths are in voxel edges of the static grid.
namespace voxtouch::contact::limits {

/// `adapted` uses `original` for a frame with |sum n| / |S| of at most this: opposite normals.
inline constexpr double kFallbackCoherence = 0.3;

/// The stage replaces that switch by a smoothstep of the coherence between these two values.
inline constexpr double kBlendFrom = 0.2;  ///< own normals up to here
inline constexpr double kBlendTo = 0.5;    ///< mean normal from here on

/// A shorter blended direction is not normalised: if mean and own normal are opposite, the point's
/// force fades through zero instead of reversing at full strength.
inline constexpr double kShortestDirection = 0.1;

/// Least depth of a latched point, because the centre of its last surface voxel may have been in
/// front of it.
inline constexpr double kLatchedDepthFloorEdges = 0.25;

/// Depth of a point that appears in the interior without having been in the surface layer.
inline constexpr double kUnseenDepthEdges = 1.0;

/// Decrease of a latched depth per metre of tool motion once its point is back in the surface
/// layer. 1 is the slope of the plain law on the way out, so a straight motion in and out generates
/// no energy.
inline constexpr double kFadePerMetre = 1.0;

/// The common latched direction follows the present mean fully if their cosine is at least
/// `kAgreeTo`, and not at all below `kAgreeFrom`. Beyond a sphere's equator the normals of the rim
/// point into the wall.
inline constexpr double kAgreeFrom = 0.0;
inline constexpr double kAgreeTo = 0.5;

/// A point that moves farther between two poses may jump over the force zone of the surface layer.
/// The layer is one voxel thick wherever a triangle passes, for any wall. `original` and `adapted`
/// have force in the half behind the voxel centre.
inline constexpr double kFastEdges = 0.5;

/// `field`, see ContactResult::saturated: if the gradient is smaller, the point is near the middle
/// of a body and its force does not grow. Between two perpendicular faces the gradient is 0.71,
/// between three 0.58.
inline constexpr double kFlatGradient = 0.5;

/// Added to every radius of the culling tree: covers the rounding of u up to 2^31 voxels (about
/// 1e-5) with ample margin.
inline constexpr double kCullSafetyVoxels = 1e-3;

/// Larger grid coordinates do not fit int32.
inline constexpr double kMaxGridCoordinate = 2147483000.0;

/// Quaternion norms that the query accepts and normalises. Samples of a device are checked more
/// strictly at their arrival.
inline constexpr double kMinQuaternionNorm = 1e-3;
inline constexpr double kMaxQuaternionNorm = 1e3;

}  // namespace voxtouch::contact::limits
