#include "core/exact/bodies.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/exact/closest.hpp"
#include "core/exact/covered_features.hpp"

namespace voxtouch::exact {
namespace {

std::vector<Box> edge_boxes(const FeatureMesh& features) {
  std::vector<Box> boxes;
  boxes.reserve(features.row_edges.size());
  for (const std::uint32_t e : features.row_edges) {
    Box box;
    for (const std::uint32_t end : features.edges[e].ends)
      box.add(features.points[end]);
    boxes.push_back(box);
  }
  return boxes;
}

std::vector<Box> vertex_boxes(const FeatureMesh& features) {
  std::vector<Box> boxes;
  boxes.reserve(features.row_vertices.size());
  for (const std::uint32_t v : features.row_vertices) {
    Box box;
    box.add(features.points[v]);
    boxes.push_back(box);
  }
  return boxes;
}

std::vector<Ball> vertex_balls(const FeatureMesh& features) {
  std::vector<Ball> balls;
  balls.reserve(features.row_vertices.size());
  for (const std::uint32_t v : features.row_vertices)
    balls.push_back({features.points[v], 0.0});
  return balls;
}

std::vector<Ball> edge_balls(const FeatureMesh& features) {
  std::vector<Ball> balls;
  balls.reserve(features.row_edges.size());
  for (const std::uint32_t e : features.row_edges) {
    const Vec3& a = features.points[features.edges[e].ends[0]];
    const Vec3& b = features.points[features.edges[e].ends[1]];
    balls.push_back({0.5 * (a + b), 0.5 * (a - b).norm()});
  }
  return balls;
}

std::vector<Ball> face_balls(const FeatureMesh& features) {
  std::vector<Ball> balls;
  balls.reserve(features.faces.size());
  for (std::uint32_t f = 0; f < features.faces.size(); ++f) {
    Box box;
    for (std::size_t k = 0; k < 3; ++k)
      box.add(features.corner(f, k));
    Ball ball{box.centre(), 0.0};
    for (std::size_t k = 0; k < 3; ++k)
      ball.radius = std::max(ball.radius, (features.corner(f, k) - ball.centre).norm());
    balls.push_back(ball);
  }
  return balls;
}

ElementTree::Spread vertex_spread(const FeatureMesh& m) {
  return [&m](std::uint32_t from, std::uint32_t to) {
    return (m.points[m.row_vertices[to]] - m.points[m.row_vertices[from]]).norm();
  };
}

ElementTree::Spread edge_spread(const FeatureMesh& m) {
  return [&m](std::uint32_t from, std::uint32_t to) {
    const Edge& edge = m.edges[m.row_edges[from]];
    const Vec3& a = m.points[edge.ends[0]];
    const Vec3 along = m.points[edge.ends[1]] - a;
    double most2 = 0.0;
    for (const std::uint32_t end : m.edges[m.row_edges[to]].ends)
      most2 = std::max(most2, point_segment_distance2(m.points[end], a, along));
    return std::sqrt(most2);
  };
}

ElementTree::Spread face_spread(const FeatureMesh& m) {
  return [&m](std::uint32_t from, std::uint32_t to) {
    double most = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = m.corner(to, k);
      const OnTriangle on =
          nearest_on_triangle(p, m.corner(from, 0), m.corner(from, 1), m.corner(from, 2));
      most = std::max(most, (p - on.point).norm());
    }
    return most;
  };
}

}  // namespace

std::vector<Box> boxes_of_faces(const FeatureMesh& features) {
  std::vector<Box> boxes(features.faces.size());
  for (std::uint32_t f = 0; f < boxes.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k)
      boxes[f].add(features.corner(f, k));
  return boxes;
}

std::vector<NormalCone> edge_cones(const FeatureMesh& features) {
  std::vector<NormalCone> cones;
  cones.reserve(features.row_edges.size());
  for (const std::uint32_t e : features.row_edges) {
    const Edge& edge = features.edges[e];
    const Face& first = features.faces[edge.faces[0]];
    const bool of_solid = edge.kind == EdgeKind::kConvex && !first.two_sided;
    cones.push_back(of_solid ? NormalCone(first.normal, features.faces[edge.faces[1]].normal)
                             : NormalCone::all());
  }
  return cones;
}

FeatureMesh free_features(const mesh::TriangleMesh& mesh) {
  FeatureMesh features = find_features(mesh);
  uncover_features(features);
  return features;
}

ObjectBody::ObjectBody(const mesh::TriangleMesh& mesh, std::span<const std::uint32_t> owners)
    : features_(free_features(mesh)),
      edge_cones_(exact::edge_cones(features_)),
      faces_(boxes_of_faces(features_)),
      edges_(edge_boxes(features_), edge_cones_),
      vertices_(vertex_boxes(features_)) {
  if (owners.empty())
    return;
  if (owners.size() != mesh.triangles.size())
    throw std::invalid_argument("exact body: each triangle needs an owner");
  for (const Face& face : features_.faces)
    owner_of_face_.push_back(owners[face.triangle]);
  owners_ = std::size_t{*std::max_element(owners.begin(), owners.end())} + 1;
}

std::uint32_t ObjectBody::owner_of(PairKind kind, std::uint32_t item) const noexcept {
  if (owner_of_face_.empty())
    return 0;
  switch (kind) {
    case PairKind::kVertexFace:
      return owner_of_face_[item];
    case PairKind::kFaceVertex:
      return owner_of_face_[features_.vertices[features_.row_vertices[item]].face];
    case PairKind::kEdgeEdge:
      break;
  }
  return owner_of_face_[features_.edges[features_.row_edges[item]].faces[0]];
}

ToolBody::ToolBody(const mesh::TriangleMesh& mesh)
    : features_(free_features(mesh)),
      vertices_(vertex_balls(features_), vertex_spread(features_)),
      faces_(face_balls(features_), face_spread(features_)),
      edges_(edge_balls(features_), edge_spread(features_), edge_cones(features_)),
      face_boxes_(boxes_of_faces(features_)) {}

}  // namespace voxtouch::exact
