#include "core/mesh/polygon.hpp"

#include <geos_c.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace voxtouch::mesh {
namespace {

using Triangle = PolygonCutter::Triangle;
using Triangles = PolygonCutter::Triangles;
using Point = Eigen::Vector2d;
/// Corners along a closed path, none of them twice.
using Ring = std::vector<std::uint32_t>;

/// Steps of single precision, which file formats hold coordinates in.
constexpr double kSinglePrecision = std::numeric_limits<float>::epsilon();
/// Relative rounding of an area that is summed in double.
constexpr double kAreaTolerance = 1e-9;

/// For each corner the first one at its place.
std::vector<std::uint32_t> first_at_place(std::span<const Vec3> corners) {
  std::map<std::array<double, 3>, std::uint32_t> places;
  std::vector<std::uint32_t> first;
  first.reserve(corners.size());
  for (const Vec3& x : corners) {
    const auto own = static_cast<std::uint32_t>(first.size());
    // Adding 0.0 changes -0 to 0.
    const std::array<double, 3> place{x.x() + 0.0, x.y() + 0.0, x.z() + 0.0};
    first.push_back(places.try_emplace(place, own).first->second);
  }
  return first;
}

/// The boundary, taken apart wherever it returns to a corner. Rings of two corners are paths that
/// are walked forth and back: they enclose nothing and are left out.
std::vector<Ring> rings_of(std::span<const Vec3> corners) {
  constexpr std::size_t kAbsent = ~std::size_t{0};
  std::vector<Ring> rings;
  Ring path;
  std::vector<std::size_t> place_in_path(corners.size(), kAbsent);
  for (const std::uint32_t corner : first_at_place(corners)) {
    if (place_in_path[corner] == kAbsent) {
      place_in_path[corner] = path.size();
      path.push_back(corner);
      continue;
    }
    const auto begin = path.begin() + static_cast<std::ptrdiff_t>(place_in_path[corner]);
    if (path.end() - begin >= 3)
      rings.emplace_back(begin, path.end());
    for (auto passed = begin + 1; passed != path.end(); ++passed)
      place_in_path[*passed] = kAbsent;
    path.erase(begin + 1, path.end());
  }
  if (path.size() >= 3)
    rings.push_back(path);
  return rings;
}

void add_fan(const Ring& ring, Triangles& triangles) {
  for (std::size_t k = 2; k < ring.size(); ++k) {
    triangles.push_back({ring[0], ring[k - 1], ring[k]});
  }
}

/// Twice the signed area of a triangle.
double cross(const Point& a, const Point& b, const Point& c) {
  const Point ab = b - a, ac = c - a;
  return ab.x() * ac.y() - ab.y() * ac.x();
}

/// A polygon projected to its plane, seen from its front side, so that its area is positive.
struct FlatPolygon {
  std::vector<Point> points;  ///< one for each corner
  std::array<int, 3> axes;    ///< the two projected axes, and the dropped one
  Vec3 normal;
  double offset;  ///< of the plane along `normal`

  double doubled_area(const Ring& ring) const {
    double sum = 0.0;
    for (std::size_t k = 2; k < ring.size(); ++k) {
      sum += cross(points[ring[0]], points[ring[k - 1]], points[ring[k]]);
    }
    return sum;
  }
  Vec3 lifted(const Point& p) const {
    Vec3 x = Vec3::Zero();
    x[axes[0]] = p.x();
    x[axes[1]] = p.y();
    x[axes[2]] = (offset - normal.dot(x)) / normal[axes[2]];
    return x;
  }
};

/// Longest distance from the first corner, and from the line along it.
struct Extent {
  double length = 0.0, width = 0.0;
};

Extent extent_of(std::span<const Vec3> corners, const std::vector<Ring>& rings) {
  const Vec3& start = corners[rings[0][0]];
  Vec3 along = Vec3::Zero();
  for (const Ring& ring : rings) {
    for (const std::uint32_t c : ring) {
      if ((corners[c] - start).norm() > along.norm())
        along = corners[c] - start;
    }
  }
  Extent extent{.length = along.norm()};
  for (const Ring& ring : rings) {
    for (const std::uint32_t c : ring) {
      const double doubled = along.cross(corners[c] - start).norm();
      extent.width = std::max(extent.width, doubled / extent.length);
    }
  }
  return extent;
}

/// Twice the area, along the normal of the plane of best fit (Newell).
Vec3 area_vector(std::span<const Vec3> corners, const std::vector<Ring>& rings) {
  Vec3 sum = Vec3::Zero();
  for (const Ring& ring : rings) {
    const Vec3& start = corners[ring[0]];
    for (std::size_t k = 2; k < ring.size(); ++k) {
      sum += (corners[ring[k - 1]] - start).cross(corners[ring[k]] - start);
    }
  }
  return sum;
}

/// Projects along the axis nearest to the normal and keeps the other two coordinates: collinear
/// corners stay exactly collinear. Corners off the plane are first projected onto it.
FlatPolygon flatten(std::span<const Vec3> corners, const Vec3& normal, double largest) {
  FlatPolygon flat{.points = {}, .axes = {}, .normal = normal, .offset = 0.0};
  int skipped = 0;
  normal.cwiseAbs().maxCoeff(&skipped);
  flat.axes = {(skipped + 1) % 3, (skipped + 2) % 3, skipped};
  if (normal[skipped] < 0.0)
    std::swap(flat.axes[0], flat.axes[1]);
  for (const Vec3& x : corners) {
    flat.offset += normal.dot(x) / static_cast<double>(corners.size());
  }
  flat.points.reserve(corners.size());
  for (Vec3 x : corners) {
    const double off = normal.dot(x) - flat.offset;
    if (std::abs(off) > 8.0 * kSinglePrecision * largest)
      x -= off * normal;
    flat.points.emplace_back(x[flat.axes[0]], x[flat.axes[1]]);
  }
  return flat;
}

/// Whether it turns left at each corner, by more than rounding, and once around in total.
bool strictly_convex(const FlatPolygon& flat, const Ring& ring) {
  const std::size_t n = ring.size();
  std::size_t reversals = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const Point& a = flat.points[ring[k]];
    const Point& b = flat.points[ring[(k + 1) % n]];
    const Point& c = flat.points[ring[(k + 2) % n]];
    if (cross(a, b, c) <= 1e-12 * (b - a).norm() * (c - b).norm())
      return false;
    if ((b.x() > a.x()) != (c.x() > b.x()))
      ++reversals;
  }
  return reversals <= 2;
}

/// Removes corners at which the boundary reverses along its own line. A triangle without area keeps
/// the edges that other faces use.
void take_off_spikes(const FlatPolygon& flat, Ring& ring, Triangles& triangles) {
  for (std::size_t k = 0, unchanged = 0; ring.size() >= 3 && unchanged < ring.size();) {
    const std::size_t n = ring.size();
    k %= n;
    const std::uint32_t before = ring[(k + n - 1) % n], own = ring[k], behind = ring[(k + 1) % n];
    const Point& a = flat.points[before];
    const Point& b = flat.points[own];
    const Point& c = flat.points[behind];
    if (cross(a, b, c) == 0.0 && (b - a).dot(c - b) < 0.0) {
      triangles.push_back({before, own, behind});
      ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(k));
      k += n - 2;  // the corner before it
      unchanged = 0;
    } else {
      ++k;
      ++unchanged;
    }
  }
}

}  // namespace

/// GEOS with its geometries as values. A failure gives null.
struct PolygonCutter::Geos {
  struct Destroy {
    GEOSContextHandle_t context;
    void operator()(GEOSGeometry* geometry) const { GEOSGeom_destroy_r(context, geometry); }
  };
  using Geometry = std::unique_ptr<GEOSGeometry, Destroy>;
  using Fault = std::unexpected<PolygonFault>;

  GEOSContextHandle_t context = GEOS_init_r();
  Geos() = default;
  ~Geos() { GEOS_finish_r(context); }
  Geos(const Geos&) = delete;
  Geos& operator=(const Geos&) = delete;

  Geometry own(GEOSGeometry* geometry) const { return {geometry, Destroy{context}}; }

  Geometry ring(const FlatPolygon& flat, const Ring& corners) const {
    const auto n = static_cast<unsigned>(corners.size());
    GEOSCoordSequence* sequence = GEOSCoordSeq_create_r(context, n + 1, 2);
    for (unsigned k = 0; k <= n; ++k) {
      const Point& p = flat.points[corners[k % n]];
      GEOSCoordSeq_setXY_r(context, sequence, k, p.x(), p.y());
    }
    return own(GEOSGeom_createLinearRing_r(context, sequence));
  }

  Geometry polygon(const FlatPolygon& flat, const Ring& shell,
                   const std::vector<const Ring*>& holes = {}) const {
    std::vector<GEOSGeometry*> inner;
    for (const Ring* hole : holes)
      inner.push_back(ring(flat, *hole).release());
    const auto count = static_cast<unsigned>(inner.size());
    return own(GEOSGeom_createPolygon_r(context, ring(flat, shell).release(), inner.data(), count));
  }

  /// The violated rule of polygons; empty if there is none.
  std::optional<PolygonFault> fault(const FlatPolygon& flat, const GEOSGeometry* geometry) const {
    PolygonFault fault;
    GEOSGeometry* place = nullptr;
    const char valid = GEOSisValidDetail_r(context, geometry, 0, nullptr, &place);
    const Geometry owned = own(place);
    if (valid == 1)
      return std::nullopt;
    Point at;
    if (place != nullptr && GEOSGeomGetX_r(context, place, &at.x()) == 1 &&
        GEOSGeomGetY_r(context, place, &at.y()) == 1) {
      fault.crossing = flat.lifted(at);
    }
    return fault;
  }

  /// Adds the triangles of one valid polygon; corners are identified by their coordinates. False if
  /// GEOS returned another number of triangles, another corner or another area.
  bool add_triangles(const FlatPolygon& flat, const GEOSGeometry* polygon,
                     const std::vector<const Ring*>& rings, Triangles& all) const {
    std::map<std::pair<double, double>, std::uint32_t> corner_at;
    std::size_t corners = 0;
    double doubled_area = 0.0;
    for (const Ring* ring : rings) {
      for (const std::uint32_t c : *ring) {
        corner_at.try_emplace({flat.points[c].x(), flat.points[c].y()}, c);
      }
      corners += ring->size();
      doubled_area += flat.doubled_area(*ring);
    }
    const Geometry cut = own(GEOSConstrainedDelaunayTriangulation_r(context, polygon));
    if (!cut)
      return false;
    const int count = GEOSGetNumGeometries_r(context, cut.get());
    // Euler: V - E + T = 1 - holes, and each edge but the boundary's belongs to two triangles.
    const std::size_t expected = 2 * corner_at.size() - corners + 2 * rings.size() - 4;
    if (count < 0 || static_cast<std::size_t>(count) != expected)
      return false;
    double sum = 0.0;
    const std::size_t first = all.size();
    for (int t = 0; t < count; ++t) {
      const GEOSGeometry* piece = GEOSGetGeometryN_r(context, cut.get(), t);
      const GEOSGeometry* outline = GEOSGetExteriorRing_r(context, piece);
      const GEOSCoordSequence* places = GEOSGeom_getCoordSeq_r(context, outline);
      Triangle triangle{};
      for (unsigned k = 0; k < 3; ++k) {
        Point p;
        GEOSCoordSeq_getXY_r(context, places, k, &p.x(), &p.y());
        const auto found = corner_at.find({p.x(), p.y()});
        if (found == corner_at.end())
          return false;
        triangle[k] = found->second;
      }
      sum += cross(flat.points[triangle[0]], flat.points[triangle[1]], flat.points[triangle[2]]);
      all.push_back(triangle);
    }
    if (sum < 0.0) {
      for (std::size_t t = first; t < all.size(); ++t)
        std::swap(all[t][1], all[t][2]);
    }
    return std::abs(std::abs(sum) - doubled_area) <= kAreaTolerance * doubled_area;
  }

  /// Rings that run against the polygon are holes: each belongs to the smallest ring round it.
  std::expected<Triangles, PolygonFault> cut(const FlatPolygon& flat,
                                             const std::vector<Ring>& rings,
                                             Triangles triangles) const {
    std::vector<const Ring*> shells, holes;
    for (const Ring& ring : rings) {
      (flat.doubled_area(ring) < 0.0 ? holes : shells).push_back(&ring);
    }
    const auto smaller = [&](const Ring* a, const Ring* b) {
      return flat.doubled_area(*a) < flat.doubled_area(*b);
    };
    std::ranges::stable_sort(shells, smaller);
    std::vector<std::vector<const Ring*>> holes_of(shells.size());
    std::vector<Geometry> filled;
    for (const Ring* shell : shells) {
      filled.push_back(polygon(flat, *shell));
      if (const auto wrong = fault(flat, filled.back().get()))
        return Fault(*wrong);
    }
    for (const Ring* hole : holes) {
      const Geometry inner = polygon(flat, *hole);
      if (const auto wrong = fault(flat, inner.get()))
        return Fault(*wrong);
      std::size_t s = 0;
      while (s < shells.size() && GEOSContains_r(context, filled[s].get(), inner.get()) != 1)
        ++s;
      if (s == shells.size())
        return Fault(PolygonFault{flat.lifted(flat.points[(*hole)[0]])});
      holes_of[s].push_back(hole);
    }
    std::vector<GEOSGeometry*> parts;
    for (std::size_t s = 0; s < shells.size(); ++s) {
      parts.push_back(polygon(flat, *shells[s], holes_of[s]).release());
    }
    const auto count = static_cast<unsigned>(parts.size());
    const Geometry whole =
        own(GEOSGeom_createCollection_r(context, GEOS_MULTIPOLYGON, parts.data(), count));
    if (const auto wrong = fault(flat, whole.get()))
      return Fault(*wrong);
    for (std::size_t s = 0; s < shells.size(); ++s) {
      std::vector<const Ring*> own_rings = holes_of[s];
      own_rings.push_back(shells[s]);
      if (!add_triangles(flat, parts[s], own_rings, triangles))
        return Fault(PolygonFault{});
    }
    return triangles;
  }
};

PolygonCutter::PolygonCutter() : geos_(std::make_unique<Geos>()) {}
PolygonCutter::~PolygonCutter() = default;

std::expected<Triangles, PolygonFault> PolygonCutter::cut(std::span<const Vec3> corners) const {
  Triangles triangles;
  std::vector<Ring> rings = rings_of(corners);
  if (rings.empty())
    return triangles;
  double largest = 0.0;
  for (const Vec3& x : corners)
    largest = std::max(largest, x.cwiseAbs().maxCoeff());
  const Extent extent = extent_of(corners, rings);
  if (extent.width <= 4.0 * kSinglePrecision * largest) {
    for (const Ring& ring : rings)
      add_fan(ring, triangles);
    return triangles;
  }
  const Vec3 area = area_vector(corners, rings);
  if (area.norm() <= kAreaTolerance * extent.length * extent.width) {
    return std::unexpected(PolygonFault{});
  }
  const FlatPolygon flat = flatten(corners, area.normalized(), largest);
  if (rings.size() == 1 && strictly_convex(flat, rings[0])) {
    add_fan(rings[0], triangles);
    return triangles;
  }
  for (Ring& ring : rings)
    take_off_spikes(flat, ring, triangles);
  std::erase_if(rings, [](const Ring& ring) { return ring.size() < 3; });
  return geos_->cut(flat, rings, std::move(triangles));
}

}  // namespace voxtouch::mesh
