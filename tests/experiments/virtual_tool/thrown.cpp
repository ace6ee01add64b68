#include "thrown.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace voxtouch::virtual_tool {
namespace {

constexpr double kMass = 0.15, kDamping = 1.0, kPull = 0.1, kMinForceN = 0.05;
constexpr double kHalfSide =
    0.08;  ///< of the wall: larger than any sideways displacement of a throw

mesh::TriangleMesh wall_mesh(const ThrowOptions& o) {
  const Pose at{Vec3(0.37e-3, 0.11e-3, 0.0), o.askew ? tilt() : Quat::Identity()};
  return test::plate_mesh(2 * kHalfSide, o.thick_edges * o.edge, at);
}

/// The cap of the coupling: the whole wrench scaled until its stiffness against shifts is
/// kStiffness at most.
Vec3 capped(const contact::ContactResult& result) {
  const double largest = Eigen::SelfAdjointEigenSolver<Mat3>(result.stiffness.topLeftCorner<3, 3>(),
                                                             Eigen::EigenvaluesOnly)
                             .eigenvalues()[2];
  return (largest > kStiffness ? kStiffness / largest : 1.0) * result.wrench.force;
}

}  // namespace

ThrowFigures thrown(const ThrowOptions& o) {
  std::mt19937_64 random(o.seed);
  const pointshell::Pointshell shell = ball_shell(o.edge);
  Rig rig(wall_mesh(o), o.edge, ball_mesh());
  const test::Ground ground(rig.mesh, o.edge);
  contact::ContactRenderer renderer = ground.renderer(
      shell, o.holder.model.value_or(contact::ContactModelKind::kAdapted), !o.holder.remembers);
  const auto force_at = [&](const Pose& pose) -> Vec3 {
    if (!o.holder.model)
      return rig.frame(pose).wrench(kStiffness).force;
    return capped(renderer.render(pose).contact);
  };
  const Quat turn = o.askew ? tilt() : Quat::Identity();
  const double half = 0.5 * o.thick_edges * o.edge;
  ThrowFigures figures;
  std::vector<double> directions;
  for (const double speed : {0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 3.0})
    for (int n = 0; n < o.tries; ++n) {
      const double side = n % 2 == 0 ? 1.0 : -1.0;
      const Vec3 normal = side * (turn * Vec3::UnitZ());
      Vec3 x = turn * Vec3(uniform(random, -0.01, 0.01), uniform(random, -0.01, 0.01), 0.0) +
               (kBall + half + o.edge) * normal;
      Vec3 v = speed *
               (0.1 * (turn * Vec3(uniform(random, -1, 1), uniform(random, -1, 1), 0.0)) - normal)
                   .normalized();
      const Quat orientation(Eigen::AngleAxisd(uniform(random, 0, 3), random_direction(random)));
      renderer.reset();
      if (!o.holder.model && !rig.place({x, orientation}))
        continue;
      ++figures.runs;
      bool met = false;
      for (int frame = 0; frame < 1500; ++frame) {
        const Vec3 force = force_at({x, orientation});
        if (!met && force.norm() > kMinForceN)
          met = true, directions.push_back(test::degrees_between(force, normal));
        v += kPeriod / kMass * (force - kPull * normal - kDamping * v);
        x += kPeriod * v;
        if (normal.dot(x) < -half - kBall || normal.dot(x) > kBall + half + 0.01)
          break;
      }
      const Vec3 at = o.holder.model      ? x
                      : rig.tool.placed() ? rig.frame(Pose{x, orientation}).tool.position
                                          : x;
      figures.passed += normal.dot(at) < -half;  // its middle is beyond the far face
    }
  if (!directions.empty())
    figures.direction_95 = test::quantile(directions, 0.95);
  return figures;
}

}  // namespace voxtouch::virtual_tool
