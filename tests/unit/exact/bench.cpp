/// Prints the time of a frame in CPU time of this thread, and its counted work, for each scene. Run
/// it by hand:
///   bin/exact_bench [scene...]
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <random>
#include <string>
#include <string_view>

#include "core/exact/limits.hpp"
#include "core/exact/simplified.hpp"
#include "tests/unit/exact/rig.hpp"

namespace voxtouch::exact {
namespace {

double cpu_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

using Hand = std::function<Pose(int)>;

struct Scene {
  const char* name;
  std::function<mesh::TriangleMesh()> tool, object;
  int frames;
  Hand hand;
};

/// As the virtual tool of a scene has it.
mesh::TriangleMesh simplified(const mesh::TriangleMesh& mesh) {
  return simplify(mesh, {}, {limits::kSimplifiedM, limits::kSimplifiedRad}).mesh;
}

void print(const Scene& scene) {
  const double before = cpu_us();
  Rig rig(simplified(scene.tool()), simplified(scene.object()));
  const double built = 1e-6 * (cpu_us() - before);
  std::vector<double> times;
  std::uint64_t most_work = 0;
  double most_us_per_unit = 0.0, first_us = 0.0;
  int cut_short = 0, not_converged = 0, rejected_steps = 0, intersecting = 0, starts = 0;
  for (int k = 0; k < scene.frames; ++k) {
    const Pose hand = scene.hand(k);
    const double begin = cpu_us();
    const VirtualToolFrame frame = rig.frame(hand);
    const double took = cpu_us() - begin;
    if (frame.not_initialised || times.empty()) {
      first_us = std::max(first_us, took);
      starts += frame.not_initialised;
      if (frame.not_initialised)
        continue;
    }
    times.push_back(took);
    most_work = std::max(most_work, frame.work);
    if (frame.work > 2000)
      most_us_per_unit = std::max(most_us_per_unit, took / static_cast<double>(frame.work));
    cut_short += frame.cut_short;
    not_converged += frame.not_converged;
    rejected_steps += frame.rejected_steps;
    if (k % 100 == 0)
      intersecting += rig.intersects();
  }
  if (times.empty())
    return void(fmt::print("{:<26} never initialised\n", scene.name));
  std::sort(times.begin(), times.end());
  const auto at = [&](double part) {
    return times[static_cast<std::size_t>(part * static_cast<double>(times.size() - 1))];
  };
  fmt::print(
      "{:<26} {:>6} {:>6.2f} {:>7.1f} {:>7.1f} {:>7.1f} {:>7.1f} {:>7.1f} {:>7} {:>6.1f} {:>6} "
      "{:>6} {:>6} {:>4}\n",
      scene.name, times.size(), built, first_us, at(0.5), at(0.99), at(0.9999), times.back(),
      most_work, 1e3 * most_us_per_unit, cut_short, not_converged, rejected_steps, intersecting);
}

/// A hand that moves to random places within `reach` and rotates within `angle`, a new one each 0.1
/// s.
Hand wander(double reach, double angle) {
  return [=, at = Vec3(Vec3::Zero()), to = Vec3(Vec3::Zero()), turn = Vec3(Vec3::Zero()),
          aim = Vec3(Vec3::Zero()), random = std::mt19937(1)](int k) mutable {
    std::normal_distribution<double> normal;
    if (k >= 100 && k % 100 == 0) {
      to = reach * Vec3(normal(random), normal(random), normal(random));
      aim = angle * Vec3(normal(random), normal(random), normal(random));
    }
    at += 0.03 * (to - at);
    turn += 0.03 * (aim - turn);
    const double by = turn.norm();
    return Pose{at, by > 0.0 ? turned(by, turn) : Quat::Identity()};
  };
}

Pose around(int k, double radius, double speed, double approach) {
  const double r = std::max(radius, approach - 2e-5 * k), angle = 1e-3 * k * speed / r;
  return {Vec3(r * std::cos(angle), r * std::sin(angle), 0.01 * std::sin(0.3 * angle)),
          Quat::Identity()};
}

Pose in_bowl(int k, double speed) {
  const double t = 1e-3 * k * speed;
  return {Vec3(0.03 * std::sin(33 * t), 0.03 * std::sin(25 * t), -0.015 + 0.02 * std::sin(29 * t)),
          turned(17.0 * t, {1, 0.5, 0.4})};
}

Pose over(int k, double speed, double height, double depth) {
  const double t = 1e-3 * std::max(0, k - 200), x = speed * t;
  const double z = std::max(height - 0.02 * t, -depth);
  return {Vec3(0.03 * std::sin(x / 0.03), 0.03 * std::cos(x / 0.041), z),
          turned(3.0 * x / 0.03, {0.3, 0.5, 0.8})};
}

std::vector<Scene> scenes() {
  using namespace test;
  const auto small_box = [] { return box({-.004, -.006, -.015}, {.004, .006, .015}); };
  const auto plate = [] { return box({-.1, -.1, -.02}, {.1, .1, 0}); };
  const auto a_bowl = [] { return bowl(.03, .034, 96, 24); };
  std::vector<Scene> out;
  const auto hole = [&](const char* name, Outline inner, Outline outer, double half) {
    out.push_back({name, [=] { return prism(inner, -half, half); },
                   [=] { return block_with_hole(outer, .02, -.02, .02); }, 9000,
                   wander(1e-3, 0.03)});
  };
  hole("cross 0.2 mm", cross(.01, .003, 0), cross(.01, .003, 2e-4), .01);
  hole("cross 0.05 mm", cross(.01, .003, 0), cross(.01, .003, 5e-5), .01);
  hole("gear 0.2 mm", gear(12, .008, .01, 0), gear(12, .008, .01, 2e-4), .01);
  hole("gear 0.05 mm", gear(12, .008, .01, 0), gear(12, .008, .01, 5e-5), .01);
  hole("pin 0.2 mm", circle(.005, 144), circle(.0052, 144), .015);
  hole("pin 0.05 mm", circle(.005, 144), circle(.00505, 144), .015);
  hole("pin 384 0.2 mm", circle(.005, 384), circle(.0052, 384), .015);
  hole("pin 384 0.05 mm", circle(.005, 384), circle(.00505, 384), .015);
  out.push_back(
      {"ball 642 on plane", [] { return ball(.01, 3); }, plate, 9000,
       [](int k) {
         return Pose{Vec3(1e-5 * (k % 3000), 0, std::max(0.0, .015 - 1e-5 * k)), Quat::Identity()};
       }});
  for (const int levels : {3, 4, 5})
    out.push_back({levels == 3   ? "ball 642 on cylinder"
                   : levels == 4 ? "ball 2562 on cylinder"
                                 : "ball 10242 on cylinder",
                   [=] { return ball(.01, levels); },
                   [] { return prism(circle(.02, 625), -.05, .05); }, 6000,
                   [](int k) { return around(k, .02, .05, .034); }});
  out.push_back({"ball 642 in bowl", [] { return ball(.01, 3); }, a_bowl, 6000,
                 [](int k) {
                   return Pose{.75 * in_bowl(k, 0.1).position, Quat::Identity()};
                 }});
  out.push_back({"box in bowl 1 m/s", small_box, a_bowl, 6000,
                 [](int k) { return in_bowl(k, k < 200 ? 0.0 : 1.0); }});
  out.push_back({"box in bowl 3 m/s", small_box, a_bowl, 6000,
                 [](int k) { return in_bowl(k, k < 200 ? 0.0 : 3.0); }});
  out.push_back(
      {"box on plane 3 m/s", small_box, plate, 6000, [](int k) { return over(k, 3.0, .03, .02); }});
  const auto ground = [] { return terrain(.2, 500, .008); };
  out.push_back(
      {"box on 5e5, 0.1 m/s", small_box, ground, 4000, [](int k) { return over(k, .1, .04, .0); }});
  out.push_back(
      {"box on 5e5, 3 m/s", small_box, ground, 4000, [](int k) { return over(k, 3.0, .04, .0); }});
  out.push_back({"ball 642 on 5e5, 0.1 m/s", [] { return ball(.01, 3); }, ground, 4000,
                 [](int k) {
                   return Pose{over(k, .1, .03, .0).position, Quat::Identity()};
                 }});
  return out;
}

}  // namespace
}  // namespace voxtouch::exact

int main(int count, char** names) {
  double load[3] = {0.0, 0.0, 0.0};
  static_cast<void>(getloadavg(load, 3));
  fmt::print("load {:.1f} {:.1f} {:.1f}; times in us of CPU time; build in s\n", load[0], load[1],
             load[2]);
  fmt::print(
      "{:<26} {:>6} {:>6} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>6} {:>6} {:>6} {:>6} {:>4}\n",
      "scene", "frames", "build", "first", "median", "99 %", "99.99 %", "worst", "work", "ns/w",
      "cut", "not c.", "void", "hit");
  for (const voxtouch::exact::Scene& scene : voxtouch::exact::scenes()) {
    bool asked = count <= 1;
    for (int k = 1; k < count; ++k)
      asked |= std::string_view(scene.name).find(names[k]) != std::string_view::npos;
    if (asked)
      print(scene);
  }
}
