#include "loops.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace voxtouch::virtual_tool {
namespace {

constexpr double kFine = 2e-5;  ///< [s], steps of the mass between samples

/// Whether the mass, after an impulse at rest, returns to rest.
bool dies_out(const LoopOptions& o, Rig* rig, const Vec3& normal, double k) {
  const Vec3 touch = kBall * normal;
  Vec3 x = touch - o.pull_n / k * normal, v = 0.01 * normal;
  if (rig != nullptr) {
    if (!rig->place({touch + 1e-3 * normal, Quat::Identity()}))
      return false;
    for (int n = 0; n <= 200; ++n)
      rig->frame(Vec3(touch + 1e-3 * normal + n / 200.0 * (x - touch - 1e-3 * normal)));
  }
  const auto force_at = [&](const Vec3& hand) -> Vec3 {
    if (rig == nullptr)
      return k * std::max(0.0, (touch - hand).dot(normal)) * normal;
    return rig->frame(hand).wrench(k).force;
  };
  const auto late = static_cast<std::size_t>(std::lround(o.delay_s / kFine));
  std::vector<Vec3> waiting(late + 1, o.pull_n * normal);
  double early[2] = {1.0, -1.0},
         last[2] = {1.0, -1.0};  // least and most along the normal, early and late
  Vec3 delayed = o.pull_n * normal;
  const int fine_per_sample = static_cast<int>(std::lround(kPeriod / kFine)), samples = 1500;
  const Vec3 rest = x;
  for (int n = 0; n < samples; ++n) {
    const Vec3 force = force_at(x);
    for (int f = 0; f < fine_per_sample; ++f) {
      waiting.push_back(force);
      delayed = waiting[waiting.size() - 1 - late];
      v += kFine / o.mass_kg * (delayed - o.pull_n * normal - o.damping_ns_per_m * v);
      x += kFine * v;
    }
    waiting.erase(waiting.begin(), waiting.end() - static_cast<std::ptrdiff_t>(late) - 1);
    const double off = (x - rest).dot(normal);
    if (!(std::abs(off) < 0.05))
      return false;
    double* const window = n < samples / 5        ? nullptr
                           : n < 2 * samples / 5  ? early
                           : n >= 4 * samples / 5 ? last
                                                  : nullptr;
    if (window != nullptr)
      window[0] = std::min(window[0], off), window[1] = std::max(window[1], off);
  }
  return last[1] - last[0] < std::max(0.7 * (early[1] - early[0]), 1e-5);
}

}  // namespace

double largest_stable_stiffness(const LoopOptions& o) {
  std::unique_ptr<Rig> rig;
  if (o.scene != "linear")
    rig = std::make_unique<Rig>(scene_mesh(o.scene), 0.002, ball_mesh());
  const Vec3 normal = o.scene == "tilted" ? Vec3(tilt() * Vec3::UnitZ()) : Vec3::UnitZ();
  double low = 50.0, high = 5000.0;
  while (high / low > 1.03) {
    const double k = std::sqrt(low * high);
    (dies_out(o, rig.get(), normal, k) ? low : high) = k;
  }
  return low;
}

PlanePose exact_lever(const PlanePose& hand, const Vec3& edge_at, double below_m, double lever_m) {
  PlanePose at = hand;
  for (int n = 0; n < 200; ++n) {
    const double c = std::cos(at.turn), s = std::sin(at.turn), dx = edge_at.x() - at.x,
                 dz = edge_at.z() - at.z;
    // The edge in the bar's frame: rotated back about y.
    const double gap = -below_m - (s * dx + c * dz);
    const Vec3 slope(s, c, (-c * dx + s * dz) / lever_m),
        spring(hand.x - at.x, hand.z - at.z, lever_m * (hand.turn - at.turn));
    const double push = std::max(0.0, -(gap + slope.dot(spring)) / slope.squaredNorm());
    const Vec3 step = spring + push * slope;
    at.x += step[0], at.z += step[1], at.turn += step[2] / lever_m;
  }
  return at;
}

LeverFigures lever(double edge, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  // The bar lies along x; 16 mm from the hand its lower face meets the upper edge of a block.
  const Vec3 middle(1.3e-4, 0.7e-4, 0.4e-4), block_edge(0.016, 0, 0);
  const mesh::TriangleMesh bar =
      test::box_mesh(Vec3(0.04, 0.006, 0.006), {middle, Quat::Identity()});
  const mesh::TriangleMesh block =
      test::box_mesh(Vec3(0.02, 0.03, 0.02), {Vec3(0.026, 0, -0.01), Quat::Identity()});
  LeverFigures figures;
  for (int n = 0; n < 10; ++n) {
    Rig rig(block, edge, bar);
    const double aside = uniform(random, -1e-3, 1e-3), lever_m = rig.lever_m;
    const auto hand_at = [&](int k) { return Vec3(aside, 0, 0.005 - 5e-5 * k); };
    rig.place({hand_at(0), Quat::Identity()});
    Vec3 last = Vec3::Zero();
    exact::VirtualToolFrame f;
    for (int k = 0; k <= 250; ++k) {
      f = rig.frame(hand_at(k));
      const Vec3 torque = f.wrench(kStiffness).torque;
      if (torque.norm() > 2e-3)
        figures.step_over_torque =
            std::max(figures.step_over_torque, (torque - last).norm() / torque.norm());
      last = torque;
    }
    for (int k = 0; k < 200; ++k)
      f = rig.frame(hand_at(250));
    const double exact =
        kStiffness * lever_m * lever_m *
        exact_lever({aside, hand_at(250).z(), 0.0}, block_edge, 0.003 - middle.z(), lever_m).turn;
    figures.torque_error =
        std::max(figures.torque_error, std::abs(f.wrench(kStiffness).torque.y() / exact - 1.0));
  }
  return figures;
}

constexpr double kPegLever = 0.015;

mesh::TriangleMesh hole_mesh(double radius_m, double deep_m) {
  constexpr std::uint32_t kSides = kPegSides;
  constexpr double kOuter = 0.02, kFloor = 0.01;
  mesh::TriangleMesh mesh;
  for (std::uint32_t n = 0; n < kSides; ++n) {
    const double angle = 2 * std::numbers::pi * n / kSides, out = kOuter,
                 in = radius_m / std::cos(std::numbers::pi / kSides);
    const Vec3 to(std::cos(angle), std::sin(angle), 0);
    for (const Vec3& v : {Vec3(out * to - (deep_m + kFloor) * Vec3::UnitZ()), Vec3(out * to),
                          Vec3(in * to), Vec3(in * to - deep_m * Vec3::UnitZ())})
      mesh.vertices.push_back(v);
  }
  mesh.vertices.emplace_back(0, 0, -deep_m);
  mesh.vertices.emplace_back(0, 0, -deep_m - kFloor);
  for (std::uint32_t n = 0; n < kSides; ++n) {
    const std::uint32_t a = 4 * n, b = 4 * ((n + 1) % kSides);
    for (std::uint32_t ring = 0; ring < 3; ++ring) {
      mesh.triangles.push_back({a + ring, b + ring, b + ring + 1});
      mesh.triangles.push_back({a + ring, b + ring + 1, a + ring + 1});
    }
    mesh.triangles.push_back({a + 3, b + 3, 4 * kSides});
    mesh.triangles.push_back({b, a, 4 * kSides + 1});
  }
  return mesh;
}

mesh::TriangleMesh peg_mesh() { return test::cylinder_mesh(kPegRadius, kPegLong, kPegSides); }

PegFigures peg(double edge, double clearance_m, bool turned) {
  Rig rig(hole_mesh(kPegRadius + clearance_m, kPegHole), edge, peg_mesh(), kPegLever);
  PegFigures figures;
  double z = kPegLong / 2 + 0.003;
  if (!rig.place({Vec3(0, 0, z), Quat::Identity()}))
    return figures;
  exact::VirtualToolFrame f;
  const auto go = [&](double to, const Vec3& aside, const Quat& turn) {
    for (; z > to; z -= 5e-5) {
      f = rig.frame(Pose{Vec3(aside.x(), aside.y(), z), turn});
      if (z > kPegLong / 2 - kPegHole + 2e-3)
        figures.drag_n = std::max(figures.drag_n, std::abs(f.wrench(kStiffness).force.z()));
    }
  };
  go(kPegLong / 2 - 0.008, Vec3::Zero(), Quat::Identity());
  constexpr double kTilt = 2.9 * std::numbers::pi / 180;
  const Quat turn = turned ? Quat(Eigen::AngleAxisd(kTilt, Vec3::UnitX())) : Quat::Identity();
  const Vec3 aside = turned ? Vec3::Zero() : Vec3(1.7e-3, 0, 0);
  for (int n = 1; n <= 50; ++n)  // slowly aside
    f = rig.frame(Pose{Vec3(n / 50.0 * aside.x(), 0, z), Quat::Identity().slerp(n / 50.0, turn)});
  go(kPegLong / 2 - kPegHole - 0.004, aside, turn);
  for (int n = 0; n < 200; ++n)
    f = rig.frame(Pose{Vec3(aside.x(), aside.y(), z), turn});
  figures.short_m = f.tool.position.z() - (kPegLong / 2 - kPegHole);
  figures.entered = figures.short_m < 0.01;
  return figures;
}

PlanePose exact_pin(const PlanePose& hand, double hole_radius, double lever_m) {
  PlanePose at = hand;
  for (int n = 0; n < 500; ++n) {
    const double c = std::cos(at.turn), s = std::sin(at.turn), dx = hole_radius - at.x, dz = -at.z;
    const Vec3 spring(hand.x - at.x, hand.z - at.z, lever_m * (hand.turn - at.turn));
    // A positive angle leans the upper end towards x: its side meets the mouth's edge there, its
    // lower rim the opposite wall.
    const double gap[2] = {c * dx - s * dz - kPegRadius,
                           at.x - c * kPegRadius - s * kPegLong / 2 + hole_radius};
    const Vec3 slope[2] = {Vec3(-c, s, (-s * dx - c * dz) / lever_m),
                           Vec3(1, 0, (s * kPegRadius - c * kPegLong / 2) / lever_m)};
    const double a = slope[0].squaredNorm(), b = slope[1].squaredNorm(), m = slope[0].dot(slope[1]),
                 det = a * b - m * m;
    const double u = -(gap[0] + slope[0].dot(spring)), v = -(gap[1] + slope[1].dot(spring));
    // Neither, one of both, or both touch: the nearest that neither pulls nor sinks in.
    const double pushes[4][2] = {
        {0, 0}, {u / a, 0}, {0, v / b}, {(u * b - v * m) / det, (v * a - u * m) / det}};
    Vec3 best = Vec3::Constant(1.0);
    for (const auto& push : pushes) {
      const Vec3 step = spring + push[0] * slope[0] + push[1] * slope[1];
      const bool allowed = push[0] >= 0 && push[1] >= 0 && gap[0] + slope[0].dot(step) > -1e-12 &&
                           gap[1] + slope[1].dot(step) > -1e-12;
      if (allowed && (step - spring).norm() < (best - spring).norm())
        best = step;
    }
    at.x += best[0], at.z += best[1], at.turn += best[2] / lever_m;
  }
  return at;
}

PinFigures pin(double edge, double clearance_m, double rotation_rad, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  constexpr double kIn = 0.015;
  Rig rig(hole_mesh(kPegRadius + clearance_m, kPegHole), edge, peg_mesh(), kPegLever);
  const double angle = uniform(random, 0, 2 * std::numbers::pi);
  const Vec3 axis(std::cos(angle), std::sin(angle), 0);
  PinFigures figures;
  double z = kPegLong / 2 + 0.003;
  if (!rig.place({Vec3(0, 0, z), Quat::Identity()}))
    return figures;
  for (; z > kPegLong / 2 - kIn; z -= 5e-5)
    rig.frame(Vec3(0, 0, z));
  const auto exact = [&](double turn) {
    return kStiffness * kPegLever * kPegLever *
           (turn - exact_pin({0, z, turn}, kPegRadius + clearance_m, kPegLever).turn);
  };
  figures.torque_nm = exact(rotation_rad);
  constexpr int kFrames = 2000;
  double last = 0.0;
  for (int n = 1; n <= kFrames; ++n) {
    const double turn = rotation_rad * n / kFrames, expected = exact(turn);
    const double torque = -rig.frame(Pose{Vec3(0, 0, z), Quat(Eigen::AngleAxisd(turn, axis))})
                               .wrench(kStiffness)
                               .torque.dot(axis);
    figures.step_over_torque =
        std::max(figures.step_over_torque, std::abs(torque - last) / figures.torque_nm);
    if (expected > 0.2 * figures.torque_nm)
      figures.torque_error = std::max(figures.torque_error, std::abs(torque / expected - 1.0));
    last = torque;
  }
  return figures;
}

}  // namespace voxtouch::virtual_tool
