#include "core/reference/reference_wrench.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

#include "core/reference/depth_integral.hpp"
#include "core/reference/posed_mesh.hpp"
#include "core/reference/signed_surface.hpp"
#include "core/reference/tool_triangles.hpp"

namespace voxtouch::reference {
namespace {

using Corners = std::array<Vec3, 3>;

constexpr double kCrossingShare = 0.25;  ///< triangles across the surface are split this much finer

/// A static mesh of the faster way.
struct PosedSurface {
  PosedSurface(const ReferenceMesh& mesh, const Pose& pose_WM)
      : surface(mesh),
        pose_MW(pose_WM.inverse()) {}
  SignedSurface surface;
  Pose pose_MW;
};

/// One pose's integral, sampled everywhere: what integrate_depth is tested by.
class SampledIntegral {
 public:
  SampledIntegral(const std::vector<PosedMesh>& statics, const Pose& tool, double resolution)
      : statics_(statics),
        tool_(tool),
        resolution_(resolution) {}

  void run(const ToolTriangles& tree) {
    for (std::size_t n = 0; n < tree.nodes().size();) {
      const ToolTriangles::Node& node = tree.nodes()[n];
      if (distance(tool_ * node.centre) > node.radius) {
        n = node.skip;
        continue;
      }
      if (node.leaf)
        for (std::uint32_t t = node.first; t < node.last; ++t) {
          const Corners& c = tree.triangle(t).corner;
          const Vec3 twice_area = (c[1] - c[0]).cross(c[2] - c[0]);
          if (!twice_area.isZero(0.0))
            add({tool_ * c[0], tool_ * c[1], tool_ * c[2]}, tool_.orientation * twice_area);
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
    const double radius =
        std::sqrt(std::max({(c[0] - centre).squaredNorm(), (c[1] - centre).squaredNorm(),
                            (c[2] - centre).squaredNorm()}));
    const double at_centre = distance(centre);
    if (at_centre > radius)
      return;
    const bool inside = at_centre < -radius;
    if (radius > (inside ? 1.0 : kCrossingShare) * resolution_) {
      const Vec3 ab = 0.5 * (c[0] + c[1]), bc = 0.5 * (c[1] + c[2]), ca = 0.5 * (c[2] + c[0]),
                 quarter = 0.25 * twice_area;
      for (const Corners& part : {Corners{c[0], ab, ca}, Corners{ab, c[1], bc},
                                  Corners{ca, bc, c[2]}, Corners{bc, ca, ab}})
        add(part, quarter);
      return;
    }
    const double third = twice_area.norm() / 6.0;
    for (const Vec3& x :
         {Vec3(0.5 * (c[0] + c[1])), Vec3(0.5 * (c[1] + c[2])), Vec3(0.5 * (c[2] + c[0]))})
      push(x, -distance(x), third, twice_area / -6.0);
  }

  void push(const Vec3& x, double depth, double area, const Vec3& inward_area) {
    if (!(depth > 0.0))
      return;
    const Vec3 force = depth * inward_area;
    out_.wrench.force += force;
    out_.wrench.torque += (x - tool_.position).cross(force);
    out_.area_m2 += area;
    if (depth > out_.depth_m)
      out_.depth_m = depth, out_.deepest = x;
  }

  const std::vector<PosedMesh>& statics_;
  Pose tool_;
  double resolution_;
  TrueWrench out_;
};

}  // namespace

struct ReferenceWrench::Parts {
  std::vector<PosedSurface> surfaces;  ///< one of both lists is empty
  std::vector<PosedMesh> sampled;
  std::optional<ToolTriangles> tool;
  double resolution = 0.0;
};

ReferenceWrench::ReferenceWrench(const scene::Scene& scene, double resolution_m, WrenchWay way)
    : parts_(std::make_unique<Parts>()) {
  if (scene.static_meshes.empty())
    throw std::runtime_error(scene.file.string() + ": the reference needs a static mesh");
  if (!(resolution_m > 0.0) || !std::isfinite(resolution_m))
    throw std::runtime_error("the reference's resolution must be a length above zero");
  const auto require_closed = [](const scene::MeshSpec& spec, bool closed) {
    if (!closed)
      throw std::runtime_error(spec.path.string() +
                               ": the mesh is open and has no inside, so there is no true force to "
                               "compare with; close it");
  };
  for (const scene::MeshSpec& spec : scene.static_meshes) {
    if (way == WrenchWay::kSampledEverywhere) {
      require_closed(spec, parts_->sampled.emplace_back(spec).closed());
      continue;
    }
    const ReferenceMesh mesh = read_reference_mesh(spec);
    require_closed(spec, mesh.closed);
    parts_->surfaces.emplace_back(mesh, spec.pose);
  }
  parts_->tool.emplace(read_reference_mesh(scene.dynamic_mesh), scene.dynamic_mesh.pose);
  parts_->resolution = resolution_m;
}
ReferenceWrench::~ReferenceWrench() = default;

TrueWrench ReferenceWrench::at(const Pose& pose_WT) const {
  return at(pose_WT, parts_->resolution);
}

TrueWrench ReferenceWrench::at(const Pose& pose_WT, double resolution_m) const {
  if (!pose_WT.finite())
    return {};
  if (!parts_->sampled.empty()) {
    SampledIntegral integral(parts_->sampled, pose_WT, resolution_m);
    integral.run(*parts_->tool);
    return integral.result();
  }
  std::vector<std::uint32_t> hints(parts_->surfaces.size(), SignedSurface::kNoHint);
  return integrate_depth(*parts_->tool, pose_WT, resolution_m, [&](const Vec3& x) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t n = 0; n < hints.size(); ++n) {
      const PosedSurface& one = parts_->surfaces[n];
      least = std::min(least, one.surface.distance(one.pose_MW * x, hints[n]));
    }
    return least;
  });
}

}  // namespace voxtouch::reference
