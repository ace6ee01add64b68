#include "core/voxmap/outward.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/voxmap/distance_tree.hpp"
#include "core/voxmap/exact_sign.hpp"
#include "core/voxmap/winding.hpp"

namespace voxtouch::voxmap {
namespace {

bool oriented(ShellRole role) { return role == ShellRole::kKept || role == ShellRole::kFlipped; }

Vec3 area_of(const GridMesh& mesh, std::uint32_t t) {
  return area_vector(mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
}

/// Triangles (patch, number), grouped by patch.
using Members = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

Members members_of(const ClosedShells& shells) {
  Members members;
  for (std::uint32_t t = 0; t < shells.role.size(); ++t)
    if (oriented(shells.role[t]))
      members.emplace_back(shells.patch[t], t);
  std::sort(members.begin(), members.end());
  return members;
}

/// Six times the volume enclosed by the patch, with its triangles oriented by their roles.
double six_volumes(const GridMesh& mesh, const ClosedShells& shells, Members::const_iterator first,
                   Members::const_iterator last) {
  const Vec3& at = mesh.corner(first->second, 0);  // a point near the patch, to limit cancellation
  double sum = 0.0;
  for (; first != last; ++first) {
    const std::uint32_t t = first->second;
    const double volume =
        (mesh.corner(t, 0) - at).dot((mesh.corner(t, 1) - at).cross(mesh.corner(t, 2) - at));
    sum += shells.role[t] == ShellRole::kFlipped ? -volume : volume;
  }
  return sum;
}

/// Examines both sides of a triangle.
class Sides {
 public:
  Sides(const GridMesh& mesh, const ClosedShells& shells)
      : mesh_(mesh),
        shells_(shells),
        tree_(mesh, triangles_of_closed_parts(shells)) {}

  /// +1 or -1 for the triangle as in the file; empty if both sides are alike.
  std::optional<int> outward(std::uint32_t t) const {
    const Vec3 &a = mesh_.corner(t, 0), &b = mesh_.corner(t, 1), &c = mesh_.corner(t, 2);
    const Vec3 normal = area_of(mesh_, t).stableNormalized();
    const double size = std::max({(b - a).norm(), (c - a).norm(), (c - b).norm()});
    const Vec3 middle = (a + b + c) / 3.0;
    const Vec3 step = (0x1p-24 * size + 0x1p-44 * middle.cwiseAbs().maxCoeff()) * normal;
    const bool before = inside(middle + step), behind = inside(middle - step);
    if (before == behind)
      return {};
    return before ? -1 : 1;
  }

 private:
  bool inside(const Vec3& at) const {
    std::vector<std::uint32_t> above;
    tree_.each_on_ray(at, Vec3::UnitZ(),
                      [&](std::uint32_t triangle) { above.push_back(triangle); });
    return inside_shells(mesh_, shells_, above, at);
  }

  const GridMesh& mesh_;
  const ClosedShells& shells_;
  DistanceTree tree_;
};

/// Whether the patch, oriented by its roles, faces the solid, decided at its largest triangles.
bool faces_inward(const GridMesh& mesh, const ClosedShells& shells, const Sides& sides,
                  Members::const_iterator first, Members::const_iterator last) {
  constexpr std::size_t kLargest = 8;
  std::vector<std::pair<double, std::uint32_t>> largest;
  for (auto at = first; at != last; ++at)
    largest.emplace_back(-area_of(mesh, at->second).squaredNorm(), at->second);
  const std::size_t count = std::min(kLargest, largest.size());
  std::partial_sort(largest.begin(), largest.begin() + static_cast<std::ptrdiff_t>(count),
                    largest.end());
  for (std::size_t n = 0; n < count; ++n) {
    const std::uint32_t t = largest[n].second;
    if (const std::optional<int> side = sides.outward(t))
      return *side * static_cast<int>(shells.role[t]) < 0;
  }
  return false;  // inside a body
}

}  // namespace

std::vector<std::int8_t> outward_sides(const GridMesh& mesh, const ClosedShells& shells) {
  std::vector<std::int8_t> side(mesh.size(), 1);
  const Members members = members_of(shells);
  if (members.empty())
    return side;
  const bool one_patch = members.front().first == members.back().first;
  const std::optional<Sides> sides =
      one_patch ? std::nullopt : std::make_optional<Sides>(mesh, shells);
  for (auto first = members.begin(); first != members.end();) {
    const auto last =
        std::find_if(first, members.end(), [&](const auto& m) { return m.first != first->first; });
    const bool inward = one_patch ? six_volumes(mesh, shells, first, last) < 0.0
                                  : faces_inward(mesh, shells, *sides, first, last);
    for (; first != last; ++first)
      side[first->second] = static_cast<std::int8_t>((inward ? -1 : 1) *
                                                     static_cast<int>(shells.role[first->second]));
  }
  return side;
}

}  // namespace voxtouch::voxmap
