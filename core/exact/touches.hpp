#pragma once
/// Where two features face each other: direction, gap and point, in the object's frame.
#include <array>

#include "core/exact/pair_probe.hpp"

namespace voxtouch::exact {

/// A pair of features that was found near.
struct NearPair {
  PairKind kind = PairKind::kVertexFace;
  std::uint32_t element = 0;  ///< of the tool, as Probe::elements counts
  std::uint32_t item = 0;     ///< of the object, as Probe::items counts
  std::uint32_t object = 0;
  double distance_m = 0.0;
  SeparatingPlane plane = {};  ///< across the shortest way between them
};

/// normal . shift of the tool's point widens the gap. All in the object's frame.
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

/// The rows that a pair makes: only where the pair is a local minimum of the distance, or may come
/// to be one within a step of `reach_m`.
///
/// A point has a row with a face that it projects into; with a convex edge or vertex only within
/// the region in which no neighbour is nearer. Next to a concave edge the neighbour's plane holds
/// as well: free space is the intersection there. A vertex needs all its edges to rise from the
/// plane (kVertexConeSine), an edge pair a normal in both edges' cones (kEdgeConeSine) and lines
/// that meet between the edges' ends; farther off than kBeyondEndsMargins by as much to spare as
/// the step may change. Near the margin such a row would hold what is free. Ties above flat edges
/// go to one owner. Real-time safe.
Touches touches_of(const NearPair& pair, const ToolBody& tool, const ObjectBody& object,
                   PosedPoints& posed, double reach_m) noexcept;

/// The plane between the pair's features as they are, whether or not it is a minimum: for pairs
/// that a step would pass through. `next` are the tool's points after that step; `found_m` gets the
/// gap there, below zero beyond the plane. Real-time safe.
Touch passed_touch(const NearPair& pair, const ToolBody& tool, const ObjectBody& object,
                   PosedPoints& posed, PosedPoints& next, double& found_m) noexcept;

/// Whether all of the tool's feature is above the pair's plane at `next`: it passes nothing on the
/// straight way there. Real-time safe.
bool stays_apart(const NearPair& pair, const ToolBody& tool, const PosedPoints& next) noexcept;

/// Whether the pair passes through each other on the straight way of all points from `posed` to
/// `next`.
bool passes(const NearPair& pair, const ToolBody& tool, const ObjectBody& object,
            PosedPoints& posed, PosedPoints& next) noexcept;

}  // namespace voxtouch::exact
