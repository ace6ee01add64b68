#include "core/voxmap/winding.hpp"

#include <algorithm>

#include "core/voxmap/exact_sign.hpp"

namespace voxtouch::voxmap {
namespace {

/// Number and direction of turns of the triangle's projection on the xy plane around the point: -1,
/// 0, +1.
int shadow_winding(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& at) {
  const Vec3* const corner[] = {&a, &b, &c};
  int winding = 0;
  for (int n = 0; n < 3; ++n) {
    const Vec3& from = *corner[n];
    const Vec3& to = *corner[(n + 1) % 3];
    if ((from.y() <= at.y()) == (to.y() <= at.y()))
      continue;
    const double side = orient2d(from.x(), from.y(), to.x(), to.y(), at.x(), at.y());
    if (from.y() <= at.y() && side > 0.0)
      ++winding;
    if (from.y() > at.y() && side < 0.0)
      --winding;
  }
  return winding;
}

}  // namespace

bool inside_shells(const GridMesh& mesh, const ClosedShells& shells,
                   std::span<const std::uint32_t> triangles, const Vec3& at) {
  int winding = 0, parity = 0;
  for (const std::uint32_t t : triangles) {
    const ShellRole role = shells.role[t];
    if (role == ShellRole::kNone)
      continue;
    const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    if (std::max({a.z(), b.z(), c.z()}) < at.z() || std::max({a.x(), b.x(), c.x()}) < at.x() ||
        std::min({a.x(), b.x(), c.x()}) > at.x())
      continue;
    const int shadow = shadow_winding(a, b, c, at);
    if (shadow == 0)
      continue;
    const double side = orient3d(a, b, c, at);  // < 0: the point is behind the triangle
    if ((shadow > 0 ? side : -side) >= 0.0)
      continue;  // the triangle is below the point
    if (role == ShellRole::kParity)
      parity ^= 1;
    else
      winding += shadow * (role == ShellRole::kFlipped ? -1 : 1);
  }
  return winding != 0 || parity != 0;
}

}  // namespace voxtouch::voxmap
