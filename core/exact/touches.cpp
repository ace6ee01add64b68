#include "core/exact/touches.hpp"

#include <cmath>

#include "core/exact/crossing.hpp"
#include "core/exact/limits.hpp"

namespace voxtouch::exact {
namespace {

constexpr double kTie = 1e-9;  // sine: points above a flat edge are above both faces

/// A point in front of a mesh.
struct Facing {
  Vec3 normal = Vec3::Zero();  ///< unit, from the mesh to the point
  double gap_m = 0.0;
};
struct Facings {
  std::array<Facing, 4> of;
  std::size_t count = 0;
  void add(const Facing& facing) noexcept { of[count++] = facing; }
};

/// Planes of neighbours that rise from the face on the side where `p` is, and beyond which `p`
/// projects.
void add_rising_planes(const Vec3& p, const FeatureMesh& mesh, std::uint32_t f, double side,
                       Facings& out) noexcept {
  const EdgeKind rising = side > 0.0 ? EdgeKind::kConcave : EdgeKind::kConvex;
  for (const std::uint32_t e : mesh.faces[f].edges) {
    const Edge& edge = mesh.edges[e];
    if (edge.kind != rising)
      continue;
    const std::size_t other = edge.faces[0] == f ? 1 : 0;
    const Vec3 from_edge = p - mesh.points[edge.ends[0]];
    if (!(from_edge.dot(edge.inward[other]) < 0.0))
      continue;  // else the neighbour has a row of its own
    const Vec3 normal = side * mesh.faces[edge.faces[other]].normal;
    const double gap = normal.dot(from_edge);
    if (gap > 0.0)
      out.add({normal, gap});
  }
}

bool in_region_of(const Edge& edge, const Vec3& offset, double length) noexcept {
  return offset.dot(edge.inward[0]) <= kTie * length && offset.dot(edge.inward[1]) <= kTie * length;
}

bool in_region_of(const FeatureMesh& mesh, std::uint32_t vertex, const Vec3& offset,
                  double length) noexcept {
  for (const Vec3& along : mesh.directions_of(vertex))
    if (offset.dot(along) > kTie * length)
      return false;
  return true;
}

/// How `p` faces triangle `f` of the mesh, both in the mesh's frame; `corners`: its corners count
/// as well.
Facings facings_of(const Vec3& p, const FeatureMesh& mesh, std::uint32_t f, bool corners) noexcept {
  Facings out;
  const Face& face = mesh.faces[f];
  const Vec3& a = mesh.corner(f, 0);
  const OnTriangle on = nearest_on_triangle(p, a, mesh.corner(f, 1), mesh.corner(f, 2));
  if (on.region == region::kFace) {
    const double height = face.normal.dot(p - a);
    if (height < 0.0 && !face.two_sided)
      return out;  // of a closed solid, and another wall is between
    const double side = height < 0.0 ? -1.0 : 1.0;
    out.add({side * face.normal, side * height});
    add_rising_planes(p, mesh, f, side, out);
    return out;
  }
  const Vec3 offset = p - on.point;
  const double length = offset.norm();
  if (!(length > 0.0))
    return out;
  const bool behind = !face.two_sided && offset.dot(face.normal) < 0.0;
  if (on.region >= region::kSide) {
    const Edge& edge = mesh.edges[face.edges[static_cast<std::size_t>(on.region - region::kSide)]];
    if (edge.covered || edge.faces[0] != f || !in_region_of(edge, offset, length))
      return out;
    if (behind && edge.kind != EdgeKind::kConvex)
      return out;
  } else {
    const std::uint32_t corner = face.corners[static_cast<std::size_t>(on.region)];
    const Vertex& vertex = mesh.vertices[corner];
    if (!corners || vertex.covered || vertex.face != f ||
        !in_region_of(mesh, corner, offset, length))
      return out;
    if (behind && !mesh.vertices[corner].makes_rows)
      return out;
  }
  out.add({offset / length, length});
  return out;
}

/// Sine of the angle by which the tool may turn in the step: nothing to spare where the gap is near
/// the margin.
double rotation_margin_sine(double gap_m, double reach_m, const ToolBody& tool) noexcept {
  return gap_m > limits::kBeyondEndsMargins * limits::kMarginM ? reach_m / tool.features().reach_m
                                                               : 0.0;
}

/// Whether all edges at a vertex rise from the plane whose normal, from the plane to the vertex, is
/// given.
bool rises(std::span<const Vec3> directions, const Vec3& normal, double spare) noexcept {
  for (const Vec3& along : directions)
    if (normal.dot(along) < -limits::kVertexConeSine - spare)
      return false;
  return true;
}

Touches vertex_face(const NearPair& pair, const ToolBody& tool, const ObjectBody& object,
                    PosedPoints& posed, double reach_m) noexcept {
  Touches out;
  const std::uint32_t vertex = tool.features().row_vertices[pair.element];
  const Vec3& p = posed.at(vertex);
  const Facings facings = facings_of(p, object.features(), pair.item, true);
  for (std::size_t k = 0; k < facings.count; ++k) {
    const Facing& facing = facings.of[k];
    const Vec3 normal_T = posed.rotation().transpose() * facing.normal;
    const double spare = rotation_margin_sine(facing.gap_m, reach_m, tool);
    if (rises(tool.features().directions_of(vertex), normal_T, spare))
      out.add({facing.normal, p, facing.gap_m});
  }
  return out;
}

Touches face_vertex(const NearPair& pair, const ToolBody& tool, const ObjectBody& object,
                    PosedPoints& posed, double reach_m) noexcept {
  Touches out;
  const std::uint32_t vertex = object.features().row_vertices[pair.item];
  const Vec3& p = object.features().points[vertex];
  const Facings facings = facings_of(posed.to_tool(p), tool.features(), pair.element, false);
  for (std::size_t k = 0; k < facings.count; ++k) {
    const Vec3 towards = posed.rotation() * facings.of[k].normal;  // from the tool to the vertex
    const double spare = rotation_margin_sine(facings.of[k].gap_m, reach_m, tool);
    if (!rises(object.features().directions_of(vertex), towards, spare))
      continue;
    out.add({-towards, p - facings.of[k].gap_m * towards, facings.of[k].gap_m});
  }
  return out;
}

/// Two edges in the object's frame: p + s u of the tool, q + t v of the object.
struct Edges {
  const Edge& tool;
  const Edge& object;
  Vec3 p, u, q, v;
};

Edges edges_of(const NearPair& pair, const ToolBody& tool, const ObjectBody& object,
               PosedPoints& posed) noexcept {
  const FeatureMesh &a = tool.features(), &b = object.features();
  const Edge& on_tool = a.edges[a.row_edges[pair.element]];
  const Edge& on_object = b.edges[b.row_edges[pair.item]];
  const Vec3& p = posed.at(on_tool.ends[0]);
  const Vec3& q = b.points[on_object.ends[0]];
  return {on_tool, on_object, p, posed.at(on_tool.ends[1]) - p, q, b.points[on_object.ends[1]] - q};
}

/// Where two lines are nearest: parameters, and twice the area that gives how far from parallel
/// they are.
struct OnLines {
  double s = 0.0, t = 0.0;
  Vec3 across = Vec3::Zero();
  bool parallel = true;
};

OnLines nearest_on_lines(const Edges& e) noexcept {
  OnLines on;
  on.across = e.u.cross(e.v);
  const double area2 = on.across.squaredNorm();
  on.parallel = !(area2 > 1e-12 * e.u.squaredNorm() * e.v.squaredNorm());
  if (on.parallel)
    return on;
  const Vec3 between = e.q - e.p;
  on.s = between.cross(e.v).dot(on.across) / area2;
  on.t = between.cross(e.u).dot(on.across) / area2;
  return on;
}

bool within_ends(double parameter, double length, double beyond) noexcept {
  return parameter * length >= -beyond && (parameter - 1.0) * length <= beyond;
}

Touches edge_edge(const NearPair& pair, const ToolBody& tool, const ObjectBody& object,
                  PosedPoints& posed, double reach_m) noexcept {
  Touches out;
  const Edges e = edges_of(pair, tool, object, posed);
  const OnLines on = nearest_on_lines(e);
  if (on.parallel)
    return out;  // their ends make the rows
  Vec3 normal = on.across.normalized();
  double gap = normal.dot(e.p - e.q);
  if (gap < 0.0) {
    gap = -gap;
    normal = -normal;
  }
  // Near the margin a row beyond an end would hold what is free; farther off it saves a void step.
  const double beyond = gap > limits::kBeyondEndsMargins * limits::kMarginM ? reach_m : 0.0;
  if (!within_ends(on.s, e.u.norm(), beyond) || !within_ends(on.t, e.v.norm(), beyond))
    return out;
  const Vec3 normal_T = posed.rotation().transpose() * normal;
  const double cone = limits::kEdgeConeSine + rotation_margin_sine(gap, reach_m, tool);
  for (std::size_t k = 0; k < 2; ++k) {
    if (normal.dot(e.object.inward[k]) > cone)
      return out;
    if (normal_T.dot(e.tool.inward[k]) < -cone)
      return out;
  }
  out.add({normal, e.p + on.s * e.u, gap});
  return out;
}

/// The plane of face `f` on the side of `p`; or, where `p` is nearly in that plane but next to the
/// face, the plane across the way to its nearest point. `then`: the gap of `moved`.
Facing plane_between(const Vec3& p, const Vec3& moved, const FeatureMesh& mesh, std::uint32_t f,
                     double& then) noexcept {
  const Vec3& a = mesh.corner(f, 0);
  const Vec3 on = nearest_on_triangle(p, a, mesh.corner(f, 1), mesh.corner(f, 2)).point;
  const Vec3& n = mesh.faces[f].normal;
  const double height = n.dot(p - a), length = (p - on).norm();
  Facing facing{height < 0.0 ? Vec3(-n) : n, std::abs(height)};
  if (std::abs(height) < 0.5 * length)
    facing = {(p - on) / length, length};
  then = facing.gap_m + facing.normal.dot(moved - p);
  return facing;
}

std::array<MovingPoint, 3> moving_face(const Face& face, PosedPoints& posed,
                                       PosedPoints& next) noexcept {
  std::array<MovingPoint, 3> corners;
  for (std::size_t k = 0; k < 3; ++k)
    corners[k] = {posed.at(face.corners[k]), next.at(face.corners[k])};
  return corners;
}

}  // namespace

Touches touches_of(const NearPair& pair, const ToolBody& tool, const ObjectBody& object,
                   PosedPoints& posed, double reach_m) noexcept {
  switch (pair.kind) {
    case PairKind::kVertexFace:
      return vertex_face(pair, tool, object, posed, reach_m);
    case PairKind::kFaceVertex:
      return face_vertex(pair, tool, object, posed, reach_m);
    case PairKind::kEdgeEdge:
      break;
  }
  return edge_edge(pair, tool, object, posed, reach_m);
}

Touch passed_touch(const NearPair& pair, const ToolBody& tool, const ObjectBody& object,
                   PosedPoints& posed, PosedPoints& next, double& found_m) noexcept {
  if (pair.kind == PairKind::kVertexFace) {
    const std::uint32_t vertex = tool.features().row_vertices[pair.element];
    const Vec3& p = posed.at(vertex);
    const Facing facing = plane_between(p, next.at(vertex), object.features(), pair.item, found_m);
    return {facing.normal, p, facing.gap_m};
  }
  if (pair.kind == PairKind::kFaceVertex) {
    const Vec3& p = object.features().points[object.features().row_vertices[pair.item]];
    const Facing facing =
        plane_between(posed.to_tool(p), next.to_tool(p), tool.features(), pair.element, found_m);
    const Vec3 towards = posed.rotation() * facing.normal;
    return {-towards, p - facing.gap_m * towards, facing.gap_m};
  }
  const Edges e = edges_of(pair, tool, object, posed);
  const OnSegments on = nearest_on_segments(e.p, e.u, e.q, e.v);
  const Vec3 offset = e.p + on.s * e.u - e.q - on.t * e.v;
  const double gap = offset.norm();
  const Vec3 normal = gap > 0.0 ? Vec3(offset / gap) : Vec3(e.u.cross(e.v).normalized());
  const Edges then = edges_of(pair, tool, object, next);
  Vec3 normal_after = then.u.cross(then.v).normalized();
  if (normal_after.dot(normal) < 0.0)
    normal_after = -normal_after;
  const bool crossed = normal_after.dot(normal) > 0.5;  // else nearly parallel: the same points
  const Vec3 between = then.p + on.s * then.u - then.q - on.t * then.v;
  found_m = crossed ? normal_after.dot(then.p - then.q) : normal.dot(between);
  return {normal, e.p + on.s * e.u, gap};
}

bool stays_apart(const NearPair& pair, const ToolBody& tool, const PosedPoints& next) noexcept {
  const Vec3& n = pair.plane.normal;
  const Vec3 n_T = next.rotation().transpose() * n;
  double lowest = n.dot(next.pose().position);
  switch (pair.kind) {
    case PairKind::kVertexFace:
      lowest += VertexProbe::lowest(tool, pair.element, n_T);
      break;
    case PairKind::kFaceVertex:
      lowest += FaceProbe::lowest(tool, pair.element, n_T);
      break;
    case PairKind::kEdgeEdge:
      lowest += EdgeProbe::lowest(tool, pair.element, n_T);
      break;
  }
  return lowest > pair.plane.height_m + limits::kTouchM;
}

bool passes(const NearPair& pair, const ToolBody& tool, const ObjectBody& object,
            PosedPoints& posed, PosedPoints& next) noexcept {
  const FeatureMesh &a = tool.features(), &b = object.features();
  if (pair.kind == PairKind::kVertexFace) {
    const std::uint32_t vertex = a.row_vertices[pair.element];
    std::array<MovingPoint, 3> face;
    for (std::size_t k = 0; k < 3; ++k)
      face[k] = {b.corner(pair.item, k), b.corner(pair.item, k)};
    return vertex_passes_face({posed.at(vertex), next.at(vertex)}, face);
  }
  if (pair.kind == PairKind::kFaceVertex) {
    const Vec3& p = b.points[b.row_vertices[pair.item]];
    return vertex_passes_face({p, p}, moving_face(a.faces[pair.element], posed, next));
  }
  const Edge& on_tool = a.edges[a.row_edges[pair.element]];
  const Edge& on_object = b.edges[b.row_edges[pair.item]];
  std::array<MovingPoint, 2> moving, still;
  for (std::size_t k = 0; k < 2; ++k) {
    moving[k] = {posed.at(on_tool.ends[k]), next.at(on_tool.ends[k])};
    still[k] = {b.points[on_object.ends[k]], b.points[on_object.ends[k]]};
  }
  return edges_pass(moving, still);
}

}  // namespace voxtouch::exact
