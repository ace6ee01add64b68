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

/// The shared latched direction follows the present mean fully if their cosine is at least
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

/// Virtual tool (virtual_tool.hpp). Stiffness of one row relative to the spring's. It is hard
/// enough to give the result of the constraint, and soft enough that opposite rows need no common
/// solution.
inline constexpr double kRowStiffness = 1000.0;
/// Rows with a wider gap are skipped: no step is longer, so they cannot become active.
inline constexpr double kRowGapEdges = 0.5;
/// Longest path of any point of the tool between two queries, so that no thicker layer of surface
/// voxels is skipped.
inline constexpr double kToolStepEdges = 0.5;
/// Limits per frame: queries, queries if the last step had contact, iterations per step,
/// evaluations per line search.
inline constexpr int kMaxQueries = 8;
inline constexpr int kMaxQueriesInContact = 7;
inline constexpr int kMaxIterations = 8;
inline constexpr int kMaxLineEvaluations = 6;
/// In contact a frame ends when the remaining path is shorter than the first value. During motion
/// the limit is this fraction of the hand's path, at most the last value.
inline constexpr double kRestEdges = 1e-3;
inline constexpr double kConvergenceRatio = 0.1;
inline constexpr double kRestMostEdges = 0.02;
/// In contact the spring force does not grow beyond this length.
inline constexpr double kPullEdges = 60.0;
/// Largest number of rows in a step.
inline constexpr std::size_t kMaxRows = 96;
/// A wider row exerts no force at equilibrium, and a tool farther from equilibrium is still moving;
/// smooth normals are unnecessary there.
inline constexpr double kSmoothGapEdges = 0.1;
inline constexpr double kSmoothPathEdges = 0.4;
/// A smaller smooth gradient is bent by another face within its two voxels.
inline constexpr double kSmoothGradient = 0.99;
/// A smaller gradient has no direction.
inline constexpr double kMinGradient = 0.1;
/// A wall of about two voxels or less bends the field. Its gradient is shorter than the first
/// value, or opposes the tool's normal by more than the second. The plane of the wall's face is
/// then used, if its cosine with the tool's normal is at least the third.
inline constexpr double kSheetGradient = 0.97;
inline constexpr double kSheetAgainst = 0.5;
inline constexpr double kSheetAgree = 0.6;
/// That plane is fitted to at least this many voxel corners on the tool's side, first coarsely [e],
/// then finely. Distances beyond the last value [e] may be cut off.
inline constexpr std::size_t kSheetCorners = 3;
inline constexpr double kSheetCoarse = 0.4;
inline constexpr double kSheetFine = 0.1;
inline constexpr double kSheetFarEdges = 1.9;
/// Tolerance [e] by which the projection of a point onto that plane may be nearer to a corner than
/// the distance stored there. A larger violation means that it is beyond the rim of the face.
inline constexpr double kSheetBeyond = 0.05;
/// A row of an edge point must lead out of the static object. It must have at least this component
/// against the mean of the normals that meet there.
inline constexpr double kEdgeAgree = 0.1;
/// A pose with a deeper point is not a valid start.
inline constexpr double kPlacedDepthEdges = 0.5;
/// Neither is a pose with a wall that deep inside the tool (wall_inside.hpp). The search follows
/// walls inward from at most kMostAsked hits, in kStepsIn steps of kStepInEdges, if the tool's
/// normal has the component kShortestAlong along the wall. A thin wall lies between two points
/// whose gradients oppose each other by kOpposed. The hits within kNearEdges decide whether it is
/// inside.
inline constexpr std::size_t kMostAsked = 128;
inline constexpr int kStepsIn = 2;
inline constexpr double kStepInEdges = 0.75;
inline constexpr double kShortestAlong = 0.1;
inline constexpr double kOpposed = 0.8;
inline constexpr double kNearEdges = 1.5;
/// In contact the virtual tool moves at most as far as the hand, plus this fraction of the spring's
/// length or this many edges. An edge that gives way thus becomes a ramp.
inline constexpr double kCatchUpRatio = 0.03;
inline constexpr double kSnapEdges = 0.02;
/// A frame keeps a pose only if its energy is at most the initial one plus a tolerance. The
/// tolerance is this fraction of the spring force times the path of the hand. A resting hand thus
/// has a resting tool, and a moving hand overcomes the bumps of the field.
inline constexpr double kHysteresisRatio = 2.0;
/// Number of queries without such a pose after which the frame returns to the best one.
inline constexpr int kMaxWorse = 3;

/// Friction: a contact patch smaller than this fraction of the lever counts as a point.
inline constexpr double kMinPatch = 1e-4;

}  // namespace voxtouch::contact::limits
