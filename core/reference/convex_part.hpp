#pragma once
/// Distances between a vertex, an edge or a face of one mesh and one of another.
#include <array>
#include <cstddef>

#include "core/types/geometry.hpp"

namespace voxtouch::reference {

/// A point, a segment or a triangle, for 1, 2 or 3 corners.
struct ConvexPart {
  std::array<Vec3, 3> corner;
  std::size_t corners = 1;
};

/// Nearest points of two parts.
struct Nearness {
  double distance_m = 0.0;
  Vec3 mine = Vec3::Zero(), other = Vec3::Zero();

  /// Unit, from the other part to mine; only for parts that do not meet.
  Vec3 direction() const { return (mine - other) / distance_m; }
};

/// Of a point and a triangle, of a triangle and a point, or of two segments: two polyhedral
/// surfaces that do not intersect are nearest to each other at such a pair.
Nearness nearness(const ConvexPart& mine, const ConvexPart& other);

/// Distance between the two parallel planes across `direction`, a unit vector, that separate the
/// parts [m]; negative if they do not.
double separation(const ConvexPart& mine, const ConvexPart& other, const Vec3& direction);

}  // namespace voxtouch::reference
