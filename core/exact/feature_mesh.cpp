#include "core/exact/feature_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/exact/limits.hpp"
#include "core/mesh/topology.hpp"
#include "core/mesh/weld.hpp"

namespace voxtouch::exact {
namespace {

void add_faces(const mesh::TriangleMesh& welded, FeatureMesh& out) {
  const std::vector<std::uint32_t> stands = mesh::standing_vertices(welded, 0.0);
  const std::vector<mesh::TriangleKind> kinds = mesh::triangle_kinds(welded, stands);
  for (std::size_t t = 0; t < kinds.size(); ++t) {
    if (kinds[t] != mesh::TriangleKind::kSound)
      continue;
    Face face;
    face.triangle = static_cast<std::uint32_t>(t);
    for (std::size_t k = 0; k < 3; ++k)
      face.corners[k] = stands[welded.triangles[t][k]];
    const Vec3& a = out.points[face.corners[0]];
    const Vec3 ab = out.points[face.corners[1]] - a;
    const Vec3 ac = out.points[face.corners[2]] - a;
    face.normal = ab.cross(ac).normalized();
    out.faces.push_back(face);
  }
  if (out.faces.empty())
    throw std::runtime_error("exact tool: the mesh has no valid triangle");
}

/// The faces as a mesh, for mesh::sorted_sides.
mesh::TriangleMesh faces_as_mesh(const FeatureMesh& features) {
  mesh::TriangleMesh mesh;
  mesh.vertices = features.points;
  for (const Face& face : features.faces)
    mesh.triangles.push_back(face.corners);
  return mesh;
}

Vec3 inward_of(const FeatureMesh& m, std::uint32_t face, const Vec3& from, const Vec3& along) {
  const Face& f = m.faces[face];
  const Vec3 centre = (m.corner(face, 0) + m.corner(face, 1) + m.corner(face, 2)) / 3.0;
  const Vec3 across = f.normal.cross(along).normalized();
  return across.dot(centre - from) < 0.0 ? Vec3(-across) : across;
}

EdgeKind kind_of(const FeatureMesh& m, const Edge& edge) {
  const Vec3& n = m.faces[edge.faces[0]].normal;
  const double rise = edge.inward[1].dot(n);  // sine of the fold: above zero, the second face rises
  const double run = -edge.inward[1].dot(edge.inward[0]);  // its cosine
  if (run > 0.0 && std::abs(rise) < std::sin(limits::kFlatEdgeRad))
    return EdgeKind::kFlat;
  return rise > 0.0 ? EdgeKind::kConcave : EdgeKind::kConvex;
}

void add_edge(const mesh::Side& side, std::uint32_t other_face, FeatureMesh& out) {
  Edge edge;
  edge.ends = {side.low, side.high};
  edge.faces = {side.triangle, other_face};
  const Vec3& from = out.points[side.low];
  const Vec3 along = (out.points[side.high] - from).normalized();
  edge.inward[0] = inward_of(out, side.triangle, from, along);
  edge.inward[1] = other_face == kNone ? Vec3::Zero() : inward_of(out, other_face, from, along);
  edge.kind = other_face == kNone ? EdgeKind::kRim : kind_of(out, edge);
  const auto number = static_cast<std::uint32_t>(out.edges.size());
  for (const std::uint32_t f : edge.faces) {
    if (f == kNone)
      continue;
    Face& face = out.faces[f];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = face.corners[k], b = face.corners[(k + 1) % 3];
      if (std::min(a, b) == side.low && std::max(a, b) == side.high)
        face.edges[k] = number;
    }
  }
  out.edges.push_back(edge);
}

/// Where as many faces go one way along an edge as the other, each two that enclose solid between
/// them share it: welded solids that touch along an edge stay apart. False where there are not.
bool add_pairs(std::span<const mesh::Side> sides, FeatureMesh& out) {
  std::vector<mesh::Side> forward, backward;
  for (const mesh::Side& side : sides)
    (side.forward ? forward : backward).push_back(side);
  if (forward.size() != backward.size())
    return false;
  const Vec3& from = out.points[sides[0].low];
  const Vec3 along = (out.points[sides[0].high] - from).normalized();
  for (const mesh::Side& side : forward) {
    const Vec3 inward = inward_of(out, side.triangle, from, along);
    const Vec3& normal = out.faces[side.triangle].normal;
    const auto angle_to = [&](const mesh::Side& other) {  // through the solid
      const Vec3 there = inward_of(out, other.triangle, from, along);
      const double angle = std::atan2(-normal.dot(there), inward.dot(there));
      return angle > limits::kFlatEdgeRad ? angle : angle + 2.0 * std::numbers::pi;
    };
    const auto nearest = std::min_element(
        backward.begin(), backward.end(),
        [&](const mesh::Side& a, const mesh::Side& b) { return angle_to(a) < angle_to(b); });
    add_edge(side, nearest->triangle, out);
    backward.erase(nearest);
  }
  return true;
}

void add_edges(FeatureMesh& out) {
  const mesh::TriangleMesh mesh = faces_as_mesh(out);
  std::vector<std::uint32_t> stands(out.points.size()), which(out.faces.size());
  for (std::uint32_t v = 0; v < stands.size(); ++v)
    stands[v] = v;
  for (std::uint32_t f = 0; f < which.size(); ++f)
    which[f] = f;
  const std::vector<mesh::Side> sides = mesh::sorted_sides(mesh, stands, which);
  mesh::for_edges(sides, [&](std::size_t first, std::size_t last) {
    const bool shared = last - first == 2 && sides[first].forward != sides[first + 1].forward;
    if (shared)
      return add_edge(sides[first], sides[first + 1].triangle, out);
    if (add_pairs({sides.data() + first, last - first}, out))
      return;
    for (std::size_t k = first; k < last; ++k)
      add_edge(sides[k], kNone, out);
  });
}

/// Faces that share edges are one part, numbered by their first faces.
void add_parts(FeatureMesh& out) {
  std::vector<std::uint32_t> first(out.faces.size());
  for (std::uint32_t f = 0; f < first.size(); ++f)
    first[f] = f;
  const auto find = [&](std::uint32_t f) {
    while (first[f] != f)
      f = first[f] = first[first[f]];
    return f;
  };
  for (const Edge& edge : out.edges) {
    if (edge.faces[1] == kNone)
      continue;
    const std::uint32_t a = find(edge.faces[0]), b = find(edge.faces[1]);
    first[std::max(a, b)] = std::min(a, b);
  }
  for (std::uint32_t f = 0; f < first.size(); ++f) {
    if (find(f) == f) {
      out.faces[f].part = static_cast<std::uint32_t>(out.parts.size());
      out.parts.push_back({true, out.faces[f].corners[0]});
    } else {
      out.faces[f].part = out.faces[find(f)].part;
    }
  }
  for (const Edge& edge : out.edges)
    if (edge.kind == EdgeKind::kRim)
      out.parts[out.faces[edge.faces[0]].part].closed = false;
  for (Face& face : out.faces)
    face.two_sided = !out.parts[face.part].closed;
}

void add_vertices(FeatureMesh& out) {
  out.vertices.resize(out.points.size());
  for (const Edge& edge : out.edges)
    for (const std::uint32_t end : edge.ends)
      ++out.vertices[end].directions;
  std::uint32_t first = 0;
  for (Vertex& vertex : out.vertices) {
    vertex.first_direction = first;
    first += vertex.directions;
    vertex.directions = 0;
  }
  out.directions.resize(first);
  for (const Edge& edge : out.edges) {
    const Vec3 along = (out.points[edge.ends[1]] - out.points[edge.ends[0]]).normalized();
    for (std::size_t k = 0; k < 2; ++k) {
      Vertex& vertex = out.vertices[edge.ends[k]];
      out.directions[vertex.first_direction + vertex.directions++] = k == 0 ? along : Vec3(-along);
      vertex.makes_rows |= edge.makes_rows();
    }
  }
  for (std::uint32_t f = 0; f < out.faces.size(); ++f)
    for (const std::uint32_t corner : out.faces[f].corners)
      out.vertices[corner].face = std::min(out.vertices[corner].face, f);
}

}  // namespace

FeatureMesh find_features(const mesh::TriangleMesh& mesh) {
  FeatureMesh out;
  const mesh::TriangleMesh welded = mesh::weld(mesh);
  out.points = welded.vertices;
  add_faces(welded, out);
  add_edges(out);
  add_parts(out);
  add_vertices(out);
  for (std::uint32_t e = 0; e < out.edges.size(); ++e)
    if (out.edges[e].makes_rows())
      out.row_edges.push_back(e);
  for (std::uint32_t v = 0; v < out.vertices.size(); ++v) {
    if (out.vertices[v].makes_rows)
      out.row_vertices.push_back(v);
    if (out.vertices[v].face != kNone)
      out.reach_m = std::max(out.reach_m, out.points[v].norm());
  }
  return out;
}

}  // namespace voxtouch::exact
