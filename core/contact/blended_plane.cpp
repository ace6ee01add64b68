#include "core/contact/blended_plane.hpp"

#include <array>
#include <cmath>

#include "core/contact/limits.hpp"
#include "core/types/smoothstep.hpp"

namespace voxtouch::contact {

double BlendedPlane::depth(const Vec3& direction) const noexcept {
  const double share = smoothstep(0.0, limits::kSurfaceWeight, surface);
  double depth = surface > 0.0 ? share * direction.dot(offset) : 0.0;
  if (interior > 0.0) depth += (1.0 - share) * limits::kDeepEdges;
  return depth;
}

BlendedPlane blended_plane(const voxmap::Voxmap& voxmap, const Vec3& u) noexcept {
  const voxmap::VoxelIndex v = voxmap::Grid::voxel_of(u);
  const std::array<double, 3> t = {u.x() - v.i - 0.5, u.y() - v.j - 0.5, u.z() - v.k - 0.5};  // from the voxel's middle
  std::array<std::array<double, 3>, 3> weight{}, beyond{};  // beyond: squared distance to the neighbour's slab
  for (std::size_t a = 0; a < 3; ++a) {
    weight[a] = {0.5 * (0.5 - t[a]) * (0.5 - t[a]), 0.75 - t[a] * t[a], 0.5 * (0.5 + t[a]) * (0.5 + t[a])};
    beyond[a] = {(0.5 + t[a]) * (0.5 + t[a]), 0.0, (0.5 - t[a]) * (0.5 - t[a])};
  }
  constexpr double kNear = limits::kBorderEdges * limits::kBorderEdges;
  BlendedPlane plane;
  for (std::size_t x = 0; x < 3; ++x)
    for (std::size_t y = 0; y < 3; ++y)
      for (std::size_t z = 0; z < 3; ++z) {
        const auto at = [](std::int32_t middle, std::size_t n) { return middle + static_cast<std::int32_t>(n) - 1; };
        const double w = weight[0][x] * weight[1][y] * weight[2][z];
        switch (voxmap.at({at(v.i, x), at(v.j, y), at(v.k, z)})) {
          case voxmap::VoxelKind::kFree:
            if (const double squared = beyond[0][x] + beyond[1][y] + beyond[2][z]; squared < kNear)
              plane.inside *= smoothstep(0.0, limits::kBorderEdges, std::sqrt(squared));
            break;
          case voxmap::VoxelKind::kInterior: plane.interior += w; break;
          case voxmap::VoxelKind::kSurface:
            plane.surface += w;
            plane.offset += w * Vec3(static_cast<double>(x) - 1.0 - t[0], static_cast<double>(y) - 1.0 - t[1],
                                     static_cast<double>(z) - 1.0 - t[2]);
        }
      }
  if (plane.surface > 0.0) plane.offset /= plane.surface;
  return plane;
}

}  // namespace voxtouch::contact
