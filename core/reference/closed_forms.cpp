#include "core/reference/closed_forms.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace voxtouch::reference {
namespace {

SignedPoint at_sphere(const scene::SpherePrimitive& sphere, const Vec3& x) noexcept {
  const Vec3 arm = x - sphere.centre;
  const double length = arm.norm();
  const Vec3 out = length > 0 ? Vec3(arm / length) : Vec3::UnitX();
  return {length - sphere.radius_m, sphere.centre + sphere.radius_m * out};
}

/// In the box's own frame.
SignedPoint at_box(const Vec3& half, const Vec3& x) noexcept {
  const Vec3 clamped = x.cwiseMax(-half).cwiseMin(half);
  if (clamped != x)
    return {(x - clamped).norm(), clamped};
  Eigen::Index axis = 0;
  const double depth = (half - x.cwiseAbs()).minCoeff(&axis);
  Vec3 nearest = x;
  nearest[axis] = std::copysign(half[axis], x[axis]);
  return {-depth, nearest};
}

/// In the cylinder's own frame, axis z.
SignedPoint at_cylinder(double radius, double half_length, const Vec3& x) noexcept {
  const double rho = std::hypot(x.x(), x.y());
  const Vec3 out = rho > 0 ? Vec3(x.x() / rho, x.y() / rho, 0.0) : Vec3::UnitX();
  const double beyond_side = rho - radius, beyond_cap = std::abs(x.z()) - half_length;
  const double cap_z = std::copysign(half_length, x.z());
  if (beyond_side <= 0 && beyond_cap <= 0) {
    if (beyond_side >= beyond_cap)
      return {beyond_side, Vec3(out * radius + Vec3(0, 0, x.z()))};
    return {beyond_cap, Vec3(x.x(), x.y(), cap_z)};
  }
  const Vec3 nearest =
      out * std::min(rho, radius) + Vec3(0, 0, std::clamp(x.z(), -half_length, half_length));
  return {std::hypot(std::max(beyond_side, 0.0), std::max(beyond_cap, 0.0)), nearest};
}

struct Distance {
  const Vec3& x;
  SignedPoint operator()(const scene::SpherePrimitive& sphere) const noexcept {
    return at_sphere(sphere, x);
  }
  SignedPoint operator()(const scene::BoxPrimitive& box) const noexcept {
    SignedPoint found = at_box(0.5 * box.size_m, box.pose.inverse() * x);
    found.nearest = box.pose * found.nearest;
    return found;
  }
  SignedPoint operator()(const scene::CylinderPrimitive& cylinder) const noexcept {
    SignedPoint found =
        at_cylinder(cylinder.radius_m, 0.5 * cylinder.length_m, cylinder.pose.inverse() * x);
    found.nearest = cylinder.pose * found.nearest;
    return found;
  }
};

/// Points spread evenly by the golden angle, including both poles.
void sample(const scene::SpherePrimitive& sphere, std::size_t count, std::vector<Vec3>& points) {
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1.0 - 2.0 * static_cast<double>(i) / static_cast<double>(count - 1);
    const double rho = std::sqrt(std::max(0.0, 1.0 - z * z)),
                 angle = golden * static_cast<double>(i);
    points.push_back(sphere.centre +
                     sphere.radius_m * Vec3(rho * std::cos(angle), rho * std::sin(angle), z));
  }
}

void sample(const scene::BoxPrimitive& box, std::size_t count, std::vector<Vec3>& points) {
  const int n = std::max(2, static_cast<int>(std::sqrt(static_cast<double>(count) / 6.0)));
  for (int axis = 0; axis < 3; ++axis)
    for (int side = -1; side <= 1; side += 2)
      for (int a = 0; a < n; ++a)
        for (int b = 0; b < n; ++b) {
          Vec3 unit;
          unit[axis] = side;
          unit[(axis + 1) % 3] = 2.0 * a / (n - 1) - 1.0;
          unit[(axis + 2) % 3] = 2.0 * b / (n - 1) - 1.0;
          points.push_back(box.pose * Vec3(0.5 * box.size_m.cwiseProduct(unit)));
        }
}

void sample(const scene::CylinderPrimitive& cylinder, std::size_t count,
            std::vector<Vec3>& points) {
  const int around = std::max(8, static_cast<int>(2.0 * std::sqrt(static_cast<double>(count))));
  const int along = std::max(2, static_cast<int>(count) / (2 * around));
  for (int a = 0; a < around; ++a) {
    const double angle = 2.0 * std::numbers::pi * a / around;
    const Vec3 out(std::cos(angle), std::sin(angle), 0.0);
    for (int b = 0; b < along; ++b) {
      const double part = static_cast<double>(b) / (along - 1);
      const double z = cylinder.length_m * (part - 0.5);
      points.push_back(cylinder.pose * Vec3(cylinder.radius_m * out + Vec3(0, 0, z)));
      for (const double cap : {-0.5, 0.5})
        points.push_back(cylinder.pose * Vec3(cylinder.radius_m * part * out +
                                              Vec3(0, 0, cap * cylinder.length_m)));
    }
  }
}

}  // namespace

SignedPoint signed_distance(const scene::Primitive& primitive, const Vec3& x) noexcept {
  return std::visit(Distance{x}, primitive);
}

SignedPoint signed_distance(std::span<const scene::Primitive> primitives, const Vec3& x) noexcept {
  SignedPoint best = signed_distance(primitives.front(), x);
  for (const scene::Primitive& primitive : primitives.subspan(1))
    if (const SignedPoint other = signed_distance(primitive, x); other.distance_m < best.distance_m)
      best = other;
  return best;
}

std::vector<Vec3> surface_samples(const scene::Primitive& primitive, std::size_t count) {
  std::vector<Vec3> points;
  std::visit([&](const auto& form) { sample(form, std::max<std::size_t>(count, 24), points); },
             primitive);
  return points;
}

}  // namespace voxtouch::reference
