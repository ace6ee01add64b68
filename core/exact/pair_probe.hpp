#pragma once
/// Distances from a feature of the tool (element) to those of an object (items), in the object's
/// frame. All real-time safe.
#include <algorithm>
#include <cmath>

#include "core/exact/bodies.hpp"
#include "core/exact/closest.hpp"
#include "core/exact/posed_points.hpp"

namespace voxtouch::exact {

/// An item lies below the height, an element above it. In the object's frame.
struct SeparatingPlane {
  Vec3 normal = Vec3::Zero();  ///< unit; zero where they touch
  double height_m = 0.0;
};

/// A vertex of the tool against faces.
class VertexProbe {
 public:
  static constexpr PairKind kKind = PairKind::kVertexFace;
  using RotationBoundOf = NoRotationBound;
  static NormalCone cone(const ObjectBody&, std::uint32_t) noexcept { return {}; }
  static const ElementTree& elements(const ToolBody& tool) noexcept { return tool.vertices(); }
  static const BoxTree& items(const ObjectBody& object) noexcept { return object.faces(); }
  /// Distance of a point from an item, in the object's frame [m].
  static double distance(const ObjectBody& object, std::uint32_t item, const Vec3& p) noexcept {
    const FeatureMesh& m = object.features();
    const Vec3 &a = m.corner(item, 0), &b = m.corner(item, 1), &c = m.corner(item, 2);
    return (p - nearest_on_triangle(p, a, b, c).point).norm();
  }
  /// Least height of an element along `n` in the tool's frame; greatest height of an item in the
  /// object's frame [m].
  static double lowest(const ToolBody& tool, std::uint32_t element, const Vec3& n) noexcept {
    return n.dot(tool.features().points[tool.features().row_vertices[element]]);
  }
  static double highest(const ObjectBody& object, std::uint32_t item, const Vec3& n) noexcept {
    const FeatureMesh& m = object.features();
    return std::max({n.dot(m.corner(item, 0)), n.dot(m.corner(item, 1)), n.dot(m.corner(item, 2))});
  }

  VertexProbe(const ToolBody& tool, const ObjectBody& object, PosedPoints& posed,
              std::uint32_t element) noexcept
      : object_(object),
        point_(posed.at(tool.features().row_vertices[element])) {}

  double bound(const Box& box) const noexcept {
    return (box.low - point_).cwiseMax(point_ - box.high).cwiseMax(0.0).norm();
  }
  /// Shortest vector from the item to the element [m].
  Vec3 apart(std::uint32_t item) const noexcept {
    const FeatureMesh& m = object_.features();
    const Vec3 &a = m.corner(item, 0), &b = m.corner(item, 1), &c = m.corner(item, 2);
    return point_ - nearest_on_triangle(point_, a, b, c).point;
  }
  /// Least height of the element along `n`, in the object's frame [m].
  double lowest(const Vec3& n) const noexcept { return n.dot(point_); }

 private:
  const ObjectBody& object_;
  Vec3 point_;
};

/// A face of the tool against vertices.
class FaceProbe {
 public:
  static constexpr PairKind kKind = PairKind::kFaceVertex;
  using RotationBoundOf = NoRotationBound;
  static NormalCone cone(const ObjectBody&, std::uint32_t) noexcept { return {}; }
  static const ElementTree& elements(const ToolBody& tool) noexcept { return tool.faces(); }
  static const BoxTree& items(const ObjectBody& object) noexcept { return object.vertices(); }
  static double distance(const ObjectBody& object, std::uint32_t item, const Vec3& p) noexcept {
    const FeatureMesh& m = object.features();
    return (p - m.points[m.row_vertices[item]]).norm();
  }
  static double lowest(const ToolBody& tool, std::uint32_t element, const Vec3& n) noexcept {
    const FeatureMesh& m = tool.features();
    return std::min(
        {n.dot(m.corner(element, 0)), n.dot(m.corner(element, 1)), n.dot(m.corner(element, 2))});
  }
  static double highest(const ObjectBody& object, std::uint32_t item, const Vec3& n) noexcept {
    return n.dot(object.features().points[object.features().row_vertices[item]]);
  }

  FaceProbe(const ToolBody& tool, const ObjectBody& object, PosedPoints& posed,
            std::uint32_t element) noexcept
      : object_(object.features()) {
    const Face& face = tool.features().faces[element];
    for (std::size_t k = 0; k < 3; ++k) {
      corners_[k] = posed.at(face.corners[k]);
      box_.add(corners_[k]);
    }
    normal_ = posed.rotation() * face.normal;
  }

  /// The farther of box from box and box from the face's plane.
  double bound(const Box& box) const noexcept {
    const double half = 0.5 * normal_.cwiseAbs().dot(box.high - box.low);
    const double from_plane = std::abs(normal_.dot(box.centre() - corners_[0])) - half;
    return std::max(exact::distance(box_, box), from_plane);
  }
  Vec3 apart(std::uint32_t item) const noexcept {
    const Vec3& p = object_.points[object_.row_vertices[item]];
    return nearest_on_triangle(p, corners_[0], corners_[1], corners_[2]).point - p;
  }
  double lowest(const Vec3& n) const noexcept {
    return std::min({n.dot(corners_[0]), n.dot(corners_[1]), n.dot(corners_[2])});
  }

 private:
  const FeatureMesh& object_;
  std::array<Vec3, 3> corners_;
  Vec3 normal_;
  Box box_;
};

/// An edge of the tool against edges.
class EdgeProbe {
 public:
  static constexpr PairKind kKind = PairKind::kEdgeEdge;
  using RotationBoundOf = RotationBound;
  static const NormalCone& cone(const ObjectBody& object, std::uint32_t item) noexcept {
    return object.edge_cones()[item];
  }
  static const ElementTree& elements(const ToolBody& tool) noexcept { return tool.edges(); }
  static const BoxTree& items(const ObjectBody& object) noexcept { return object.edges(); }
  static double distance(const ObjectBody& object, std::uint32_t item, const Vec3& p) noexcept {
    const FeatureMesh& m = object.features();
    const Edge& edge = m.edges[m.row_edges[item]];
    const Vec3& from = m.points[edge.ends[0]];
    return std::sqrt(point_segment_distance2(p, from, m.points[edge.ends[1]] - from));
  }
  static double lowest(const ToolBody& tool, std::uint32_t element, const Vec3& n) noexcept {
    return extreme(tool.features(), element, n, -1.0);
  }
  static double highest(const ObjectBody& object, std::uint32_t item, const Vec3& n) noexcept {
    return extreme(object.features(), item, n, 1.0);
  }

  EdgeProbe(const ToolBody& tool, const ObjectBody& object, PosedPoints& posed,
            std::uint32_t element) noexcept
      : object_(object.features()) {
    const Edge& edge = tool.features().edges[tool.features().row_edges[element]];
    from_ = posed.at(edge.ends[0]);
    along_ = posed.at(edge.ends[1]) - from_;
    box_.add(from_);
    box_.add(from_ + along_);
  }

  /// The farther of box from box and the box's ball from the edge.
  double bound(const Box& box) const noexcept {
    const double half = 0.5 * (box.high - box.low).norm();
    const double from_ball = std::sqrt(point_segment_distance2(box.centre(), from_, along_)) - half;
    return std::max(exact::distance(box_, box), from_ball);
  }
  Vec3 apart(std::uint32_t item) const noexcept {
    const Edge& edge = object_.edges[object_.row_edges[item]];
    const Vec3& from = object_.points[edge.ends[0]];
    const Vec3 along = object_.points[edge.ends[1]] - from;
    const OnSegments at = nearest_on_segments(from_, along_, from, along);
    return from_ + at.s * along_ - from - at.t * along;
  }
  double lowest(const Vec3& n) const noexcept {
    return n.dot(from_) + std::min(0.0, n.dot(along_));
  }

 private:
  static double extreme(const FeatureMesh& m, std::uint32_t k, const Vec3& n,
                        double sign) noexcept {
    const Edge& edge = m.edges[m.row_edges[k]];
    const double a = n.dot(m.points[edge.ends[0]]), b = n.dot(m.points[edge.ends[1]]);
    return sign > 0.0 ? std::max(a, b) : std::min(a, b);
  }

  const FeatureMesh& object_;
  Vec3 from_, along_;
  Box box_;
};

}  // namespace voxtouch::exact
