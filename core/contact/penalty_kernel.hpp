#pragma once
/// The loops over hits that sum a force law, with one set for each instruction set.
///
/// A sum over hits consists of eight sums, hit n of the list in lane n mod 8, each in the order of
/// the hits. They are combined in a fixed order, so the result is bit-identical for two, four or
/// eight numbers at a time.
#include <cstddef>
#include <cstdint>

#include "core/contact/hit_list.hpp"
#include "core/contact/instructions.hpp"

namespace voxtouch::contact {

inline constexpr std::size_t kLanes = 8;

/// A few dozen hits as structure of arrays, within the first-level cache. They form groups of
/// kLanes, each starting at a multiple of kLanes in the list, ascending. The lane of a hit thus
/// does not depend on skipped groups. The last group is padded with hits of zero weight.
struct HitBlock {
  static constexpr std::size_t kHits = 64, kGroups = kHits / kLanes;
  std::size_t groups = 0;
  std::size_t place[kGroups];  ///< index of each group's first hit in the list
  std::size_t count = 0;       ///< number of actual hits
  alignas(64) double arm[3][kHits], normal[3][kHits], to_centre[3][kHits], weight[kHits];

  /// Number including the padding.
  std::size_t filled() const noexcept { return kLanes * groups; }
  /// Index in the list of the first hit in the group of hit `n`.
  std::size_t group_place(std::size_t n) const noexcept { return place[n / kLanes]; }
};

/// Forces of the hits of a block: along j[0..2], at most of unit length, with `force` times the
/// stiffness, and the weight of each in the stiffness matrix. Both must be 0 in the padding.
/// `groups` of them are summed, starting at the hits `group`.
struct PenaltyForces {
  std::size_t groups = 0;
  std::uint32_t group[HitBlock::kGroups];
  /// J = [u', (arm x u)']; `add` computes the second half.
  alignas(64) double j[6][HitBlock::kHits];
  alignas(64) double force[HitBlock::kHits], weight[HitBlock::kHits];

  void add_all(const HitBlock& block) noexcept {
    groups = block.groups;
    for (std::size_t g = 0; g < groups; ++g)
      group[g] = static_cast<std::uint32_t>(kLanes * g);
  }
};

/// Sums of forces.
struct PenaltyLanes {
  alignas(64) double force[6][kLanes] = {};       ///< of force J: the wrench for unit stiffness
  alignas(64) double weight[kLanes] = {};         ///< of the weights
  alignas(64) double stiffness[21][kLanes] = {};  ///< of weight J' J: the upper triangle by rows
  alignas(64) double deepest[kLanes] = {};        ///< the largest depth of a lane
  /// Index of that hit in the list minus the lane; the first of equals.
  alignas(64) double deepest_hit[kLanes] = {};
};

/// The same along one common direction: each hit adds the moments of its arm.
struct MeanLanes {
  alignas(64) double force[4][kLanes] = {};     ///< of force, and of force times arm
  alignas(64) double moments[10][kLanes] = {};  ///< of weights as CommonDirectionSum::kSums
  alignas(64) double deepest[kLanes] = {}, deepest_hit[kLanes] = {};  ///< as PenaltyLanes
};

/// Force direction of a point: u_i = s m + (1 - s) n_i, normalised (limits::kShortestDirection);
/// n_i itself for s = 0.
struct ForceDirection {
  Vec3 mean = Vec3::Zero();  ///< m
  double mean_weight = 0.0;  ///< s in [0, 1]; for 1 there are separate sums
};

/// The same in single precision: a hit has a force only if mean . off + back' off . n is below
/// `most`. `off` is the point relative to its voxel centre [e], n its packed normal.
struct RoughDirection {
  bool own = false, common = false;  ///< which of the two terms exist
  float mean[3] = {};                ///< s m
  /// Rotation of T in W, times 1 - s and the scale of a packed normal's word.
  float back[3][3] = {};
  float most = 0.0F;  ///< sum of all rounding errors
};

/// The loops of one instruction set. All are real-time safe.
struct PenaltyKernel {
  /// Finds groups of eight hits that may have a force, among a block's hits from `begin` on: bit k
  /// for the hits from begin + 8 k on. Requires hits of a query with `certain` > 0; packed normals
  /// are read only if `own` is set.
  std::uint32_t (*may_have_force)(const Hits& hits, std::size_t begin,
                                  const RoughDirection& direction) noexcept;
  /// Fills in the hits of a query in the block's groups, bit-identical to HitSource::hit.
  void (*fill)(const Hits& hits, HitBlock& block) noexcept;
  /// The same without normals.
  void (*fill_places)(const Hits& hits, HitBlock& block) noexcept;
  /// Computes the forces, with weight w_i if d_i > 0, else 0:
  ///     d_i = max(0, u_i . (c_i - x_i)),   force = w_i d_i
  void (*compute)(const HitBlock& block, const ForceDirection& direction, PenaltyForces& forces,
                  PenaltyLanes& lanes) noexcept;
  /// Adds the forces.
  void (*add)(const HitBlock& block, PenaltyForces& forces, PenaltyLanes& lanes) noexcept;
  /// Adds only their stiffness; no force.
  void (*add_stiffness)(const HitBlock& block, PenaltyForces& forces, PenaltyLanes& lanes) noexcept;
  /// Both at once, with all hits along `mean`.
  void (*add_forces_along_mean)(const HitBlock& block, const Vec3& mean, MeanLanes& lanes) noexcept;
};

const PenaltyKernel& penalty_kernel(Instructions instructions) noexcept;

}  // namespace voxtouch::contact
