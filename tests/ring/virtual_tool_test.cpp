// A scene with a virtual tool through the whole ring, in lockstep: the force on a hand that presses
// and slides. In one process, which is twice as fast; the last case checks that five processes give
// bit-identical results.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <numeric>
#include <random>

#include "core/types/geometry.hpp"
#include "nodes/runtime/convert.hpp"
#include "tests/experiments/virtual_tool/loops.hpp"
#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

constexpr double kRadius = 0.01;

/// A slab of 120 mm with its top through the origin, facing along `up`'s z axis; of no thickness:
/// an open sheet.
void write_plate(const std::filesystem::path& file, double thick_m,
                 const Quat& up = Quat::Identity()) {
  std::ofstream out(file);
  out.precision(17);
  for (int k = 0; k < 8; ++k) {
    const Vec3 v = up * Vec3(k & 1 ? 0.06 : -0.06, k & 2 ? 0.06 : -0.06, k & 4 ? 0.0 : -thick_m);
    out << "v " << v.x() << " " << v.y() << " " << v.z() << "\n";
  }
  if (thick_m == 0.0) {
    out << "f 5 6 8 7\n";
    return;
  }
  out << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

/// A ball of 10 mm over `mesh` with voxels of 2 mm; the hand's path as text.
std::string write_scene(const TemporaryFolder& folder, const std::string& mesh,
                        const std::string& path, double speed) {
  const std::string deploy = VOXTOUCH_DEPLOY, file = (folder / "tool.yaml").string();
  std::ofstream(file) << "scene: tool\nvoxel_size: 0.002\nstatic: [{mesh: " << mesh
                      << "}]\ndynamic: {mesh: " << deploy
                      << "/meshes/sphere.obj, scale: 0.01, parts: [{sphere: {radius: 0.01}}]}\n"
                      << "contact: {model: field, rendering: virtual_tool}\ncoupling: {design: "
                         "auto, kind: shaping_filter}\n"
                      << "motions: {it: {path: [" << path << "], speed_m_per_s: " << speed
                      << ", hold_s: 0.3}}\n";
  return file;
}

struct Recorded {
  nlohmann::json summary;
  std::vector<Vec3> hand, force;  ///< as the device measures it; as the coupling commands
  std::vector<virtual_tool::PlanePose> pose;  ///< of the hand, in the plane of x and z
  std::vector<double> torque_y;
  std::vector<msg::ContactState> contacts;
  double certified = 0.0;
};

virtual_tool::PlanePose in_plane(const Pose& pose) {
  const Vec3 up = pose.orientation * Vec3::UnitZ();
  return {pose.position.x(), pose.position.z(), std::atan2(up.x(), up.z())};
}

Recorded run(const std::string& scene, const std::string& motion, const std::string& device,
             double duration_s, std::vector<std::string> more = {"--one-process"},
             bool judged = true) {
  const TemporaryFolder folder;
  more.insert(more.end(), {"--device", device, "--motion", motion, "--lockstep", "--duration",
                           std::to_string(duration_s), "--record", (folder / "bag").string()});
  const RingResult ring = run_ring(scene, more);
  if (judged) {
    EXPECT_EQ(ring.process.status, 0) << ring.process.err << ring.process.out;
  }
  Recorded out;
  out.summary = ring.summary;
  out.certified = ring.summary["coupling"]["displayed_stiffness_n_per_m"];
  for (const auto& m : read_ring_topic<msg::DeviceState>(folder / "bag", "/haptic/device/state"))
    out.hand.push_back(runtime::from_msg(m.pose).position),
        out.pose.push_back(in_plane(runtime::from_msg(m.pose)));
  for (const auto& m :
       read_ring_topic<msg::ForceCommand>(folder / "bag", "/haptic/coupling/command"))
    out.force.push_back(runtime::from_msg(m.wrench).force),
        out.torque_y.push_back(runtime::from_msg(m.wrench).torque.y());
  out.contacts = read_ring_topic<msg::ContactState>(folder / "bag", "/haptic/rendering/contact");
  EXPECT_EQ(out.hand.size(), out.force.size());
  EXPECT_EQ(ring.summary["validator"]["in_band"], 0);
  if (judged) {
    EXPECT_EQ(ring.summary["validator"]["disagree"], 0) << ring.summary["problems"];
  }
  return out;
}

/// Means over 50 ms by default, at rest or nearly so, which average the encoder's steps.
double mean(const std::vector<double>& x, std::size_t at, std::size_t half = 25) {
  return std::accumulate(x.begin() + static_cast<std::ptrdiff_t>(at - half),
                         x.begin() + static_cast<std::ptrdiff_t>(at + half), 0.0) /
         static_cast<double>(2 * half);
}

/// Presses 40 mm deep at 10 mm/s and holds the returned force against the hand's true depth.
/// `half`: of the samples that a mean is of.
void presses(double thick_m, const std::string& device, double hand_n_per_m, double encoder_m,
             double least_n, std::size_t half = 25) {
  const TemporaryFolder folder;
  write_plate(folder / "slab.obj", thick_m);
  const Recorded r = run(write_scene(folder, (folder / "slab.obj").string(),
                                     "[0.003, 0.002, 0.013], [0.003, 0.002, -0.03]", 0.01),
                         "it", device, 9.0);
  std::vector<double> depth, force;
  for (std::size_t i = 0; i < r.hand.size(); ++i)
    depth.push_back(kRadius - r.hand[i].z()), force.push_back(r.force[i].z());
  double last = 0.0, deepest_so_far = 0.0, worst = 10.0, worst_depth = 0.0, worst_from_1_n = 10.0,
         at_10_mm = 0.0;
  int measured = 0;
  for (std::size_t i = 400; i + half + 5 < depth.size(); i += 25) {
    const double d = mean(depth, i, half), f = mean(force, i, half),
                 expected = d + f / hand_n_per_m;  // slow: the hand's spring holds the force
    if (expected < 0.001)
      continue;
    if (expected < 0.01)
      at_10_mm = f;
    const double fraction = f / (r.certified * d);
    if (fraction < worst)
      worst = fraction, worst_depth = d;
    if (f >= 1.0)
      worst_from_1_n = std::min(worst_from_1_n, fraction);
    EXPECT_GE(f, 0.95 * r.certified * (d - 1e-4))
        << "requested " << expected << " m, hand " << d << " m deep, " << f << " N";
    if (d > deepest_so_far) {  // dry friction of the device permits small backward motions between
                               // two places
      EXPECT_GE(f, last * (1.0 - 1e-3) - r.certified * encoder_m)
          << "monotonic; requested " << expected;
      last = f, deepest_so_far = d;
    }
    ++measured;
  }
  const double deepest = mean(force, force.size() - 30);
  testing::Test::RecordProperty("certified_n_per_m", std::to_string(r.certified));
  testing::Test::RecordProperty("worst_ratio", std::to_string(worst));
  testing::Test::RecordProperty("worst_share_at_depth_m", std::to_string(worst_depth));
  testing::Test::RecordProperty("force_at_10_mm_wanted_n", std::to_string(at_10_mm));
  testing::Test::RecordProperty("force_at_40_mm_wanted_n", std::to_string(deepest));
  std::printf(
      "%s, %.4g m thick: certified %.4g N/m, least fraction %.4f at %.4g m deep, %.4f from 1 N on, "
      "%.3f N at 10 mm requested, %.3f N at 40 mm requested, %d places\n",
      device.c_str(), thick_m, r.certified, worst, worst_depth, worst_from_1_n, at_10_mm, deepest,
      measured);
  EXPECT_GT(measured, 100);
  EXPECT_GE(worst_from_1_n, 0.95);
  EXPECT_GE(deepest, least_n);
}

TEST(VirtualToolRing, DisplaysTheCertifiedStiffnessAtEveryDepth) {
  presses(0.02, "sim-phantom", 300.0, 0.0, 5.0);
}
TEST(VirtualToolRing, DisplaysItOnAPlateOfTwoMillimetres) {
  presses(0.002, "sim-phantom", 300.0, 0.0, 5.0);
}
/// It moves in by one encoder step per 45 ms, and its damper answers each with 2.5 mNs: means over
/// 200 ms.
TEST(VirtualToolRing, DisplaysItOnAnArm) { presses(0.02, "sim-lwr", 200.0, 2e-5, 6.0, 100); }

/// Pressed along the plate's normal at `place` (in the plate): never a force from the far side, and
/// never none while the hand is through.
void holds(double edges, double speed, const std::string& device, const Quat& up = Quat::Identity(),
           const Vec3& place = {0.003, 0.002, 0.0}, bool judged = true) {
  SCOPED_TRACE(std::to_string(edges) + " e at " + std::to_string(speed) + " m/s, " + device);
  const TemporaryFolder folder;
  write_plate(folder / "plate.obj", 0.002 * edges, up);
  const auto at = [&](double height) {
    const Vec3 p = up * (place + Vec3(0, 0, height));
    return "[" + std::to_string(p.x()) + ", " + std::to_string(p.y()) + ", " +
           std::to_string(p.z()) + "]";
  };
  const std::string scene =
      write_scene(folder, (folder / "plate.obj").string(), at(0.03) + ", " + at(-0.02), speed);
  // An impact at 3 m/s is steeper than the guard's slew limit.
  const Recorded r = run(scene, "it", device, 0.3 + 0.1 / speed + 0.5,
                         {"--one-process", "--limit", "clamped_ratio=0.01"}, judged);
  if (r.summary["validator"]["disagree"] != 0)
    std::printf("%.3g e at %.3g m/s, %s: %s\n", edges, speed, device.c_str(),
                r.summary["problems"].dump().c_str());
  const Vec3 normal = up * Vec3::UnitZ();
  double least = 1.0;
  for (const auto& c : r.contacts)
    least = std::min(least, normal.dot(runtime::from_msg(c.object_pose).position));
  EXPECT_GT(least, kRadius - 5e-4) << "the virtual tool has passed";
  EXPECT_GT(normal.dot(r.force.back()), 1.0);
}

TEST(VirtualToolRing, ThinPlatesHoldAtAnySpeed) {
  int n = 0;  // alternates the devices
  for (const double edges : {0.25, 0.5, 1.0, 2.0, 5.0})
    for (const double speed : {0.02, 0.5, 3.0})
      holds(edges, speed, n++ % 2 == 0 ? "sim-phantom" : "sim-lwr");
}

TEST(VirtualToolRing, IsHeldByAnOpenSheet) {
  holds(0.0, 0.02, "sim-phantom");
  holds(0.0, 0.5, "sim-phantom", Quat(Eigen::AngleAxisd(0.3, Vec3(1, 2, 0.5).normalized())));
}

/// Of any thickness and place, half of them askew by up to 20 degrees.
TEST(VirtualToolRing, IsHeldByTenPlates) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (int n = 0; n < 10; ++n) {
    const double edges = 0.25 * std::pow(20.0, 0.5 + 0.5 * u(random)),
                 speed = 0.02 * std::pow(150.0, 0.5 + 0.5 * u(random));
    const Vec3 axis = Vec3(u(random), u(random), u(random)).normalized(),
               place(0.02 * u(random), 0.02 * u(random), 0.0);
    const double askew = 0.35 * u(random);
    holds(edges, speed, n % 2 == 0 ? "sim-phantom" : "sim-lwr",
          n % 4 < 2 ? Quat::Identity() : Quat(Eigen::AngleAxisd(askew, axis)), place);
  }
}

void write_mesh(const std::filesystem::path& file, const mesh::TriangleMesh& mesh) {
  std::ofstream out(file);
  out.precision(17);
  for (const Vec3& v : mesh.vertices)
    out << "v " << v.x() << " " << v.y() << " " << v.z() << "\n";
  for (const auto& t : mesh.triangles)
    out << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
}

constexpr double kLever = 0.015;

/// A tool against a part on sim-lwr, e = 1 mm: the torque that the coupling commands, over that of
/// the exact tool at the pose that the device measures.
void gives_torque(
    const mesh::TriangleMesh& part, const mesh::TriangleMesh& tool, const std::string& motion,
    double duration_s, double least_nm,
    const std::function<virtual_tool::PlanePose(const virtual_tool::PlanePose&)>& exact) {
  const TemporaryFolder folder;
  write_mesh(folder / "part.obj", part), write_mesh(folder / "tool.obj", tool);
  const std::string file = (folder / "torque.yaml").string();
  std::ofstream(file)
      << "scene: torque\nvoxel_size: 0.001\nstatic: [{mesh: part.obj}]\ndynamic: {mesh: tool.obj}\n"
      << "contact: {model: field, rendering: virtual_tool}\ntool: {lever_m: " << kLever
      << "}\ncoupling: {design: auto}\nmotions: {it: {" << motion << "}}\n";
  const Recorded r = run(file, "it", "sim-lwr", duration_s);
  std::vector<double> expected;
  for (const virtual_tool::PlanePose& hand : r.pose)
    expected.push_back(r.certified * kLever * kLever * (exact(hand).turn - hand.turn));
  const double last = mean(expected, expected.size() - 30);
  double worst = 0.0;
  int measured = 0;
  for (std::size_t i = 400; i + 30 < expected.size(); i += 25) {
    const double is = mean(r.torque_y, i), of = mean(expected, i);
    if (of / last < 0.2)
      continue;
    worst = std::max(worst, std::abs(is / of - 1.0)), ++measured;
  }
  std::printf("certified %.4g N/m, exact torque %.4f N m, off by %.4f at most in %d places\n",
              r.certified, last, worst, measured);
  EXPECT_GE(std::abs(last), least_nm);
  EXPECT_GT(measured, 30);
  EXPECT_LE(worst, 0.05);
  EXPECT_EQ(r.summary["guard"]["clamped"], 0) << "a step that the guard had to spread";
}

TEST(VirtualToolRing, GivesTheTorqueOfABarOverAnEdge) {
  gives_torque(
      box_mesh(Vec3(0.02, 0.03, 0.02), {Vec3(0.026, 0, -0.01), Quat::Identity()}),
      box_mesh(Vec3(0.04, 0.006, 0.006)),
      "path: [[0.0004, 0.0002, 0.012], [0.0004, 0.0002, -0.008]], speed_m_per_s: 0.01, hold_s: 0.3",
      6.0, 0.01, [](const auto& hand) {
        return virtual_tool::exact_lever(hand, Vec3(0.016, 0, 0), 0.003, kLever);
      });
}

TEST(VirtualToolRing, GivesTheTorqueOfARotatedPin) {
  constexpr double kClearance = 2e-4;
  gives_torque(
      virtual_tool::hole_mesh(virtual_tool::kPegRadius + kClearance, virtual_tool::kPegHole),
      virtual_tool::peg_mesh(),
      "path: [[0, 0, 0.018], [0, 0, 0]], speed_m_per_s: 0.01, hold_s: 0.3, turn: {axis: [0, 1, 0], "
      "angle_rad: 0.21, from_s: 4.5, to_s: 7.5}",
      8.5, 0.01, [](const auto& hand) {
        return virtual_tool::exact_pin(hand, virtual_tool::kPegRadius + kClearance, kLever);
      });
}

TEST(VirtualToolRing, IsBitIdenticalInFiveProcessesAndInOne) {
  const std::string scene = shipped_scene("cup_virtual_tool");
  const Recorded five = run(scene, "slide", "sim-lwr", 3.0, {}),
                 one = run(scene, "slide", "sim-lwr", 3.0);
  ASSERT_EQ(five.contacts.size(), one.contacts.size());
  std::size_t pressed = 0;
  for (std::size_t i = 0; i < five.contacts.size(); ++i) {
    msg::ContactState a = five.contacts[i], b = one.contacts[i];
    ASSERT_EQ(std::memcmp(&a, &b, sizeof a), 0) << i;
    pressed += (a.flags & msg::contact_state::kFlagConstrained) != 0 ? 1 : 0;
  }
  EXPECT_GT(pressed, 500U);
}

}  // namespace
}  // namespace voxtouch::test
