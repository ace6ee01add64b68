// A hand that presses slowly into a block through the whole ring, with penalty forces at the hand's
// pose: force over the true depth.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <numeric>

#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

constexpr double kRadius = 0.01, kHandNPerM = 300.0;  ///< of the ball; of the simulated hand's arm

std::string write_scene(const TemporaryFolder& folder, const std::string& contact) {
  std::ofstream slab(folder / "slab.obj");
  for (int k = 0; k < 8; ++k)
    slab << "v " << (k & 1 ? 0.06 : -0.06) << " " << (k & 2 ? 0.06 : -0.06) << " "
         << (k & 4 ? 0.0 : -0.05) << "\n";
  slab << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  const std::string file = (folder / "press.yaml").string();
  std::ofstream(file)
      << "scene: press\nvoxel_size: 0.002\nstatic: [{mesh: slab.obj}]\ndynamic: {mesh: "
      << VOXTOUCH_DEPLOY << "/meshes/sphere.obj, scale: 0.01, shell: exact}\ncontact: {" << contact
      << "}\ncoupling: {design: auto, kind: shaping_filter}\n"
      << "motions: {it: {path: [[0.003, 0.002, 0.013], [0.003, 0.002, -0.03]], speed_m_per_s: "
         "0.01, hold_s: 0.3}}\n";
  return file;
}

double mean(const std::vector<double>& x, std::size_t at) {
  constexpr std::ptrdiff_t kHalf = 25;
  const auto middle = x.begin() + static_cast<std::ptrdiff_t>(at);
  return std::accumulate(middle - kHalf, middle + kHalf, 0.0) / (2.0 * kHalf);
}

/// Targets of 1 to 40 mm. The displayed force is at least `fraction` of the certified stiffness
/// times the depth, and rises, down to `most_m`. A ball of facets and points begins `late_m` deep.
/// Behind the spring of K_c a contact of K displays K K_c/(K + K_c): at least `fraction` of K_c for
/// these.
void presses(const std::string& contact, double most_m, double late_m, double fraction = 0.5) {
  SCOPED_TRACE(contact);
  const TemporaryFolder folder;
  const RingResult ring =
      run_ring(write_scene(folder, contact),
               {"--one-process", "--lockstep", "--device", "sim-phantom", "--motion", "it",
                "--duration", "5.5", "--record", (folder / "bag").string()});
  ASSERT_EQ(ring.process.status, 0) << ring.process.err << ring.process.out;
  const double certified = ring.summary["coupling"]["displayed_stiffness_n_per_m"];
  std::vector<double> depth, force;
  for (const auto& m : read_ring_topic<msg::DeviceState>(folder / "bag", "/haptic/device/state"))
    depth.push_back(kRadius - m.pose.position.z);
  for (const auto& m :
       read_ring_topic<msg::ForceCommand>(folder / "bag", "/haptic/coupling/command"))
    force.push_back(m.wrench.force.z);
  ASSERT_EQ(depth.size(), force.size());
  double last = 0.0, deepest = 0.0, worst = 10.0, worst_m = 0.0, at_10_mm = 0.0;
  int measured = 0;
  for (std::size_t i = 400; i + 30 < depth.size(); i += 25) {
    const double d = mean(depth, i), f = mean(force, i), expected = d + f / kHandNPerM;
    if (expected < 0.001 || expected > 0.04 || d > most_m)
      continue;
    if (expected < 0.01)
      at_10_mm = f;
    if (const double here = f / (certified * d); here < worst)
      worst = here, worst_m = d;
    EXPECT_LE(f, 1.01 * certified * d) << "hand " << d << " m deep";
    EXPECT_GE(f, fraction * certified * (d - late_m)) << "hand " << d << " m deep";
    if (d > deepest) {
      EXPECT_GE(f, last * (1.0 - 1e-3)) << "rises all the way; hand " << d << " m deep";
      last = f, deepest = d;
    }
    ++measured;
  }
  std::printf(
      "%s: certified %.4g N/m, least fraction %.4f at %.4g m deep, %.3f N at 10 mm requested, %.3f "
      "N "
      "at "
      "%.4g m deep, %d places\n",
      contact.c_str(), certified, worst, worst_m, at_10_mm, last, deepest, measured);
  EXPECT_GT(measured, 50);
}

TEST(PressRing, FieldStaysBelowTheCertifiedStiffness) {
  presses("model: field, stiffness_n_per_m3: 1.0e+8", 1.0, 1.2e-4);
}
/// A ball with such soft points reaches the certified stiffness after some millimetres; deep inside
/// its normals cancel.
TEST(PressRing, SoftContactNeverFallsDuringIndentation) {
  presses("model: adapted, stiffness_n_per_m: 30", 1.0, 1e-4, 0.35);
}
TEST(PressRing, PerPointNormalsNeverFallDuringIndentation) {
  presses("model: original, stiffness_n_per_m: 200", 0.009, 1e-4, 0.65);
}
TEST(PressRing, NeverFallsToTheEndForAnyModel) {
  for (const char* contact :
       {"model: original, stiffness_n_per_m: 200", "model: adapted, stiffness_n_per_m: 200"})
    presses(contact, 1.0, 1e-4, 0.65);
}
/// Deeper, the normals of the ball's points cancel, and the model falls back to the normals of the
/// points.
TEST(PressRing, AdaptedStaysBelowTheCertifiedStiffness) {
  presses("model: adapted, stiffness_n_per_m: 200", 0.007, 1e-4, 0.65);
}

}  // namespace
}  // namespace voxtouch::test
