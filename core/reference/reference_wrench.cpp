#include "core/reference/reference_wrench.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/reference/inside_test.hpp"
#include "core/reference/posed_mesh.hpp"

namespace voxtouch::reference {
namespace {

using Corners = std::array<Vec3, 3>;

constexpr double kCrossingShare = 0.25;  ///< triangles across the surface are split this much finer
constexpr std::size_t kLeafTriangles = 4;

/// Which way round a triangle of a closed mesh faces outward: +1 as it is, -1 the other way.
int outward(const InsideTest& body, const Corners& c) {
  const Vec3 normal = (c[1] - c[0]).cross(c[2] - c[0]).stableNormalized(), middle = (c[0] + c[1] + c[2]) / 3.0;
  const double size = std::max({(c[1] - c[0]).norm(), (c[2] - c[0]).norm(), (c[2] - c[1]).norm()});
  const Vec3 step = (1e-6 * size + 1e-12 * middle.cwiseAbs().maxCoeff()) * normal;
  const bool before = body.inside(middle + step), behind = body.inside(middle - step);
  return before && !behind ? -1 : 1;  // both: a wall within the body, which its other half undoes
}

/// In T. A closed tool pushes outward whichever way round its file has the triangles; an open one has no outside, and keeps them.
std::vector<Corners> outward_triangles(const ReferenceMesh& mesh, const Pose& pose_TM) {
  const InsideTest body(mesh);
  std::vector<Corners> triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Corners c{mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)};
    if (mesh.closed && outward(body, c) < 0) std::swap(c[1], c[2]);
    for (Vec3& corner : c) corner = pose_TM * corner;
    triangles.push_back(c);
  }
  return triangles;
}

/// Balls round runs of the tool's triangles, as a binary tree laid out depth first.
class TriangleTree {
 public:
  struct Node {
    Vec3 centre = Vec3::Zero();
    double radius = 0.0;
    std::uint32_t first = 0, last = 0, skip = 0;  ///< triangles; node after this branch
    bool leaf = false;
  };

  explicit TriangleTree(std::vector<Corners> triangles) : triangles_(std::move(triangles)) {
    build(0, static_cast<std::uint32_t>(triangles_.size()));
  }
  const std::vector<Node>& nodes() const noexcept { return nodes_; }
  const Corners& triangle(std::size_t t) const noexcept { return triangles_[t]; }

 private:
  static Vec3 centroid(const Corners& c) { return (c[0] + c[1] + c[2]) / 3.0; }

  void build(std::uint32_t first, std::uint32_t last) {
    const std::size_t here = nodes_.size();
    nodes_.emplace_back();
    Vec3 low = triangles_[first][0], high = low;
    for (std::uint32_t t = first; t < last; ++t)
      for (const Vec3& corner : triangles_[t]) low = low.cwiseMin(corner), high = high.cwiseMax(corner);
    Node node{0.5 * (low + high), 0.0, first, last, 0, last - first <= kLeafTriangles};
    for (std::uint32_t t = first; t < last; ++t)
      for (const Vec3& corner : triangles_[t]) node.radius = std::max(node.radius, (corner - node.centre).norm());
    if (!node.leaf) {
      Eigen::Index axis = 0;
      (high - low).maxCoeff(&axis);
      const std::uint32_t middle = (first + last) / 2;
      // Equal centroids are told apart by all their numbers, so that the order, and so the sum's bits, are the same everywhere.
      const auto key = [axis](const Corners& c) {
        const Vec3 at = centroid(c);
        return std::array{at[axis], at.x(), at.y(), at.z()};
      };
      std::stable_sort(triangles_.begin() + first, triangles_.begin() + last,
                       [&](const Corners& a, const Corners& b) { return key(a) < key(b); });
      build(first, middle);
      build(middle, last);
    }
    node.skip = static_cast<std::uint32_t>(nodes_.size());
    nodes_[here] = node;
  }

  std::vector<Corners> triangles_;
  std::vector<Node> nodes_;
};

/// One pose's integral.
class Integral {
 public:
  Integral(const std::vector<PosedMesh>& statics, const Pose& tool, double resolution)
      : statics_(statics), tool_(tool), resolution_(resolution) {}

  void run(const TriangleTree& tree) {
    for (std::size_t n = 0; n < tree.nodes().size();) {
      const TriangleTree::Node& node = tree.nodes()[n];
      if (distance(tool_ * node.centre) > node.radius) {
        n = node.skip;
        continue;
      }
      if (node.leaf)
        for (std::uint32_t t = node.first; t < node.last; ++t) {
          const Corners& c = tree.triangle(t);
          const Vec3 twice_area = (c[1] - c[0]).cross(c[2] - c[0]);
          if (!twice_area.isZero(0.0)) add({tool_ * c[0], tool_ * c[1], tool_ * c[2]}, tool_.orientation * twice_area);
        }
      n = node.leaf ? node.skip : n + 1;
    }
  }
  const TrueWrench& result() const noexcept { return out_; }

 private:
  double distance(const Vec3& x) {
    ++out_.samples;
    double least = statics_.front().mesh_signed_distance(x).distance_m;
    for (std::size_t i = 1; i < statics_.size(); ++i)
      least = std::min(least, statics_[i].mesh_signed_distance(x).distance_m);
    return least;
  }

  void add(const Corners& c, const Vec3& twice_area) {
    const Vec3 centre = (c[0] + c[1] + c[2]) / 3.0;
    const double radius = std::sqrt(
        std::max({(c[0] - centre).squaredNorm(), (c[1] - centre).squaredNorm(), (c[2] - centre).squaredNorm()}));
    const double at_centre = distance(centre);
    if (at_centre > radius) return;
    const bool inside = at_centre < -radius;
    if (radius > (inside ? 1.0 : kCrossingShare) * resolution_) {
      const Vec3 ab = 0.5 * (c[0] + c[1]), bc = 0.5 * (c[1] + c[2]), ca = 0.5 * (c[2] + c[0]),
                 quarter = 0.25 * twice_area;
      for (const Corners& part :
           {Corners{c[0], ab, ca}, Corners{ab, c[1], bc}, Corners{ca, bc, c[2]}, Corners{bc, ca, ab}})
        add(part, quarter);
      return;
    }
    const double third = twice_area.norm() / 6.0;
    for (const Vec3& x : {Vec3(0.5 * (c[0] + c[1])), Vec3(0.5 * (c[1] + c[2])), Vec3(0.5 * (c[2] + c[0]))})
      push(x, -distance(x), third, twice_area / -6.0);
  }

  void push(const Vec3& x, double depth, double area, const Vec3& inward_area) {
    if (!(depth > 0.0)) return;
    const Vec3 force = depth * inward_area;
    out_.wrench.force += force;
    out_.wrench.torque += (x - tool_.position).cross(force);
    out_.area_m2 += area;
    if (depth > out_.depth_m) out_.depth_m = depth, out_.deepest = x;
  }

  const std::vector<PosedMesh>& statics_;
  Pose tool_;
  double resolution_;
  TrueWrench out_;
};

}  // namespace

struct ReferenceWrench::Parts {
  std::vector<PosedMesh> statics;
  TriangleTree tool;
  double resolution = 0.0;
};

ReferenceWrench::ReferenceWrench(const scene::Scene& scene, double resolution_m) {
  if (scene.static_meshes.empty())
    throw std::runtime_error(scene.file.string() + ": the reference needs a static mesh");
  if (!(resolution_m > 0.0) || !std::isfinite(resolution_m))
    throw std::runtime_error("the reference's resolution must be a length above zero");
  std::vector<PosedMesh> statics;
  for (const scene::MeshSpec& spec : scene.static_meshes) {
    statics.emplace_back(spec);
    if (!statics.back().closed())
      throw std::runtime_error(
          spec.path.string() +
          ": the mesh is open and has no inside, so there is no true force to compare with; close it");
  }
  const ReferenceMesh tool = read_reference_mesh(scene.dynamic_mesh);
  parts_ = std::make_unique<Parts>(
      Parts{std::move(statics), TriangleTree(outward_triangles(tool, scene.dynamic_mesh.pose)), resolution_m});
}
ReferenceWrench::~ReferenceWrench() = default;

TrueWrench ReferenceWrench::at(const Pose& pose_WT) const {
  if (!pose_WT.finite()) return {};
  Integral integral(parts_->statics, pose_WT, parts_->resolution);
  integral.run(parts_->tool);
  return integral.result();
}

}  // namespace voxtouch::reference
