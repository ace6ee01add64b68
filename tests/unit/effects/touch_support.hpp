#pragma once
/// Objects of closed form for the effects at the touched point: a ball on a tool with planes and
/// balls.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include <random>
#include <vector>

#include "core/effects/effect_chain.hpp"
#include "core/effects/touch_point.hpp"

namespace voxtouch::test {

/// The tool: a ball of radius `radius_m` round `centre` in T.
struct BallTool {
  Vec3 centre = Vec3::Zero();
  double radius_m = 0.01;
};

/// Force of `n_per_m` per metre of depth, along `normal`, at the ball's deepest point.
inline contact::ContactResult pushed(const Pose& pose, const BallTool& tool, const Vec3& normal,
                                     double depth_m, double n_per_m) {
  contact::ContactResult out;
  if (!(depth_m > 0.0))
    return out;
  out.mean_normal = normal, out.coherence = 1.0, out.surface_hits = 1;
  out.deepest_point = pose * tool.centre - tool.radius_m * normal, out.deepest_depth_m = depth_m;
  const Vec3 arm = out.deepest_point - pose.position;
  out.wrench.force = n_per_m * depth_m * normal;
  out.wrench.torque = arm.cross(out.wrench.force);
  out.stiffness = effects::seen_from_origin(n_per_m * normal * normal.transpose(), arm);
  out.stiffness_bound_n_per_m = n_per_m;
  return out;
}
/// Against the half space below `level_m` along the unit vector `up`.
inline contact::ContactResult on_plane(const Pose& pose, const BallTool& tool, const Vec3& up,
                                       double level_m, double n_per_m) {
  return pushed(pose, tool, up, tool.radius_m - (up.dot(pose * tool.centre) - level_m), n_per_m);
}
/// Against a ball.
inline contact::ContactResult on_ball(const Pose& pose, const BallTool& tool, const Vec3& centre,
                                      double radius_m, double n_per_m) {
  const Vec3 away = pose * tool.centre - centre;
  return pushed(pose, tool, away.normalized(), tool.radius_m + radius_m - away.norm(), n_per_m);
}

/// An effect of `kind` with its standards and then `values`.
inline effects::EffectSpec effect(
    std::string_view kind,
    const std::vector<std::pair<std::string_view, std::array<double, 3>>>& values) {
  effects::EffectSpec spec{.name = std::string(kind),
                           .kind = effects::find_effect_kind(kind),
                           .values = {},
                           .region = {}};
  spec.values = effects::EffectValues(spec.kind->parameters);
  for (const auto& [name, value] : values)
    for (std::size_t n = 0; n < spec.values.size(); ++n)
      if (spec.kind->parameters[n].name == name)
        spec.values.at(n) = value;
  return spec;
}

/// A chain of one effect, evaluated sample by sample.
class Asked {
 public:
  explicit Asked(effects::EffectSpec spec) : chain(std::vector{std::move(spec)}) {}

  effects::EffectForce at(const Pose& pose, const std::vector<contact::ContactResult>& contacts,
                          const Twist& twist = {}, const std::vector<Twist>& objects = {}) {
    std::vector<effects::ObjectContact> touched;
    for (std::size_t n = 0; n < contacts.size(); ++n)
      touched.push_back(
          {static_cast<std::uint32_t>(n), &contacts[n], n < objects.size() ? objects[n] : Twist{}});
    return with(pose, touched, twist);
  }
  effects::EffectForce with(const Pose& pose, std::span<const effects::ObjectContact> touched,
                            const Twist& twist = {}) {
    effects::EffectFrame frame;
    frame.tool = pose, frame.twist = twist, frame.dt_s = 0.001, frame.time_s = time_s += 0.001,
    frame.contacts = touched;
    return chain.apply(frame);
  }

  effects::EffectChain chain;
  double time_s = 0.0;
};

/// Work of a wrench on the tool between two samples [J]: mean of both times the displacement.
inline double work(const Wrench& from, const Wrench& to, const Pose& start, const Pose& end) {
  const Eigen::AngleAxisd turn(end.orientation * start.orientation.conjugate());
  return 0.5 * (from.force + to.force).dot(end.position - start.position) +
         0.5 * (from.torque + to.torque).dot(turn.angle() * turn.axis());
}

/// A smooth closed path of the tool, seeded: three harmonics on each axis.
class ClosedPath {
 public:
  ClosedPath(std::mt19937_64& random, const Pose& middle, const Vec3& path_m, double rotation_rad)
      : middle_(middle),
        path_m_(path_m),
        rotation_rad_(rotation_rad) {
    std::normal_distribution<double> number;
    for (int h = 0; h < 3; ++h)
      for (int a = 0; a < 6; ++a)
        sine_[h][a] = number(random) / (1 + h), cosine_[h][a] = number(random) / (1 + h);
  }
  /// `t` from 0 to 1; both ends are one place.
  Pose at(double t) const {
    Vec6 x = Vec6::Zero();
    for (int h = 0; h < 3; ++h)
      for (int a = 0; a < 6; ++a) {
        const double phase = 2.0 * M_PI * (h + 1) * t;
        x[a] += sine_[h][a] * std::sin(phase) + cosine_[h][a] * std::cos(phase);
      }
    const Vec3 turn = rotation_rad_ * x.tail<3>();
    return {middle_.position + path_m_.cwiseProduct(x.head<3>()),
            Quat(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * middle_.orientation};
  }

 private:
  Pose middle_;
  Vec3 path_m_;
  double rotation_rad_;
  double sine_[3][6], cosine_[3][6];
};

inline double least_eigenvalue(const Mat6& m) {
  return Eigen::SelfAdjointEigenSolver<Mat6>(m).eigenvalues().minCoeff();
}
inline double norm_of(const Mat3& m) { return Eigen::JacobiSVD<Mat3>(m).singularValues()[0]; }

inline double between(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
/// Evenly on the logarithm.
inline double scale_between(std::mt19937_64& random, double low, double high) {
  return std::exp(between(random, std::log(low), std::log(high)));
}

}  // namespace voxtouch::test
