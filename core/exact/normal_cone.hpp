#pragma once
/// Directions of the outward normals of a feature or a group of features, and how far the tool must
/// rotate before two groups can touch.
///
/// Two convex edges touch only along a normal that both have: the arcs between the normals of their
/// faces, one of them reversed, intersect. Elsewhere the solids overlap already, so some other pair
/// touched first (normal cones: Johnson and Cohen 2001).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/types/geometry.hpp"

namespace voxtouch::exact {

/// A cap of directions. Real-time safe.
class NormalCone {
 public:
  static NormalCone all() noexcept {
    NormalCone cone;
    cone.set(Vec3::UnitX(), std::numbers::pi);
    return cone;
  }
  NormalCone() noexcept = default;  ///< of no direction
  /// Of the arc between two unit normals.
  NormalCone(const Vec3& a, const Vec3& b) noexcept {
    const Vec3 sum = a + b;
    const double half = std::atan2((a - b).norm(), sum.norm());
    if (sum.norm() > 1e-6)
      set(sum.normalized(), half);
    else
      *this = all();
  }

  /// Grows to a cap that has both.
  void add(const NormalCone& other) noexcept {
    if (empty() || other.half_rad_ >= std::numbers::pi)
      *this = other;
    if (other.empty() || half_rad_ >= std::numbers::pi)
      return;
    const double between = std::acos(std::clamp(axis_.dot(other.axis_), -1.0, 1.0));
    if (between + other.half_rad_ <= half_rad_)
      return;
    if (between + half_rad_ <= other.half_rad_) {
      *this = other;
      return;
    }
    const double half = 0.5 * (between + half_rad_ + other.half_rad_);
    Vec3 aside = other.axis_ - axis_.dot(other.axis_) * axis_;
    if (half >= std::numbers::pi || !(aside.norm() > 1e-9)) {
      *this = all();
      return;
    }
    aside.normalize();
    const double tilt = half - half_rad_;
    set((std::cos(tilt) * axis_ + std::sin(tilt) * aside).normalized(), half + kRounding);
  }

  bool empty() const noexcept { return half_rad_ < 0.0; }
  const Vec3& axis() const noexcept { return axis_; }
  double half_rad() const noexcept { return half_rad_; }
  double cosine() const noexcept { return cosine_; }
  double sine() const noexcept { return sine_; }

 private:
  static constexpr double kRounding = 1e-9;
  void set(const Vec3& axis, double half_rad) noexcept {
    axis_ = axis;
    half_rad_ = std::min(half_rad, std::numbers::pi);
    cosine_ = std::cos(half_rad_), sine_ = std::sin(half_rad_);
  }

  Vec3 axis_ = Vec3::Zero();
  double half_rad_ = -1.0, cosine_ = 1.0, sine_ = 0.0;
};

/// How far the tool must rotate before its normals face those of an object. Real-time safe.
class RotationBound {
 public:
  /// Edges may make rows while their normals miss facing each other by up to this angle [rad].
  static constexpr double kSlackRad = 0.02;

  /// `rotation`: of the tool in the object's frame. `reach_m`: of the tool; a rotation by an angle
  /// is a path of that angle times this.
  RotationBound(const NormalCone& of_tool, const Mat3& rotation, double reach_m) noexcept
      : axis_(-(rotation * of_tool.axis())),
        half_rad_(of_tool.half_rad() + kSlackRad),
        cosine_(std::cos(half_rad_)),
        sine_(std::sin(half_rad_)),
        reach_m_(reach_m) {}

  /// No feature of the object with these normals can be touched before this path [m].
  double path_m(const NormalCone& of_object) const noexcept {
    if (half_rad_ + of_object.half_rad() >= std::numbers::pi)
      return 0.0;
    const double toward = axis_.dot(of_object.axis());
    if (toward >= cosine_ * of_object.cosine() - sine_ * of_object.sine())
      return 0.0;
    const double between = std::acos(std::max(toward, -1.0));
    return std::max(0.0, between - half_rad_ - of_object.half_rad()) * reach_m_;
  }

 private:
  Vec3 axis_;
  double half_rad_, cosine_, sine_, reach_m_;
};

/// For features that may touch along any direction.
class NoRotationBound {
 public:
  NoRotationBound(const NormalCone&, const Mat3&, double) noexcept {}
  double path_m(const NormalCone&) const noexcept { return 0.0; }
};

}  // namespace voxtouch::exact
