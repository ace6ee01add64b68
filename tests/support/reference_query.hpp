#pragma once
/// Reference of the contact query: one point after the other in doubles, without optimisation.
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/contact/hit_list.hpp"
#include "core/pointshell/pointshell.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch::test {

struct ReferenceHits {
  std::vector<contact::Hit> surface, interior;
};

/// `pose` as a query gives it back: its quaternion brought to unit norm.
inline ReferenceHits reference_hits(const voxmap::Voxmap& voxmap,
                                    const pointshell::Pointshell& shell, const Pose& pose,
                                    bool by_area = false) {
  ReferenceHits out;
  const double edge = voxmap.grid().edge;
  const Mat3 r = pose.orientation.toRotationMatrix();
  const Vec3 t = pose.position - voxmap.grid().origin;
  for (std::uint32_t p = 0; p < shell.size(); ++p) {
    Vec3 u;
    for (int a = 0; a < 3; ++a)
      u[a] = (r(a, 0) * shell.x[p] + r(a, 1) * shell.y[p] + r(a, 2) * shell.z[p] + t[a]) / edge;
    const voxmap::VoxelIndex v = voxmap::Grid::voxel_of(u);
    const voxmap::VoxelKind kind = voxmap.at(v);
    if (kind == voxmap::VoxelKind::kFree)
      continue;
    (kind == voxmap::VoxelKind::kSurface ? out.surface : out.interior)
        .push_back({p, r * shell.point(p), r * shell.normal(p),
                    edge * Vec3((v.i + 0.5) - u.x(), (v.j + 0.5) - u.y(), (v.k + 0.5) - u.z()),
                    by_area ? shell.area_m2[p] : 1.0});
  }
  return out;
}

/// Every bit of every hit, in order.
inline bool same(const contact::Hits& hits, const std::vector<contact::Hit>& reference) {
  if (hits.size() != reference.size())
    return false;
  for (std::size_t n = 0; n < reference.size(); ++n) {
    const contact::Hit a = hits[n], &b = reference[n];
    if (a.point != b.point || a.arm != b.arm || a.normal != b.normal ||
        a.to_centre != b.to_centre || a.weight != b.weight)
      return false;
  }
  return true;
}

}  // namespace voxtouch::test
