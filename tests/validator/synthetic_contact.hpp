#pragma once
/// Contact reports from closed-form geometry: those of a correct rendering of an ideal sphere
/// against a half-space, a cylinder or a box, and those with a planted fault. Has no rendering
/// code.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "core/reference/contact_validator.hpp"

namespace voxtouch::synthetic {

enum class Kind { kFree, kSurface, kInterior };
/// Kind of the closed cube with these opposite corners.
using Solid = std::function<Kind(const Vec3& low, const Vec3& high)>;

/// Everything on the side of the plane n.x = offset that n points away from.
inline Solid half_space(const Vec3& n, double offset) {
  return [=](const Vec3& low, const Vec3& high) {
    const double middle = n.dot(0.5 * (low + high)) - offset,
                 reach = 0.5 * n.cwiseAbs().dot(high - low);
    return middle > reach ? Kind::kFree : middle < -reach ? Kind::kInterior : Kind::kSurface;
  };
}

/// An endless cylinder along y.
inline Solid cylinder_along_y(double x, double z, double radius) {
  return [=](const Vec3& low, const Vec3& high) {
    const double near_x = std::clamp(x, low.x(), high.x()) - x,
                 near_z = std::clamp(z, low.z(), high.z()) - z;
    const double far_x = std::max(std::abs(low.x() - x), std::abs(high.x() - x));
    const double far_z = std::max(std::abs(low.z() - z), std::abs(high.z() - z));
    if (std::hypot(near_x, near_z) > radius)
      return Kind::kFree;
    return std::hypot(far_x, far_z) < radius ? Kind::kInterior : Kind::kSurface;
  };
}

inline Solid box(const Vec3& lowest, const Vec3& highest) {
  return [=](const Vec3& low, const Vec3& high) {
    if ((low.array() > highest.array()).any() || (high.array() < lowest.array()).any())
      return Kind::kFree;
    return (low.array() > lowest.array()).all() && (high.array() < highest.array()).all()
               ? Kind::kInterior
               : Kind::kSurface;
  };
}

/// Fault of the rendering.
struct Fault {
  Vec3 grid_shift = Vec3::Zero();  ///< displacement of the voxmap from its right place [m]
  bool flipped = false;            ///< normals point out of the dynamic object
};

/// A sphere's shell over a voxelised solid, with the adapted law and its fallback.
class Rendering {
 public:
  Rendering(Solid solid, double edge, Vec3 origin, double radius)
      : solid_(std::move(solid)),
        edge_(edge),
        origin_(std::move(origin)),
        radius_(radius) {
    const auto count =
        static_cast<int>(4 * std::numbers::pi * radius * radius / (edge * edge) * 1.3);
    const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
    for (int i = 0; i < count; ++i) {
      const double z = 1 - (2.0 * i + 1) / count, rho = std::sqrt(1 - z * z);
      out_.push_back({rho * std::cos(golden * i), rho * std::sin(golden * i), z});
    }
  }
  /// Bound of the distance from any point of the sphere to a shell point: Fibonacci points of this
  /// density stay below it.
  double shell_gap() const { return edge_; }

  reference::ReportedContact at(const Vec3& centre, const Fault& fault = {}) const {
    struct Hit {
      Vec3 x, n, to_centre;
    };
    std::vector<Hit> hits;
    reference::ReportedContact report;
    report.pose_WT.position = centre;
    Vec3 sum = Vec3::Zero();
    for (const Vec3& out : out_) {
      const Vec3 x = centre + radius_ * out;
      const Vec3 cell = ((x - fault.grid_shift - origin_) / edge_).array().floor();
      const Vec3 low = origin_ + edge_ * cell;
      const Kind kind = solid_(low, low + Vec3::Constant(edge_));
      if (kind == Kind::kInterior)
        ++report.interior_hits;
      if (kind != Kind::kSurface)
        continue;
      const Vec3 n = fault.flipped ? out : Vec3(-out);
      hits.push_back({x, n, low + Vec3::Constant(0.5 * edge_) + fault.grid_shift - x});
      sum += n;
    }
    report.surface_hits = static_cast<std::uint32_t>(hits.size());
    if (hits.empty())
      return report;
    report.coherence = sum.norm() / static_cast<double>(hits.size());
    report.fallback = report.coherence <= 0.3;
    report.mean_normal = sum.normalized();
    for (const Hit& hit : hits) {
      const Vec3& along = report.fallback ? hit.n : report.mean_normal;
      const double depth = std::max(0.0, along.dot(hit.to_centre));
      const Vec3 force = 1000.0 * depth * along;
      report.wrench.force += force;
      report.wrench.torque += (hit.x - centre).cross(force);
      report.deepest_depth_m = std::max(report.deepest_depth_m, depth);
    }
    return report;
  }

 private:
  Solid solid_;
  double edge_;
  Vec3 origin_;
  double radius_;
  std::vector<Vec3> out_;
};

}  // namespace voxtouch::synthetic
