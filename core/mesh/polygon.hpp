#pragma once
/// Polygons of mesh files as triangles. Loading only: allocates.
#include <array>
#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/types/geometry.hpp"

namespace voxtouch::mesh {

/// Why a polygon cannot be cut.
struct PolygonFault {
  std::optional<Vec3> crossing;  ///< point at which its boundary crosses itself, if known
};

/// Cuts polygons into triangles between their corners.
///
/// Convex polygons become a fan from their first corner. Others are cut in their plane of best fit
/// by GEOS (constrained Delaunay triangulation). A boundary that returns to an earlier corner is
/// split there. A path that is traversed in both directions is not a boundary, so a polygon may
/// enclose holes connected by a bridge.
class PolygonCutter {
 public:
  using Triangle = std::array<std::uint32_t, 3>;  ///< positions in the list of corners
  using Triangles = std::vector<Triangle>;

  PolygonCutter();
  ~PolygonCutter();
  PolygonCutter(const PolygonCutter&) = delete;
  PolygonCutter& operator=(const PolygonCutter&) = delete;

  /// `corners`: finite, in order along the boundary, in any unit. The triangles have the polygon's
  /// orientation, its exact boundary and no other corners. n distinct corners give n - 2 triangles;
  /// each hole inside adds two, and repeated corners add none. A polygon that is nowhere wider than
  /// single precision resolves becomes a fan.
  std::expected<Triangles, PolygonFault> cut(std::span<const Vec3> corners) const;

 private:
  struct Geos;
  std::unique_ptr<Geos> geos_;
};

}  // namespace voxtouch::mesh
