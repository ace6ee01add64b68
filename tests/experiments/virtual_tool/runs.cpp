#include "runs.hpp"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "god_object.hpp"

namespace voxtouch::virtual_tool {
namespace {

using test::degrees_between;
using test::quantile;

/// CPU time of this thread.
double now_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

struct Clock {
  std::vector<double> us;
  template <class F>
  auto time(F&& f) {
    const double from = now_us();
    auto result = f();
    us.push_back(now_us() - from);
    return result;
  }
  double median() const { return us.empty() ? 0.0 : quantile(us, 0.5); }
};

double largest(const std::vector<double>& values) {
  return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

}  // namespace

PressFigures press(const PressOptions& o) {
  std::mt19937_64 random(o.seed);
  Rig rig(scene_mesh(o.scene), o.edge, ball_mesh());
  GodObject truth(rig.mesh, kBall);
  const Quat turn =
      o.turned ? Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())) : Quat::Identity();
  std::vector<double> directions, sizes, jitter, residuals;
  const double most_askew = o.scene == "edge" || o.scene == "corner" ? 0.0 : 20.0;
  PressFigures figures;
  double queries = 0.0, frames = 0.0;
  Clock clock;
  while (figures.places < o.places) {
    const Place place = random_place(o.scene, rig.mesh, random);
    const Vec3 start = place.point + (kBall + 0.004) * place.normal;
    const Vec3 in = (std::tan(uniform(random, 0.0, most_askew * std::numbers::pi / 180.0)) *
                         place.normal.cross(random_direction(random)).normalized() -
                     place.normal)
                        .normalized();
    if (truth.distance(start) < kBall + 1e-3)
      continue;  // the ball does not fit in
    truth.place(start, 0.04);
    if (!rig.place({start, turn}))
      continue;
    ++figures.places;
    exact::VirtualToolFrame frame;
    Vec3 hand = start, god = start;
    const int steps = static_cast<int>((0.004 + o.depth_m) / 5e-5);
    for (int n = 1; n <= steps; ++n) {
      hand = start + n * 5e-5 * in;
      frame = rig.frame(Pose{hand, turn});
      if (n % 5 == 0)
        god = truth.draw_to(hand);
    }
    god = truth.draw_to(hand);
    Vec3 force = frame.wrench(kStiffness).force;
    double worst = 0.0;
    std::vector<double> steps_n;
    for (int n = 0; n < 300; ++n) {
      frame = clock.time([&] { return rig.frame(Pose{hand, turn}); });
      const Vec3 next = frame.wrench(kStiffness).force;
      if (n >= 200) {
        worst = std::max(worst, (next - force).norm());
        queries += frame.queries, ++frames;
        figures.queries_most = std::max(figures.queries_most, frame.queries);
        figures.depth_worst =
            std::max(figures.depth_worst, (kBall - truth.distance(frame.tool.position)) / o.edge);
      }
      force = next;
    }
    const Vec3 expected = kStiffness * (god - hand);
    if (expected.norm() < 0.1 * kStiffness * o.depth_m)
      continue;  // past the walls of a corner
    if ((god - place.point - kBall * place.normal).norm() > 5e-3 &&
        most_askew > 0.0) {  // around an edge, where minima separate
      ++figures.slid;
      continue;
    }
    directions.push_back(degrees_between(force, expected));
    sizes.push_back(force.norm() / expected.norm() - 1.0);
    jitter.push_back(worst);
    residuals.push_back(frame.residual_m / o.edge);
  }
  figures.direction_median = quantile(directions, 0.5),
  figures.direction_95 = quantile(directions, 0.95);
  figures.size_median = quantile(sizes, 0.5), figures.size_least = quantile(sizes, 0.0),
  figures.size_most = largest(sizes);
  figures.rest_median = quantile(jitter, 0.5), figures.rest_95 = quantile(jitter, 0.95),
  figures.rest_worst = largest(jitter);
  figures.residual_95 = quantile(residuals, 0.95);
  figures.queries_mean = queries / frames;
  figures.frame_us = clock.median();
  return figures;
}

SlideFigures slide(const SlideOptions& o) {
  std::mt19937_64 random(o.seed);
  Rig rig(scene_mesh(o.scene), o.edge, ball_mesh());
  GodObject truth(rig.mesh, kBall);
  // Circle on top of the surface: the hand's depth below the touching ball is constant.
  const Vec3 offset(uniform(random, -1, 1) * o.edge, uniform(random, -1, 1) * o.edge, 0.0);
  const auto touching = [&](double angle) -> Pose {
    const Vec3 flat = offset + 0.02 * Vec3(std::cos(angle), std::sin(angle), 0.0);
    if (o.scene == "cylinder") {  // axis y, radius 40 mm
      const double round = flat.x() / 0.04;
      return {Vec3(0.05 * std::sin(round), flat.y(), 0.05 * std::cos(round)),
              Quat(Eigen::AngleAxisd(round, Vec3::UnitY()))};
    }
    const Quat turn = o.scene == "tilted" ? tilt() : Quat::Identity();
    return {turn * (flat + Vec3(0, 0, kBall)), turn};
  };
  SlideFigures figures;
  const Pose first = touching(0.0);
  const Vec3 up = first.orientation * Vec3::UnitZ();
  if (!rig.place({first.position + 0.002 * up, Quat::Identity()}))
    throw std::logic_error("slide: the start is not free");
  truth.place(first.position + 0.002 * up, 0.08);
  for (int n = 0; n <= 240; ++n)
    rig.frame(first.position + (0.002 - n * 5e-5 * (o.depth_m + 0.002) / 0.012) * up);
  const double round = 2.0 * std::numbers::pi;
  const int steps = static_cast<int>(round * 0.02 / (o.speed * kPeriod));
  std::vector<double> sizes, directions;
  double energy = 0.0, displacement = 0.0, queries = 0.0;
  Clock clock;
  Vec3 last_force = Vec3::Zero(), last_hand = Vec3::Zero();
  for (int n = 0; n <= 2 * steps; ++n) {
    const Pose at = touching(round * n / steps);
    const Vec3 hand = at.position - o.depth_m * (at.orientation * Vec3::UnitZ());
    const exact::VirtualToolFrame frame =
        clock.time([&] { return rig.frame(hand, Quat::Identity(), o.friction); });
    const Vec3 force = frame.wrench(kStiffness).force;
    if (n >= steps) {  // the first round is the approach
      if (n > steps) {
        energy += 0.5 * (force + last_force).dot(hand - last_hand);
        displacement += force.norm() * (hand - last_hand).norm();
        const double step = (force - last_force).norm();
        figures.step_worst = std::max(figures.step_worst, step);
        figures.step_over_force = std::max(figures.step_over_force, step / force.norm());
      }
      sizes.push_back(force.norm());
      directions.push_back(
          degrees_between(force, hand.norm() > 0.0 ? Vec3(truth.draw_to(hand) - hand) : force));
      queries += frame.queries;
      figures.queries_most = std::max(figures.queries_most, frame.queries);
    }
    last_force = force, last_hand = hand;
  }
  for (const double size : sizes)
    figures.mean += size / static_cast<double>(sizes.size());
  figures.noise = test::noise(sizes);
  figures.direction_median = quantile(directions, 0.5),
  figures.direction_95 = quantile(directions, 0.95);
  figures.energy_per_path = energy / displacement;
  figures.queries_mean = queries / static_cast<double>(sizes.size());
  figures.frame_us = clock.median(), figures.frame_us_999 = quantile(clock.us, 0.999);
  return figures;
}

WallFigures walls(const WallOptions& o) {
  std::mt19937_64 random(o.seed);
  const double e = o.edge, thick = o.thick_edges * e;
  const Quat turn = o.askew ? tilt() : Quat::Identity();
  const Vec3 normal = turn * Vec3::UnitZ();
  Rig rig(test::plate_mesh(40 * e, thick, {Vec3::Zero(), turn}), e, ball_mesh(5 * e));
  const double k = kStiffness * 0.002 / e;
  WallFigures figures;
  std::vector<double> jitter;
  double queries = 0.0, frames = 0.0;
  for (const double speed : o.edges_per_frame)
    for (int n = 0; n < o.tries; ++n) {
      const double side = n % 2 == 0 ? 1.0 : -1.0;
      const Vec3 aside = turn * Vec3(uniform(random, -4, 4) * e, uniform(random, -4, 4) * e, 0.0);
      Vec3 hand = aside + side * (5 * e + 0.5 * thick + uniform(random, 0.5, 3.0) * e) * normal;
      const Vec3 across = turn * Vec3(uniform(random, -1, 1), uniform(random, -1, 1), 0.0);
      const Vec3 displacement = (0.5 * across - side * normal).normalized();
      Quat orientation(Eigen::AngleAxisd(uniform(random, 0, 3), random_direction(random)));
      const double spin = uniform(random, 0.0, 0.3) * speed / 5.0;
      const Vec3 axis = random_direction(random);
      if (!rig.place({hand, orientation}))
        continue;
      ++figures.runs;
      bool passed = false;
      const auto step = [&](const Vec3& by, bool rotation) {
        hand += by;
        if (rotation)
          orientation = (Quat(Eigen::AngleAxisd(spin, axis)) * orientation).normalized();
        const exact::VirtualToolFrame frame = rig.frame(Pose{hand, orientation});
        queries += frame.queries, ++frames;
        figures.queries_most = std::max(figures.queries_most, frame.queries);
        const double height = side * normal.dot(frame.tool.position);
        passed = passed || height < 4.0 * e;  // the ball's radius is 5 e
        figures.depth_worst = std::max(figures.depth_worst, 5.0 + 0.5 * o.thick_edges - height / e);
        return frame;
      };
      for (double gone = 0.0; gone < 14.0; gone += speed)
        step(speed * e * displacement, true);
      Vec3 along = turn * Vec3(uniform(random, -1, 1), uniform(random, -1, 1), 0.0).normalized();
      for (double gone = 0.0; gone < 5.0; gone += std::min(speed, 0.5))
        step(std::min(speed, 0.5) * e * along, false);
      for (int rest = 0; rest < 150; ++rest)
        step(Vec3::Zero(), false);
      double worst = 0.0;
      Vec3 force = step(Vec3::Zero(), false).wrench(k).force;
      for (int rest = 0; rest < 50; ++rest) {
        const Vec3 next = step(Vec3::Zero(), false).wrench(k).force;
        worst = std::max(worst, (next - force).norm());
        force = next;
      }
      jitter.push_back(worst);
      figures.passed += passed;
    }
  if (!jitter.empty())
    figures.rest_median = quantile(jitter, 0.5), figures.rest_95 = quantile(jitter, 0.95),
    figures.rest_worst = largest(jitter);
  figures.queries_mean = queries / frames;
  return figures;
}

StartFigures starts(const StartOptions& o) {
  std::mt19937_64 random(o.seed);
  const double e = o.edge, wide = 40 * e, thick = o.thick_edges * e;
  const Quat lie = o.askew ? tilt() : Quat::Identity();
  const bool ball = o.box.isZero();
  const Vec3 half = 0.5 * e * o.box;
  const double radius = o.radius_edges * e, reach = ball ? radius : half.norm();
  const mesh::TriangleMesh tool_mesh = ball ? ball_mesh(radius) : test::box_mesh(e * o.box);
  Rig rig(test::plate_mesh(wide, thick, {Vec3::Zero(), lie}), e, tool_mesh);
  const auto out_of_tool = [&](const Vec3& x) {
    if (ball)
      return x.norm() - radius;
    const Vec3 beyond = x.cwiseAbs() - half;
    return beyond.cwiseMax(0.0).norm() + std::min(0.0, beyond.maxCoeff());
  };
  StartFigures figures;
  for (int quarter = 0; quarter < 4; ++quarter) {
    for (int n = 0; n < o.tries; ++n) {  // in the plate's frame
      const Quat turn =
          o.turned ? Quat(Eigen::AngleAxisd(uniform(random, 0, 3), random_direction(random)))
                   : lie.conjugate();
      const double lean = uniform(random, -1.4, 1.4);
      const Vec3 nearest =
          o.rim ? Vec3(0.5 * wide, uniform(random, -10, 10) * e, 0.0)
                : Vec3(uniform(random, -10, 10) * e, uniform(random, -10, 10) * e, 0.0);
      const Vec3 away = o.rim ? Vec3(std::cos(lean), 0.0, std::sin(lean))
                              : Vec3(0.0, 0.0, n % 2 == 0 ? 1.0 : -1.0);
      const auto depth = [&](double height) {
        const Vec3 at = nearest + height * away;
        double least = std::numeric_limits<double>::infinity();
        const double fine = 0.25 * e, far = std::ceil(reach / fine) * fine;
        for (double x = at.x() - far; x <= at.x() + far; x += fine)
          for (double y = at.y() - far; y <= at.y() + far; y += fine)
            for (const double z : {-0.5 * thick, 0.0, 0.5 * thick}) {
              const Vec3 p(std::clamp(x, -0.5 * wide, 0.5 * wide),
                           std::clamp(y, -0.5 * wide, 0.5 * wide), z);
              least = std::min(least, out_of_tool(turn.conjugate() * (p - at)));
            }
        return -least / e;
      };
      const double expected =
          std::min(uniform(random, o.from_edges, o.to_edges), 0.99 * depth(0.0));
      if (expected < o.from_edges)
        continue;
      double low = 0.0, high = reach + thick + 3 * e;
      for (int bisection = 0; bisection < 12; ++bisection)
        (depth(0.5 * (low + high)) > expected ? low : high) = 0.5 * (low + high);
      ++figures.runs;
      figures.placed += rig.place({lie * (nearest + high * away), (lie * turn).normalized()});
    }
  }
  return figures;
}

const Pose& TumblingHand::next() {
  if ((target_ - pose_.position).norm() < speed_ * kPeriod) {
    target_ = Vec3(uniform(random_, -0.06, 0.06), uniform(random_, -0.06, 0.06),
                   uniform(random_, -0.02, 0.14));
    axis_ = random_direction(random_);
  }
  pose_.position += speed_ * kPeriod * (target_ - pose_.position).normalized();
  pose_.orientation =
      (Quat(Eigen::AngleAxisd(spin_ * kPeriod, axis_)) * pose_.orientation).normalized();
  return pose_;
}

mesh::TriangleMesh tumbling_box() {
  return test::box_mesh(Vec3(0.008, 0.012, 0.03), {Vec3(1e-4, 2e-4, 3e-4), Quat::Identity()});
}

TumbleFigures tumble(const TumbleOptions& o) {
  TumblingHand tumbling(o.speed, o.spin, o.seed);
  Rig rig(scene_mesh(o.scene), o.edge, o.box ? tumbling_box() : ball_mesh());
  TumbleFigures figures;
  if (!rig.place(tumbling.pose()))
    throw std::logic_error("tumble: the start is not free");
  Clock clock;
  double contacts = 0.0, not_converged_frames = 0.0;
  for (int n = 0; n < o.frames; ++n) {
    const Pose& hand = tumbling.next();
    const exact::VirtualToolFrame frame = clock.time([&] { return rig.frame(hand); });
    contacts += frame.constrained, not_converged_frames += frame.not_converged;
    figures.queries_mean += frame.queries / static_cast<double>(o.frames);
    figures.iterations_mean += frame.iterations / static_cast<double>(o.frames);
    figures.inside += inside(rig.mesh, frame.tool.position);
    if (!frame.constrained && !frame.not_converged)
      figures.not_exact += frame.tool.position != hand.position ||
                           frame.tool.orientation.coeffs() != hand.orientation.coeffs() ||
                           !frame.wrench(1.0).zero();
  }
  figures.contact_ratio = contacts / o.frames,
  figures.not_converged_ratio = not_converged_frames / o.frames;
  figures.frame_us = clock.median(), figures.frame_us_999 = quantile(clock.us, 0.999),
  figures.frame_us_worst = largest(clock.us);
  return figures;
}

EdgeFigures over_edge(double edge, double depth_m, double speed, std::uint64_t seed, int tries) {
  std::mt19937_64 random(seed);
  Rig rig(
      test::box_mesh(Vec3(0.06, 0.06, 0.06), {Vec3(0.21e-3, -0.34e-3, -0.03), Quat::Identity()}),
      edge, ball_mesh());
  EdgeFigures figures;
  std::vector<double> sizes;
  for (int n = 0; n < tries; ++n) {
    const Quat turn(Eigen::AngleAxisd(uniform(random, 0, 3), random_direction(random)));
    const double side = uniform(random, -0.015, 0.015), slant = uniform(random, -0.5, 0.5);
    const Vec3 along = Vec3(1.0, slant, 0.0).normalized();
    Vec3 hand(0.01, side, kBall + 0.001);
    rig.place({hand, turn});
    for (int in = 0; in < 100; ++in) {
      hand.z() -= (depth_m + 0.001) / 100;
      rig.frame(Pose{hand, turn});
    }
    Vec3 last = rig.frame(Pose{hand, turn}).wrench(kStiffness).force;
    for (int leg = 0; leg < 2; ++leg) {
      for (double gone = 0.0; gone < 0.035; gone += speed * kPeriod) {
        const Vec3 displacement = (leg == 0 ? 1.0 : -1.0) * speed * kPeriod * along;
        hand += displacement;
        const Vec3 force = rig.frame(Pose{hand, turn}).wrench(kStiffness).force;
        const double step = (force - last).norm();
        figures.step_worst = std::max(figures.step_worst, step);
        figures.step_over_force = std::max(
            figures.step_over_force, step / std::max(0.5 * kStiffness * depth_m, force.norm()));
        figures.energy += 0.5 * (force + last).dot(displacement) / tries;
        sizes.push_back(force.norm());
        last = force;
      }
    }
  }
  for (const double s : sizes)
    figures.force_mean += s / static_cast<double>(sizes.size());
  return figures;
}

}  // namespace voxtouch::virtual_tool
