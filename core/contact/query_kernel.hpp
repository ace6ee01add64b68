#pragma once
/// The part of the query that runs over many points: through the tree, and leaf by leaf into the
/// voxels. Its loops are in leaf_kernel.hpp.
#include <cstdint>

#include "core/contact/hit_list.hpp"
#include "core/contact/sphere_tree.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch::contact {

/// One pose as the kernel sees it. The decision is that of doubles, u = (R p + t) / e: single
/// precision only says where it is certain. Its coordinates are counted from the voxel that holds
/// the tool's origin, so that their error grows with the tool's size and not with where it is.
struct QueryFrame {
  HitSource source;  ///< in doubles: what decides

  // In single precision, in voxels: a p + shift is a point's place from the voxel `first` on,
  // always above zero.
  float a[3][3] = {};  ///< R / e
  float shift[3] = {};
  float low[3] = {},
        high[3] = {};  ///< what lies outside the table is put into its border, which is free
  std::int32_t first[3] = {};  ///< counted from the table's first voxel
  /// A coordinate is certain where it is less than this from the middle of its voxel; below zero:
  /// nowhere.
  float certain = -1.0F;

  // The same for the tree, counted from the table's corner.
  float corner_shift[3] = {};
  float size[3] = {};      ///< of the table
  float per_metre = 0.0F;  ///< 1 / e, rounded up
  float margin = 0.0F;     ///< added to every radius: all that rounds
};

/// What a kernel looks up. Single precision coordinates are filled up to a multiple of
/// SphereTree::kLeafPoints.
struct QueryData {
  const voxmap::Voxmap* voxmap = nullptr;
  std::size_t points = 0;
  const SphereTree* tree = nullptr;
  const float* x = nullptr;
  const float* y = nullptr;
  const float* z = nullptr;
};

/// The frame for a tool at `source`, none of whose points is farther than `reach_m` from its
/// origin. False where the tool is wholly outside the table: it hits nothing.
bool make_query_frame(const voxmap::Voxmap& voxmap, const HitSource& source, double reach_m,
                      QueryFrame& frame) noexcept;

/// The points of one kind of voxel: ascending, `count` of them, and what they sum up to.
struct FoundHits {
  std::uint32_t* points = nullptr;  ///< what `Hits::room` gave for all points of the shell
  std::size_t count = 0;
  Vec3 normals = Vec3::Zero();  ///< sum of weight * normal, W axes: of eight sums, one for each
                                ///< place in a leaf, turned once
  double weights = 0.0;
};

/// Finds the points that collide. \returns the points that culling left to test. The hits, the sums
/// and what is returned are bit-identical on every processor.
std::uint32_t search(const QueryData& data, const QueryFrame& frame, FoundHits& surface,
                     FoundHits& interior) noexcept;

}  // namespace voxtouch::contact
