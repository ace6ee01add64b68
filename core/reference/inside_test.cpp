#include "core/reference/inside_test.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace voxtouch::reference {
namespace {
constexpr std::uint32_t kLeafTriangles = 8;
/// Beyond this many radii a node is approximated by one dipole.
constexpr double kFarInRadii = 2.5;
/// An estimate this close to 1/2 is replaced by the exact sum.
constexpr double kDoubtful = 0.25;
constexpr double kFullAngle = 4.0 * std::numbers::pi;
}  // namespace

InsideTest::InsideTest(const ReferenceMesh& mesh) {
  triangles_.reserve(mesh.triangles.size());
  low_ = high_ = mesh.corner(0, 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    triangles_.push_back({mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)});
    for (std::size_t k = 0; k < 3; ++k)
      low_ = low_.cwiseMin(mesh.corner(t, k)), high_ = high_.cwiseMax(mesh.corner(t, k));
  }
  build(0, static_cast<std::uint32_t>(triangles_.size()));
}

void InsideTest::build(std::uint32_t first, std::uint32_t last) {
  const std::size_t index = nodes_.size();
  nodes_.emplace_back();
  Node node;
  node.first = first, node.last = last;
  double total = 0.0;
  Vec3 low = triangles_[first].a, high = low;
  for (std::uint32_t i = first; i < last; ++i) {
    const Triangle& t = triangles_[i];
    const Vec3 area = 0.5 * (t.b - t.a).cross(t.c - t.a);
    const Vec3 middle = (t.a + t.b + t.c) / 3.0;
    node.area += area, total += area.norm(), node.centre += area.norm() * middle;
    low = low.cwiseMin(middle), high = high.cwiseMax(middle);
  }
  node.centre = total > 0 ? Vec3(node.centre / total) : low;
  for (std::uint32_t i = first; i < last; ++i)
    for (const Vec3* corner : {&triangles_[i].a, &triangles_[i].b, &triangles_[i].c})
      node.radius = std::max(node.radius, (*corner - node.centre).norm());
  if (last - first > kLeafTriangles) {
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const auto begin = triangles_.begin();
    std::stable_sort(begin + first, begin + last, [axis](const Triangle& p, const Triangle& q) {
      return p.a[axis] + p.b[axis] + p.c[axis] < q.a[axis] + q.b[axis] + q.c[axis];
    });
    const std::uint32_t half = first + (last - first) / 2;
    build(first, half);
    build(half, last);
  }
  node.skip = static_cast<std::uint32_t>(nodes_.size());
  nodes_[index] = node;
}

double InsideTest::solid_angle(const Triangle& t, const Vec3& x) noexcept {
  const Vec3 a = t.a - x, b = t.b - x, c = t.c - x;
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2.0 * std::atan2(a.dot(b.cross(c)),
                          la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

double InsideTest::winding_number(const Vec3& x) const noexcept {
  double sum = 0.0;
  for (const Triangle& t : triangles_)
    sum += solid_angle(t, x);
  return sum / kFullAngle;
}

double InsideTest::winding_estimate(const Vec3& x) const noexcept {
  double sum = 0.0;
  for (std::uint32_t n = 0; n < nodes_.size();) {
    const Node& node = nodes_[n];
    const Vec3 arm = node.centre - x;
    const double distance = arm.norm();
    const bool leaf = node.skip == n + 1;
    if (distance > kFarInRadii * node.radius) {
      sum += arm.dot(node.area) / (distance * distance * distance);
      n = node.skip;
    } else if (leaf) {
      for (std::uint32_t i = node.first; i < node.last; ++i)
        sum += solid_angle(triangles_[i], x);
      n = node.skip;
    } else {
      ++n;
    }
  }
  return sum / kFullAngle;
}

bool InsideTest::inside(const Vec3& x) const noexcept {
  if ((x.array() < low_.array()).any() || (x.array() > high_.array()).any() || !x.allFinite())
    return false;
  const double estimate = std::abs(winding_estimate(x));
  if (std::abs(estimate - 0.5) > kDoubtful)
    return estimate > 0.5;
  return std::abs(winding_number(x)) > 0.5;
}

}  // namespace voxtouch::reference
