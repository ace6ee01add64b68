#include "core/reference/reference_wrench.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

#include "core/reference/depth_integral.hpp"
#include "core/reference/signed_surface.hpp"
#include "core/reference/tool_triangles.hpp"

namespace voxtouch::reference {
namespace {

/// A static mesh.
struct PosedSurface {
  PosedSurface(const ReferenceMesh& mesh, const Pose& pose_WM)
      : surface(mesh),
        pose_MW(pose_WM.inverse()) {}
  SignedSurface surface;
  Pose pose_MW;
};

}  // namespace

struct ReferenceWrench::Parts {
  std::vector<PosedSurface> surfaces;
  std::optional<ToolTriangles> tool;
  double resolution = 0.0;
};

ReferenceWrench::ReferenceWrench(const scene::Scene& scene, double resolution_m)
    : parts_(std::make_unique<Parts>()) {
  if (scene.static_meshes.empty())
    throw std::runtime_error(scene.file.string() + ": the reference needs a static mesh");
  if (!(resolution_m > 0.0) || !std::isfinite(resolution_m))
    throw std::runtime_error("the reference's resolution must be a length above zero");
  for (const scene::MeshSpec& spec : scene.static_meshes) {
    const ReferenceMesh mesh = read_reference_mesh(spec);
    if (!mesh.closed)
      throw std::runtime_error(
          spec.path.string() +
          ": the mesh is open and has no interior, so no reference force exists; close it");
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
