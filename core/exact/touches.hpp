#pragma once
/// Where two features face each other: direction, gap and point, in the object's frame.
#include <array>

#include "core/exact/pair_probe.hpp"

namespace voxtouch::exact {

/// A pair of near features.
struct NearPair {
  PairKind kind = PairKind::kVertexFace;
  std::uint32_t element = 0;  ///< of the tool, as Probe::elements counts
  std::uint32_t item = 0;     ///< of the object, as Probe::items counts
  std::uint32_t object = 0;
  double distance_m = 0.0;
  SeparatingPlane plane = {};  ///< across the shortest vector between them
};

/// A displacement d of the tool's point changes the gap by normal . d. All in the object's frame.
struct Touch {
  Vec3 normal = Vec3::Zero();  ///< unit, from the object to the tool
  Vec3 point = Vec3::Zero();   ///< of the tool
  double gap_m = 0.0;
};

/// Up to four: a face, and the planes that rise from its sides.
struct Touches {
  std::array<Touch, 4> of;
  std::size_t count = 0;
  void add(const Touch& touch) noexcept { of[count++] = touch; }
};

/// The rows of a pair, if it is a local minimum of the distance or may become one within a step of
/// `reach_m`:
///
/// - Point and face: the point projects into the face. Next to a concave edge the neighbour's plane
///   makes a row too, since free space is the intersection there.
/// - Point and convex edge or vertex: no neighbour is nearer.
/// - Vertex of either body: its edges rise from the plane (kVertexConeSine).
/// - Edge pair: the normal is in both cones (kEdgeConeSine), and the lines meet between the ends.
///
/// At gaps above kBeyondEndsMargins the tolerances include what the step may change. Near the
/// margin such rows would block free motions. Ties above flat edges make one row. Real-time safe.
Touches touches_of(const NearPair& pair, const ToolBody& tool, const ObjectBody& object,
                   PosedPoints& posed, double reach_m) noexcept;

/// The plane between the features of a pair that pass through each other in a step, whether or not
/// their distance is a minimum. `next`: the tool's points after that step. `found_m`: gap there,
/// negative beyond the plane [m]. Real-time safe.
Touch passed_touch(const NearPair& pair, const ToolBody& tool, const ObjectBody& object,
                   PosedPoints& posed, PosedPoints& next, double& found_m) noexcept;

/// Whether all of the tool's feature is above the pair's plane at `next`. Real-time safe.
bool stays_apart(const NearPair& pair, const ToolBody& tool, const PosedPoints& next) noexcept;

/// Whether the features pass through each other while all points of the tool move straight from
/// `posed` to `next`. Real-time safe.
bool passes(const NearPair& pair, const ToolBody& tool, const ObjectBody& object,
            PosedPoints& posed, PosedPoints& next) noexcept;

}  // namespace voxtouch::exact
