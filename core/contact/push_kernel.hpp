#pragma once
/// The loops over hits that a force law is summed up with, one set of them for each kind of
/// processor.
///
/// A sum over hits is eight sums, hit n of the list in lane n mod 8, each in the hits' order, added
/// up in a fixed order: bit-identical whether two, four or eight numbers are added at once.
#include <cstddef>
#include <cstdint>

#include "core/contact/hit_list.hpp"
#include "core/contact/instructions.hpp"

namespace voxtouch::contact {

inline constexpr std::size_t kLanes = 8;

/// A few dozen hits as structure of arrays, within the first cache. They come in groups of kLanes,
/// each from a place in the list that is a multiple of kLanes, ascending, so a hit's lane does not
/// depend on the groups left out. The last group is filled up with hits of no weight.
struct HitBlock {
  static constexpr std::size_t kHits = 64, kGroups = kHits / kLanes;
  std::size_t groups = 0;
  std::size_t place[kGroups];  ///< of each group's first hit in the list
  std::size_t count = 0;       ///< hits that are real
  alignas(64) double arm[3][kHits], normal[3][kHits], to_centre[3][kHits], weight[kHits];

  /// With what it is filled up.
  std::size_t filled() const noexcept { return kLanes * groups; }
  /// Where in the list the group of hit `n` begins.
  std::size_t group_place(std::size_t n) const noexcept { return place[n / kLanes]; }
};

/// How the hits of a block push: along j[0..2], at most of unit length, with `push` times the
/// stiffness; and what each counts in the stiffness matrix. Both must be 0 beyond the block's hits.
/// Added are `groups` of them, which begin at the hits `group`.
struct Pushes {
  std::size_t groups = 0;
  std::uint32_t group[HitBlock::kGroups];
  alignas(64) double j[6][HitBlock::kHits];  ///< J = [u', (arm x u)']; the second half is worked
                                             ///< out by `add`
  alignas(64) double push[HitBlock::kHits], weight[HitBlock::kHits];

  void add_all(const HitBlock& block) noexcept {
    groups = block.groups;
    for (std::size_t g = 0; g < groups; ++g)
      group[g] = static_cast<std::uint32_t>(kLanes * g);
  }
};

/// Sums of pushes.
struct PushLanes {
  alignas(64) double push[6][kLanes] = {};        ///< of push J: the wrench for a stiffness of one
  alignas(64) double weight[kLanes] = {};         ///< of the weights
  alignas(64) double stiffness[21][kLanes] = {};  ///< of weight J' J: the upper triangle by rows
  alignas(64) double deepest[kLanes] = {};        ///< the largest depth of a lane, and ...
  alignas(64) double deepest_hit[kLanes] =
      {};  ///< ... its hit's place in the list less the lane: the first of equals
};

/// The same along one common direction: what each hit adds is its arm's moments.
struct MeanLanes {
  alignas(64) double push[4][kLanes] = {};      ///< of push and push times arm
  alignas(64) double moments[10][kLanes] = {};  ///< of weights as CommonDirectionSum::kSums
  alignas(64) double deepest[kLanes] = {}, deepest_hit[kLanes] = {};  ///< as PushLanes
};

/// The way a point pushes: u_i = s m + (1 - s) n_i, brought to unit length
/// (limits::kShortestDirection); n_i itself for s = 0.
struct PushDirection {
  Vec3 mean = Vec3::Zero();  ///< m
  double mean_weight = 0.0;  ///< s in [0, 1]; for 1 there are sums of their own
};

/// The same for what single precision can decide: a hit pushes only where mean . off + back' off .
/// n is below `most`; `off`: the point from its voxel's middle [e], n its packed normal.
struct RoughDirection {
  bool own = false, common = false;  ///< which of the two there are
  float mean[3] = {};                ///< s m
  float back[3][3] =
      {};             ///< rotation of T in W, times 1 - s and what a packed normal's words count
  float most = 0.0F;  ///< all that rounds
};

/// All are real-time safe.
struct PushKernel {
  /// Which groups of eight hits may push, of a block's hits from `begin` on: bit k for hits begin +
  /// 8 k and on. The hits are a query's, and `certain` is above zero; packed normals are looked at
  /// only where `own` is set.
  std::uint32_t (*may_push)(const Hits& hits, std::size_t begin,
                            const RoughDirection& direction) noexcept;
  /// The hits of a query in the block's groups. Hit by hit the bits of HitSource::hit.
  void (*fill)(const Hits& hits, HitBlock& block) noexcept;
  /// The same without normals.
  void (*fill_places)(const Hits& hits, HitBlock& block) noexcept;
  /// Works out how the hits push: d_i = max(0, u_i . (c_i - x_i)), push = w_i d_i; the weight is
  /// w_i where d_i > 0, else 0.
  void (*push)(const HitBlock& block, const PushDirection& direction, Pushes& pushes,
               PushLanes& lanes) noexcept;
  /// Adds the pushes.
  void (*add)(const HitBlock& block, Pushes& pushes, PushLanes& lanes) noexcept;
  /// Adds what they count in the stiffness alone: nothing pushes.
  void (*add_stiffness)(const HitBlock& block, Pushes& pushes, PushLanes& lanes) noexcept;
  /// Both at once, all hits along `mean`.
  void (*push_along_mean)(const HitBlock& block, const Vec3& mean, MeanLanes& lanes) noexcept;
};

const PushKernel& push_kernel(Instructions instructions) noexcept;

}  // namespace voxtouch::contact
