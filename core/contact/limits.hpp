#pragma once
#include <cstddef>

/// Every threshold of contact models, named in one place. Lengths are in voxel edges of the static
/// grid.
namespace voxtouch::contact::limits {

/// `adapted` becomes `original` for the frame where |sum n| / |S| is at most this: the points face
/// each other.
inline constexpr double kFallbackCoherence = 0.3;

/// The stateful stage replaces that switch by a smoothstep of the coherence between these two
/// values.
inline constexpr double kBlendFrom = 0.2;  ///< own normals up to here
inline constexpr double kBlendTo = 0.5;    ///< mean normal from here on

/// A blended direction shorter than this is not brought to unit length: where mean and own normal
/// oppose each other the point's push fades through zero instead of reversing at full strength.
inline constexpr double kShortestDirection = 0.1;

/// A retained point pushes with at least this depth: its last surface voxel may have had its centre
/// in front of it.
inline constexpr double kLatchedDepthFloorEdges = 0.25;

/// Depth of a point that turns up in the interior without having been seen in the surface layer.
inline constexpr double kUnseenDepthEdges = 1.0;

/// A remembered depth shrinks by this much for each metre that the tool moves once its point is
/// back in the surface layer. 1 is the slope of the plain law on the way out, so that a straight
/// way in and out gives no energy away.
inline constexpr double kFadePerMetre = 1.0;

/// The shared retained direction follows the present mean fully where their cosine is at least
/// `kAgreeTo`, not at all below `kAgreeFrom`: beyond a sphere's equator the rim's normals point
/// down into the wall.
inline constexpr double kAgreeFrom = 0.0;
inline constexpr double kAgreeTo = 0.5;

/// A point that moved more than this between two poses may have jumped the surface layer's force
/// zone: the layer is a voxel thick wherever a triangle passes, however thin the wall, and the half
/// of it behind the centre is where `original` and `adapted` push.
inline constexpr double kFastEdges = 0.5;

/// `field`, see ContactResult::saturated: where the distance changes more slowly than this the
/// point is near the middle of a body, and its push grows no more. Two faces that meet at a right
/// angle keep 0.71 on the plane between them, three 0.58.
inline constexpr double kFlatGradient = 0.5;

/// Added to every radius of the culling tree: covers the rounding of u up to 2^31 voxels (about
/// 1e-5) with room to spare.
inline constexpr double kCullSafetyVoxels = 1e-3;

/// Grid coordinates beyond this do not fit int32 any more.
inline constexpr double kMaxGridCoordinate = 2147483000.0;

/// Quaternion norms that the query accepts and brings to one. What a device may send is judged
/// before, and more strictly.
inline constexpr double kMinQuaternionNorm = 1e-3;
inline constexpr double kMaxQuaternionNorm = 1e3;

/// The virtual tool (virtual_tool.hpp). Stiffness of one row over the spring's: so hard that the
/// result is the constraint's, so soft that rows which oppose each other need no common point.
inline constexpr double kRowStiffness = 1000.0;
/// Rows with a wider gap are left out: no step is longer, so they cannot become active within it.
inline constexpr double kRowGapEdges = 0.5;
/// Longest path of any point of the tool between two queries: no thicker layer of surface voxels is
/// passed unseen.
inline constexpr double kToolStepEdges = 0.5;
/// Queries a frame, those of a frame whose last step was pushed, iterations a step, evaluations a
/// line search: the most, whatever the hand does.
inline constexpr int kMaxQueries = 8;
inline constexpr int kMaxQueriesInContact = 7;
inline constexpr int kMaxIterations = 8;
inline constexpr int kMaxLineEvaluations = 6;
/// In contact a frame ends where the way that is left is shorter than the first, or, while the hand
/// moves, than this fraction of its path, but never longer than the last.
inline constexpr double kRestEdges = 1e-3;
inline constexpr double kConvergenceRatio = 0.1;
inline constexpr double kRestMostEdges = 0.02;
/// Farther than this in contact the hand does not pull a row deeper.
inline constexpr double kPullEdges = 60.0;
/// The most rows of a step.
inline constexpr std::size_t kMaxRows = 96;
/// Rows with a wider gap do not push where the tool comes to rest, and a tool that had farther to
/// go is still on its way: the normals need not be smooth there.
inline constexpr double kSmoothGapEdges = 0.1;
inline constexpr double kSmoothPathEdges = 0.4;
/// A smooth gradient below this is bent by another face within its two voxels.
inline constexpr double kSmoothGradient = 0.99;
/// A gradient below this has no direction.
inline constexpr double kMinGradient = 0.1;
/// A wall of some two voxels or less bends the field: its gradient is shorter than the first, or
/// points against the tool's own normal by more than the second. There the plane of the wall's face
/// is taken, if it and the tool's normal agree by the third.
inline constexpr double kSheetGradient = 0.97;
inline constexpr double kSheetAgainst = 0.5;
inline constexpr double kSheetAgree = 0.6;
/// That plane is fitted to the voxels' corners on the tool's side, at least so many of them, first
/// coarsely [e], then finely; distances beyond the last [e] may be cut off.
inline constexpr std::size_t kSheetCorners = 3;
inline constexpr double kSheetCoarse = 0.4;
inline constexpr double kSheetFine = 0.1;
inline constexpr double kSheetFarEdges = 1.9;
/// The foot of a point on that plane may be nearer to a corner than the corner's distance by this
/// [e], no more: else it is beyond the face's rim.
inline constexpr double kSheetBeyond = 0.05;
/// A row of an edge point leads out of the static object by at least this part of it, against the
/// mean of the normals that meet there.
inline constexpr double kEdgeAgree = 0.1;
/// A pose is no start where a point is deeper than this.
inline constexpr double kPlacedDepthEdges = 0.5;
/// Nor where a wall is that deep inside the tool (wall_inside.hpp). From so many hits at most it is
/// followed inward, in so many steps of so many edges, where the tool's normal has such a part
/// along it. A thin wall is between two points where the gradients oppose each other by so much.
/// Whether it is inside is judged by the hits within so many edges.
inline constexpr std::size_t kMostAsked = 128;
inline constexpr int kStepsIn = 2;
inline constexpr double kStepInEdges = 0.75;
inline constexpr double kShortestAlong = 0.1;
inline constexpr double kOpposed = 0.8;
inline constexpr double kNearEdges = 1.5;
/// In contact the virtual tool goes at most as far as the hand went, and this fraction of the
/// spring's length, or this many edges: an edge that gives way becomes a ramp.
inline constexpr double kCatchUpRatio = 0.03;
inline constexpr double kSnapEdges = 0.02;
/// A frame keeps a pose only where the energy is lower than where it began, or higher by at most
/// this fraction of the spring's pull times the hand's path: a hand that rests is pulled by a tool
/// that rests, one that moves is carried over the bumps of the field.
inline constexpr double kHysteresisRatio = 2.0;
/// So many queries may pass without such a pose before the frame goes back to the best one.
inline constexpr int kMaxWorse = 3;

/// Friction: a patch of pushes smaller than this fraction of the lever is a point.
inline constexpr double kMinPatch = 1e-4;

}  // namespace voxtouch::contact::limits
