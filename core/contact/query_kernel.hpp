#pragma once
/// The part of the query that processes many points: through the tree and, leaf by leaf, into the
/// voxels. Its loops are in leaf_kernel.hpp.
#include <cstdint>

#include "core/contact/hit_list.hpp"
#include "core/contact/sphere_tree.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch::contact {

/// One pose in the form of the kernel. Double precision decides, u = (R p + t) / e; single
/// precision only finds the certain cases. Its coordinates are relative to the voxel of the tool's
/// origin, so their error depends on the size of the tool and not on its position.
struct QueryFrame {
  HitSource source;  ///< in double precision: decides

  // In single precision, in voxels: a p + shift is the position of a point relative to the voxel
  // `first`, always positive.
  float a[3][3] = {};  ///< R / e
  float shift[3] = {};
  /// Positions outside the table are clamped to its border, which is free.
  float low[3] = {}, high[3] = {};
  std::int32_t first[3] = {};  ///< relative to the table's first voxel
  /// A coordinate is certain if it is less than this from the centre of its voxel; negative: never.
  float certain = -1.0F;

  // The same for the tree, relative to the corner of the table.
  float corner_shift[3] = {};
  float size[3] = {};      ///< of the table
  float per_metre = 0.0F;  ///< 1 / e, rounded up
  float margin = 0.0F;     ///< added to every radius: the sum of all rounding errors
};

/// Data of a kernel. Single-precision coordinates are padded to a multiple of
/// SphereTree::kLeafPoints.
struct QueryData {
  const voxmap::Voxmap* voxmap = nullptr;
  std::size_t points = 0;
  const SphereTree* tree = nullptr;
  const float* x = nullptr;
  const float* y = nullptr;
  const float* z = nullptr;
};

/// Prepares the frame for a tool at `source`, whose points are within `reach_m` of its origin.
/// Returns false if the tool is completely outside the table, so that it has no hits.
bool make_query_frame(const voxmap::Voxmap& voxmap, const HitSource& source, double reach_m,
                      QueryFrame& frame) noexcept;

/// The points of one kind of voxel: ascending, `count` of them, and their sums.
struct FoundHits {
  std::uint32_t* points = nullptr;  ///< result of `Hits::room` for all points of the shell
  std::size_t count = 0;
  /// Sum of weight * normal, W axes: eight sums, one for each position in a leaf, rotated once.
  Vec3 normals = Vec3::Zero();
  double weights = 0.0;
};

/// Finds the points that collide. \returns the number of points left by the culling. Hits, sums and
/// the result are bit-identical on every processor.
std::uint32_t search(const QueryData& data, const QueryFrame& frame, FoundHits& surface,
                     FoundHits& interior) noexcept;

}  // namespace voxtouch::contact
