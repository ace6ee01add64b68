#pragma once
/// The wrench of ReferenceWrench by another method, to test it. Triangles are split until they are
/// smaller than the resolution inside (edge midpoints: exact for linear depths and their torque),
/// and than a quarter of it across the surface. Signed distances by FCL, signs by the winding
/// number. Many times slower; it has only the reading of meshes in common.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/reference/posed_mesh.hpp"
#include "core/reference/reference_wrench.hpp"
#include "core/reference/tool_triangles.hpp"

namespace voxtouch::reference {

/// One pose's integral, sampled everywhere.
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
  using Corners = std::array<Vec3, 3>;
  static constexpr double kCrossingRatio =
      0.25;  ///< triangles across the surface are split this much finer

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
    if (radius > (inside ? 1.0 : kCrossingRatio) * resolution_) {
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

class SampledWrench {
 public:
  explicit SampledWrench(const scene::Scene& scene)
      : tool_(read_reference_mesh(scene.dynamic_mesh), scene.dynamic_mesh.pose) {
    for (const scene::MeshSpec& spec : scene.static_meshes)
      statics_.emplace_back(spec);
  }
  TrueWrench at(const Pose& pose_WT, double resolution_m) const {
    SampledIntegral integral(statics_, pose_WT, resolution_m);
    integral.run(tool_);
    return integral.result();
  }

 private:
  std::vector<PosedMesh> statics_;
  ToolTriangles tool_;
};

}  // namespace voxtouch::reference
