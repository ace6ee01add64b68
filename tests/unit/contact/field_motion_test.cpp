// `field` has no steps, for points that enter, leave, cross bricks and the borders of stored data;
// and generates little energy.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "field_scenes.hpp"
#include "fixtures.hpp"

namespace voxtouch::test {
namespace field_motion_test {

constexpr double kEdge = 1e-3, kStep = 1e-3 * kEdge;

/// Depth of each shell point in one frame, 0 without a hit.
std::vector<double> depths_of(const contact::ContactRenderer& renderer, const Ground& ground,
                              std::size_t points) {
  std::vector<double> depth(points, 0.0);
  const contact::HitList& hits = renderer.hits();
  for (const contact::Hits* list : {&hits.surface, &hits.interior})
    for (const contact::Hit& hit : *list) {
      const Vec3 x = hits.pose_WT.position - ground.field.grid().origin + hit.arm;
      depth[hit.point] = std::max(0.0, -ground.field.at(x / kEdge).distance_m);
    }
  return depth;
}

/// Moves from pose to pose in steps of 1e-3 e (plus the rotation) and compares each step with the
/// documented bound k sum A_i (G s + d_i theta).
void walk(const char* name, const Ground& ground, const mesh::TriangleMesh& tool,
          const std::vector<Pose>& path) {
  const pointshell::Pointshell shell = exact_shell(tool, kEdge);
  contact::ContactRenderer renderer = ground.renderer(shell);
  const double steepest = ground.field.steepest_gradient();
  std::vector<double> before(shell.size(), 0.0);
  Vec3 force_before = Vec3::Zero();
  Pose last = path.front();
  double worst_ratio = 0.0, worst_step = 0.0, largest_force = 0.0;
  int steps = 0, entered = 0, left = 0, broken = 0;
  for (std::size_t leg = 0; leg + 1 < path.size(); ++leg) {
    const int count =
        static_cast<int>(std::ceil((path[leg + 1].position - path[leg].position).norm() / kStep));
    for (int n = leg == 0 ? 0 : 1; n <= count; ++n) {
      const double t = static_cast<double>(n) / count;
      const Pose pose{(1 - t) * path[leg].position + t * path[leg + 1].position,
                      path[leg].orientation.slerp(t, path[leg + 1].orientation)};
      const Vec3 force = renderer.probe(pose).wrench.force;
      const std::vector<double> now = depths_of(renderer, ground, shell.size());
      if (steps++ > 0) {
        const double theta = last.orientation.angularDistance(pose.orientation);
        const double s =
            (pose.position - last.position).norm() + theta * renderer.query().reach_m();
        double bound = 0.0;
        for (std::size_t p = 0; p < now.size(); ++p) {
          if (now[p] > 0.0 || before[p] > 0.0)
            bound += kPressure * renderer.query().shell().area_m2[p] *
                     (steepest * s + std::max(now[p], before[p]) * theta);
          entered += now[p] > 0.0 && !(before[p] > 0.0);
          left += before[p] > 0.0 && !(now[p] > 0.0);
        }
        const double step = (force - force_before).norm();
        broken += step > bound * (1 + 1e-9) + 1e-12;
        if (bound > 0.0)
          worst_ratio = std::max(worst_ratio, step / bound);
        worst_step = std::max(worst_step, step);
      }
      largest_force = std::max(largest_force, force.norm());
      before = now, force_before = force, last = pose;
    }
  }
  std::printf(
      "%s: %d steps, %d entered, %d left; largest step %.3g N (forces up to %.3g N), at most %.3f "
      "of its bound, G "
      "%.3f\n",
      name, steps, entered, left, worst_step, largest_force, worst_ratio, steepest);
  EXPECT_EQ(broken, 0) << name;
  EXPECT_GT(entered, 50) << name;
  EXPECT_GT(left, 20) << name;
}

Quat turned_by(double angle) { return Quat(Eigen::AngleAxisd(angle, Vec3(1, 2, -1).normalized())); }

TEST(FieldMotion, HasNoStepOverTheEdgeAndDownTheSideOfABox) {
  const Ball tool(6 * kEdge, 4);
  const Ground ground(
      box_mesh(Vec3(0.03, 0.03, 0.03), {Vec3(0.3, 0.2, 0.1) * kEdge, turned_by(0.3)}), kEdge, 3.0);
  const Quat turn = turned_by(0.3);
  const auto at = [&](double x, double z, double angle) {
    return tool.posed(turn * Vec3(x, 0.001, z), turned_by(angle));
  };
  walk("box", ground, tool.mesh,
       {at(0.008, 0.0225, 0), at(0.008, 0.0155, 0.2), at(0.019, 0.0155, 0.5),
        at(0.0195, 0.012, 0.4), at(0.023, 0.012, 0.4)});
}

TEST(FieldMotion, HasNoStepInTheGrooveBetweenOverlappingBoxes) {
  const Ball tool(6 * kEdge, 4);
  const Quat turn = turned_by(0.45);
  const Ground ground(
      joined(box_mesh(Vec3(0.04, 0.04, 0.012), {Vec3::Zero(), turn}),
             box_mesh(Vec3(0.012, 0.04, 0.04), {turn * Vec3(-0.014, 0, 0.01), turn})),
      kEdge);
  const auto at = [&](double x, double z, double angle) {
    return tool.posed(turn * Vec3(x, 0.001, z), turned_by(angle));
  };
  walk("groove", ground, tool.mesh,
       {at(0.004, 0.0125, 0), at(0.004, 0.010, 0.1), at(-0.004, 0.010, 0.3),
        at(-0.003, 0.0135, 0.3)});
}

TEST(FieldMotion, HasNoForceStepThroughAPlate) {
  const Ball tool(3 * kEdge, 4);
  const Ground ground(
      box_mesh(Vec3(0.03, 0.03, 0.009), {Vec3(0.4, 0.1, 0.7) * kEdge, turned_by(0.2)}), kEdge, 3.0);
  walk("through a plate", ground, tool.mesh,
       {tool.posed(Vec3(0, 0, 0.010), turned_by(0)),
        tool.posed(Vec3(0, 0, -0.010), turned_by(0.6))});
}

/// On a closed path at constant depth the continuum does no work. Reported per newton and metre of
/// the path.
TEST(FieldMotion, SlidingRoundAClosedLoopGivesHardlyAnyEnergy) {
  const Ball tool(15 * kEdge, 5);
  const pointshell::Pointshell shell = exact_shell(tool.mesh, kEdge);
  const auto loop = [&](const char* name, const Ground& ground,
                        const std::function<Vec3(double)>& at, double limit) {
    contact::ContactRenderer field = ground.renderer(shell),
                             adapted = ground.renderer(shell, contact::ContactModelKind::kAdapted);
    constexpr int kSteps = 4000;
    double fraction[2] = {0, 0};
    for (contact::ContactRenderer* renderer : {&field, &adapted}) {
      double work = 0.0, mean = 0.0, displacement = 0.0;
      Vec3 last = at(0.0), force = renderer->probe(tool.posed(last, Quat::Identity())).wrench.force;
      for (int n = 1; n <= kSteps; ++n) {
        const Vec3 next = at(2 * std::numbers::pi * n / kSteps);
        const Vec3 now = renderer->probe(tool.posed(next, Quat::Identity())).wrench.force;
        work += 0.5 * (force + now).dot(next - last);
        mean += now.norm() / kSteps;
        displacement += (next - last).norm();
        last = next, force = now;
      }
      fraction[renderer == &adapted] = work / (mean * displacement);
    }
    std::printf("%s: work round the loop %.2e F L (adapted %.2e)\n", name, fraction[0],
                fraction[1]);
    EXPECT_LE(std::abs(fraction[0]), limit) << name;
  };
  const Quat turn = turned_by(0.6);
  const Ground plane(box_mesh(Vec3(0.06, 0.06, 0.02), {Vec3::Zero(), turn}), kEdge, 3.0);
  loop(
      "circle on an oblique plane", plane,
      [&](double a) -> Vec3 {
        return turn * Vec3(0.005 * std::cos(a), 0.005 * std::sin(a), 0.01 + 15e-3 - 0.5e-3);
      },
      1e-4);
  const Ground cylinder(cylinder_mesh(0.02, 0.05, 360), kEdge, 3.0);
  loop(
      "round a cylinder", cylinder,
      [](double a) -> Vec3 {
        return {0.0345 * std::cos(a), 0.0345 * std::sin(a), 0.001};
      },
      1e-4);
}

}  // namespace field_motion_test
}  // namespace voxtouch::test
