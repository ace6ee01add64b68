#pragma once
/// Every threshold of the virtual tool on triangles, named in one place.
#include <cstddef>

namespace voxtouch::exact::limits {

/// Contact rests at this gap, not at zero [m]: the side of a face is then always known from the
/// pose alone.
inline constexpr double kMarginM = 5e-7;

/// Meshes are simplified at load within this distance [m], and this turn of a normal [rad] (0.4
/// degrees).
inline constexpr double kSimplifiedM = 5e-6, kSimplifiedRad = 7e-3;

/// A step whose points all move less than this ends the frame [m]. A hand at rest has a tool at
/// rest.
inline constexpr double kRestM = 1e-8;

/// Positions of the tool are multiples of this [m]: a power of two, far below all else.
inline constexpr double kLatticeM = 0x1p-42;

/// Two features nearer than this touch [m]: the rounding of a crossing's time. Far below the
/// margin.
inline constexpr double kTouchM = 1e-9;

/// Queries of one frame, attempts of one query, changes of the active set of one projection: the
/// most.
inline constexpr int kMaxQueries = 7;
inline constexpr int kMaxAttempts = 6;
inline constexpr int kMaxIterations = 100;

/// Edges whose faces differ by less than this are flat [rad] (0.02 degrees). Flat edges make no
/// rows. The bound is small because a chain of flat edges is not seen by an edge of the other mesh.
inline constexpr double kFlatEdgeRad = 3.5e-4;

/// A vertex makes a row only where its edges rise from the plane; this much to spare (sine of 3
/// degrees).
inline constexpr double kVertexConeSine = 0.0523;

/// An edge pair makes a row only where the normal lies in both edges' cones; sine of 0.3 degrees to
/// spare.
inline constexpr double kEdgeConeSine = 0.00524;

/// Edge pairs with a wider gap, in margins, make a row where their lines meet just beyond the
/// edges' ends.
inline constexpr double kBeyondEndsMargins = 4.0;

/// While the hand moves, a frame ends where a step is shorter than this ratio of the hand's
/// displacement.
inline constexpr double kMovingRestRatio = 1e-4;

/// Of a frame's limit of work: renewal of lists stops at the first ratio, evaluation of pairs at
/// the second, the look at what is farther than the rows at the third, projections at the fourth.
/// The rest is for the test whether a step passes something.
/// The expected reach grows within a frame only while the work is below this ratio.
inline constexpr double kWidenRatio = 0.2;
inline constexpr double kRenewalRatio = 0.65, kPairsRatio = 0.75, kBeyondRatio = 0.87,
                        kProjectionRatio = 0.94;

/// While hand and objects rest, a query halves this and all later steps if what it asks for is
/// less than the second figure [m] and did not fall by the first ratio of the last step; below the
/// third the tool rests where it is.
inline constexpr double kSettlingRatio = 0.3, kSettlingM = 1e-4, kLeastDamping = 1e-3;

/// A step is taken only where half the spring's squared length falls by this ratio of the step's
/// squared length, of which it promises half.
inline constexpr double kArmijoRatio = 0.15;

/// What a straight row missed is corrected by this factor (second-order correction).
inline constexpr double kCorrection = 1.2;

/// A row may push the tool out by at most this in a step [m]; more than a margin is never missing.
inline constexpr double kMaxPushOutM = 1e-6;

/// Rotations that bend a row by less than this are solved once [m].
inline constexpr double kBendM = 1e-8;

/// The tool is expected to go this many times the last frame's longest step; at least and at most
/// so far [m]. Within a frame the expectation doubles where a step goes that far. It decides how
/// many pairs are looked at.
inline constexpr double kReachRatio = 1.5;
inline constexpr double kMinReachM = 2e-5;
inline constexpr double kMaxReachM = 2e-3;

/// Lists hold the pairs within this many reaches, and a rest [m]; of those farther off up to the
/// third [m] the nearest, this many in all.
inline constexpr double kListReaches = 2.0;
inline constexpr double kListRestM = 2e-5;
inline constexpr double kListRangeM = 1e-3;
inline constexpr std::size_t kListedPairs = 24;

/// Rows are looked at within what closed at most in the last frame, times kReachRatio. Where a step
/// would come to more, all within the reach are looked at for this many frames.
inline constexpr int kAllRowsFrames = 4;

/// A plane between a group of the tool's features and all of the object within this [m] stands for
/// their lists where it leaves this many reaches on the tool's side.
inline constexpr double kPlaneRangeM = 1.5e-3;
inline constexpr double kPlaneReaches = 1.2;
/// Groups of the tool's features whose normals differ by more than this from their mean [rad] are
/// not asked whether all near features of the object face away.
inline constexpr double kWidestCone = 0.7;
/// Where there is no such plane, none is looked for before the tool went so far [m].
inline constexpr double kPlaneRetryM = 2.5e-4;

/// In contact the tool goes at most this many times as far as the hand went, and this ratio of the
/// spring's length, or this far [m]: an edge that gives way becomes a ramp. Round a cylinder of
/// radius R with the hand at a depth d the tool has to go R / (R - d) times as far as the hand.
inline constexpr double kFollowRatio = 2.0;
inline constexpr double kCatchUpRatio = 0.01;
inline constexpr double kCatchUpM = 4e-5;

/// A moving object takes up at most this ratio of a query's reach; the rest is the tool's own step.
inline constexpr double kObjectsReachRatio = 0.5;
/// An object that the tool cannot make way for is met where it was, until it is so far beyond [m].
inline constexpr double kMaxObjectDelayM = 5e-3;

/// Rows of one query, pairs that one query evaluates, pairs of one element's list: the most.
inline constexpr std::size_t kMaxRows = 8192;
inline constexpr std::size_t kMaxNearPairs = 65536;
inline constexpr std::size_t kMaxListed = 8192;

/// Rows nearer than this count for the coherence of a contact [m].
inline constexpr double kCoherentGapM = 1e-5;

/// A pose is no start where a pair of features is nearer than this [m].
inline constexpr double kStartGapM = 1e-7;

/// Quaternion norms that are accepted and brought to one.
inline constexpr double kMinQuaternionNorm = 1e-3;
inline constexpr double kMaxQuaternionNorm = 1e3;

/// A pose farther from the origin than this is out of range [m]: distances keep 1e-12 m within it.
inline constexpr double kMaxCoordinateM = 1e3;

}  // namespace voxtouch::exact::limits
