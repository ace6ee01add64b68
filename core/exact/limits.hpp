#pragma once
/// All thresholds of the virtual tool on triangles.
#include <cstddef>

namespace voxtouch::exact::limits {

/// Gap of a resting contact [m]. It is not zero, so that the pose alone gives the side of a face.
inline constexpr double kMarginM = 5e-7;

/// Tolerances of the simplification of meshes: distance [m] and rotation of a normal [rad] (0.4
/// degrees).
inline constexpr double kSimplifiedM = 5e-6, kSimplifiedRad = 7e-3;

/// A step that moves no point farther than this ends the frame [m], so that a tool comes to rest.
inline constexpr double kRestM = 1e-8;

/// Positions of the tool are multiples of this [m]: a power of two, far below all other lengths.
inline constexpr double kLatticeM = 0x1p-42;

/// Two features nearer than this touch [m]: the rounding of a crossing's time. Far below the
/// margin.
inline constexpr double kTouchM = 1e-9;

/// Largest numbers of queries in a frame, attempts in a query, and changes of the active set in a
/// projection.
inline constexpr int kMaxQueries = 7;
inline constexpr int kMaxAttempts = 6;
inline constexpr int kMaxIterations = 100;

/// Edges whose faces differ by less than this are flat [rad] (0.02 degrees). Flat edges make no
/// rows. The bound is small because a chain of flat edges is not seen by an edge of the other mesh.
inline constexpr double kFlatEdgeRad = 3.5e-4;

/// A vertex makes a row only if its edges rise from the plane, with this tolerance (sine of 3
/// degrees).
inline constexpr double kVertexConeSine = 0.0523;

/// An edge pair makes a row only if the normal lies in both edges' cones, with this tolerance (sine
/// of 0.3 degrees).
inline constexpr double kEdgeConeSine = 0.00524;

/// Above this gap, in margins, an edge pair also makes a row if its lines meet beyond the edges'
/// ends, by up to the reach.
inline constexpr double kBeyondEndsMargins = 4.0;

/// While the hand moves, a frame ends where a step is shorter than this ratio of the hand's
/// displacement.
inline constexpr double kMovingRestRatio = 1e-4;

/// Fractions of a frame's limit of work at which these stop: growth of the expected reach, renewal
/// of lists, evaluation of pairs, checks beyond the rows, projections. The rest is for the test
/// whether features pass through each other.
inline constexpr double kWidenRatio = 0.2;
inline constexpr double kRenewalRatio = 0.65, kPairsRatio = 0.75, kBeyondRatio = 0.87,
                        kProjectionRatio = 0.94;

/// In contact at rest, a query halves its step and all later ones if the residual is below
/// kSettlingM [m] and has not fallen by kSettlingRatio of the last step. At a factor below
/// kLeastDamping the tool has converged.
inline constexpr double kSettlingRatio = 0.3, kSettlingM = 1e-4, kLeastDamping = 1e-3;

/// Armijo's ratio; see VirtualTool::shortens. The spring's |s|^2 / 2 falls by half of |step|^2 if
/// rows are straight.
inline constexpr double kArmijoRatio = 0.15;

/// Factor on the gap that a straight row missed (second-order correction).
inline constexpr double kCorrection = 1.2;

/// Largest displacement by which a row pushes the tool out in a step [m]; above a missing margin.
inline constexpr double kMaxMarginRestoreM = 1e-6;

/// Expected reach of a step: kReachRatio times the longest step of the last frame, limited to
/// kMinReachM to kMaxReachM [m]. Within a frame it doubles if a step attains 0.9 of it.
inline constexpr double kReachRatio = 1.5;
inline constexpr double kMinReachM = 2e-5;
inline constexpr double kMaxReachM = 2e-3;

/// Lists hold the pairs within kListReaches times the reach plus kListRestM [m], and the nearest
/// beyond it up to kListRangeM [m] until there are kListedPairs.
inline constexpr double kListReaches = 2.0;
inline constexpr double kListRestM = 2e-5;
inline constexpr double kListRangeM = 1e-3;
inline constexpr std::size_t kListedPairs = 24;

/// Rows are made for gaps up to kReachRatio times the largest decrease of a gap in the last frame.
/// If a step may touch a pair beyond, rows are made for the whole reach, for this many frames.
inline constexpr int kAllRowsFrames = 4;

/// A plane replaces the lists of a group of the tool's features if all of the object within
/// kPlaneRangeM [m] is below it, and the group is kPlaneReaches times the reach above it.
inline constexpr double kPlaneRangeM = 1.5e-3;
inline constexpr double kPlaneReaches = 1.2;
/// Largest half angle of a cone of normals for the test whether the object's features face away
/// [rad].
inline constexpr double kWidestCone = 0.7;
/// After a failed test for a plane or for facing away: path before the next one [m].
inline constexpr double kPlaneRetryM = 2.5e-4;

/// In contact, the path of a frame is at most kFollowRatio times that of the hand, plus the larger
/// of kCatchUpRatio times the spring's length and kCatchUpM [m]. A tool that slips off an edge thus
/// ramps the force. Round a cylinder of radius R, with the hand at depth d, the tool moves
/// R / (R - d) times as far as the hand.
inline constexpr double kFollowRatio = 2.0;
inline constexpr double kCatchUpRatio = 0.01;
inline constexpr double kCatchUpM = 4e-5;

/// Largest fraction of a query's reach for the motion of objects; the rest is the tool's step.
inline constexpr double kObjectsReachRatio = 0.5;
/// If the tool cannot evade an object, contact uses a delayed pose of the object. The tool is reset
/// if the delay exceeds this [m].
inline constexpr double kMaxObjectDelayM = 5e-3;

/// Largest numbers of rows and near pairs of a query, and of pairs in an element's list.
inline constexpr std::size_t kMaxRows = 8192;
inline constexpr std::size_t kMaxNearPairs = 65536;
inline constexpr std::size_t kMaxListed = 8192;

/// Rows nearer than this count for the coherence of a contact [m].
inline constexpr double kCoherentGapM = 1e-5;

/// A start is invalid if a pair of features is nearer than this [m].
inline constexpr double kStartGapM = 1e-7;

/// Quaternion norms that are accepted and normalised.
inline constexpr double kMinQuaternionNorm = 1e-3;
inline constexpr double kMaxQuaternionNorm = 1e3;

/// Coordinates beyond this are out of range [m]; within it, distances are accurate to 1e-12 m.
inline constexpr double kMaxCoordinateM = 1e3;

}  // namespace voxtouch::exact::limits
