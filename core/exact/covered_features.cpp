#include "core/exact/covered_features.hpp"

#include <algorithm>
#include <cmath>

#include "core/exact/bodies.hpp"
#include "core/exact/closest.hpp"
#include "core/exact/start_check.hpp"

namespace voxtouch::exact {
namespace {

/// A feature is looked at so far off its place [m]: beyond the rounding of CAD meshes, within any
/// wall.
constexpr double kProbeOffsetM = 2e-6;
/// A point nearer than this to a face lies on it [m], likewise.
constexpr double kOnM = 2e-7;
/// Pieces of an edge that are shorter are left out [m].
constexpr double kShortestM = 1e-6;

class Cover {
 public:
  explicit Cover(const FeatureMesh& mesh) : mesh_(mesh), faces_(boxes_of_faces(mesh)) {
    boxes_.resize(mesh.parts.size());
    for (const Face& face : mesh.faces)
      for (const std::uint32_t corner : face.corners)
        boxes_[face.part].add(mesh.points[corner]);
  }

  /// Whether a box of any other part reaches `box`.
  bool may_cover(const Box& box, std::uint32_t part) const {
    for (std::uint32_t p = 0; p < boxes_.size(); ++p)
      if (p != part && distance(box, boxes_[p]) <= kProbeOffsetM)
        return true;
    return false;
  }

  /// Whether the place just outside `face`, next to `point` in direction `inward`, is covered: it
  /// lies inside a closed part.
  bool covers(const Vec3& point, const Vec3& inward, const Face& face) const {
    const Vec3 probe = point + kProbeOffsetM * (inward + 0.5 * face.normal);
    Work work;
    return inside_closed_part(probe, mesh_, faces_, work);
  }

  /// Whether the surface goes on flush beyond a rim of `face`.
  bool continues_at(const Vec3& point, const Vec3& inward, std::uint32_t face) const {
    const Vec3 beyond = point - kProbeOffsetM * inward;
    bool on = false;
    visit_near(beyond, kOnM, [&](std::uint32_t f) {
      on |= f != face && std::abs(mesh_.faces[f].normal.dot(mesh_.faces[face].normal)) > 0.999999;
    });
    return on;
  }

  template <class Visit>
  void visit_near(const Vec3& p, double range, const Visit& visit) const {
    const auto bound = [&](const Box& box) {
      return (box.low - p).cwiseMax(p - box.high).cwiseMax(0.0).norm();
    };
    Work work;
    faces_.walk(
        bound, range,
        [&](std::uint32_t f) {
          const Vec3 on =
              nearest_on_triangle(p, mesh_.corner(f, 0), mesh_.corner(f, 1), mesh_.corner(f, 2))
                  .point;
          if ((p - on).norm() <= range)
            visit(f);
          return true;
        },
        work);
  }

  /// Parameters along the edge at which faces that do not have it begin or end.
  std::vector<double> borders(const Edge& edge) const {
    const Vec3& a = mesh_.points[edge.ends[0]];
    const Vec3 u = mesh_.points[edge.ends[1]] - a;
    std::vector<double> at{0.0, 1.0};
    Box box;
    box.add(a);
    box.add(Vec3(a + u));
    Work work;
    const auto take = [&](double t) {
      if (t > 0.0 && t < 1.0)
        at.push_back(t);
    };
    faces_.walk([&](const Box& other) { return distance(box, other); }, kProbeOffsetM,
                [&](std::uint32_t f) {
                  if (f == edge.faces[0] || f == edge.faces[1])
                    return true;
                  const Face& face = mesh_.faces[f];
                  const double along = face.normal.dot(u);
                  const double height = face.normal.dot(a - mesh_.corner(f, 0));
                  if (std::abs(along) > 1e-9 * u.norm())
                    take(-height / along);
                  for (std::size_t k = 0; k < 3; ++k) {
                    const Vec3 &p = mesh_.corner(f, k), &q = mesh_.corner(f, (k + 1) % 3);
                    const OnSegments on = nearest_on_segments(a, u, p, q - p);
                    if ((a + on.s * u - p - on.t * (q - p)).norm() <= kProbeOffsetM)
                      take(on.s);
                    take((p - a).dot(u) / u.squaredNorm());
                  }
                  return true;
                },
                work);
    std::sort(at.begin(), at.end());
    return at;
  }

 private:
  const FeatureMesh& mesh_;
  BoxTree faces_;
  std::vector<Box> boxes_;
};

bool stands_free(const Cover& cover, const FeatureMesh& mesh, const Edge& edge, const Vec3& point) {
  if (edge.kind == EdgeKind::kRim)
    return !cover.continues_at(point, edge.inward[0], edge.faces[0]);
  for (std::size_t k = 0; k < 2; ++k)
    if (cover.covers(point, edge.inward[k], mesh.faces[edge.faces[k]]))
      return false;
  return true;
}

bool stands_free(const Cover& cover, const FeatureMesh& mesh, std::uint32_t vertex,
                 std::span<const std::uint32_t> faces) {
  for (const std::uint32_t f : faces) {
    Vec3 middle = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k)
      middle += mesh.corner(f, k) / 3.0;
    const Vec3 inward = (middle - mesh.points[vertex]).normalized();
    if (cover.covers(mesh.points[vertex], inward, mesh.faces[f]))
      return false;
  }
  return true;
}

/// The free pieces of an edge, as edges of their own between new points.
void add_free_pieces(const Cover& cover, std::uint32_t number, FeatureMesh& mesh,
                     std::vector<std::uint32_t>& free) {
  const Edge edge = mesh.edges[number];
  const Vec3 a = mesh.points[edge.ends[0]], u = mesh.points[edge.ends[1]] - a;
  const std::vector<double> borders = cover.borders(edge);
  double begins = -1.0;
  std::vector<std::array<double, 2>> pieces;
  for (std::size_t k = 1; k < borders.size(); ++k) {
    const double from = borders[k - 1], to = borders[k];
    if ((to - from) * u.norm() < kShortestM)
      continue;
    if (!stands_free(cover, mesh, edge, a + 0.5 * (from + to) * u)) {
      begins = -1.0;
      continue;
    }
    if (begins < 0.0) {
      begins = from;
      pieces.push_back({from, to});
    }
    pieces.back()[1] = to;
  }
  mesh.edges[number].covered = pieces.size() != 1 || pieces[0][0] > 0.0 || pieces[0][1] < 1.0;
  for (const auto& [from, to] : pieces) {
    if (from <= 0.0 && to >= 1.0) {
      free.push_back(number);
      continue;
    }
    Edge piece = edge;
    for (std::size_t k = 0; k < 2; ++k) {
      const double t = k == 0 ? from : to;
      if (t <= 0.0 || t >= 1.0)
        continue;
      piece.ends[k] = static_cast<std::uint32_t>(mesh.points.size());
      mesh.points.push_back(a + t * u);
      mesh.vertices.push_back({});
    }
    free.push_back(static_cast<std::uint32_t>(mesh.edges.size()));
    mesh.edges.push_back(piece);
  }
}

}  // namespace

void uncover_features(FeatureMesh& mesh) {
  const bool several = mesh.parts.size() > 1;
  const auto rim = [&](std::uint32_t e) { return mesh.edges[e].kind == EdgeKind::kRim; };
  if (!several && std::none_of(mesh.row_edges.begin(), mesh.row_edges.end(), rim))
    return;
  const Cover cover(mesh);
  std::vector<std::uint32_t> edges;
  std::vector<bool> touched(mesh.points.size(), false);
  for (const std::uint32_t e : mesh.row_edges) {
    const Edge& edge = mesh.edges[e];
    Box box;
    for (const std::uint32_t end : edge.ends)
      box.add(mesh.points[end]);
    if (!rim(e) && !cover.may_cover(box, mesh.faces[edge.faces[0]].part)) {
      edges.push_back(e);
      continue;
    }
    for (const std::uint32_t end : edge.ends)
      touched[end] = true;
    add_free_pieces(cover, e, mesh, edges);
  }
  std::vector<std::vector<std::uint32_t>> around(touched.size());
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f)
    for (const std::uint32_t corner : mesh.faces[f].corners)
      if (touched[corner])
        around[corner].push_back(f);
  std::vector<bool> has_edge(mesh.points.size(), false);
  for (const std::uint32_t e : edges)
    for (const std::uint32_t end : mesh.edges[e].ends)
      has_edge[end] = true;
  for (std::uint32_t v = 0; v < touched.size(); ++v)
    mesh.vertices[v].covered =
        touched[v] && (!has_edge[v] || !stands_free(cover, mesh, v, around[v]));
  std::erase_if(mesh.row_vertices, [&](std::uint32_t v) { return mesh.vertices[v].covered; });
  mesh.row_edges = std::move(edges);
}

}  // namespace voxtouch::exact
