// Sources of the noise of a sliding force: the device's motion, its encoder's steps, or the
// system's response to both. By function calls, which equal the ring's figures: a ring in lockstep
// had the same noise to all four printed digits.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <numbers>
#include <numeric>

#include "tests/hard/loop/tool_loop.hpp"

namespace voxtouch::test {
namespace {

constexpr double kSpeed = 0.05;
constexpr std::size_t kHalf = 50;  ///< of the 100 samples, 100 ms, that a mean is of

/// In contact over `kHalf` samples to either side, and sliding at half of the hand's speed at
/// least.
bool slides(const ToolRun& run, std::size_t i) {
  for (std::size_t k = i - kHalf; k < i + kHalf; ++k)
    if (run.samples[k].true_force.isZero(0.0))
      return false;
  return (run.samples[i + kHalf].true_hand - run.samples[i - kHalf].true_hand).norm() >
         0.5 * kSpeed * 2e-3 * static_cast<double>(kHalf);
}

/// Deviation of `of` from its mean over 100 ms while sliding, root mean square.
double noise(const ToolRun& run, const std::function<double(const ToolSample&)>& of) {
  double squares = 0.0;
  int count = 0;
  for (std::size_t i = kHalf; i + kHalf < run.samples.size(); ++i) {
    if (!slides(run, i))
      continue;
    double sum = 0.0;
    for (std::size_t k = i - kHalf; k < i + kHalf; ++k)
      sum += of(run.samples[k]);
    squares += std::pow(of(run.samples[i]) - sum / (2.0 * kHalf), 2), ++count;
  }
  return std::sqrt(squares / std::max(count, 1));
}

struct Ground {
  const char *mesh, *motion;
  double duration_s;
  std::function<double(const Vec3&)>
      depth;  ///< of the ball's centre [m]; none: the rendering at the true pose is used instead
};

const std::vector<Ground>& grounds() {
  static const std::vector<Ground> all = {
      {"plane.obj",
       "path: [[-0.05, -0.01, 0.02], [-0.05, -0.01, 0], [0.05, 0.012, 0]], speed_m_per_s: 0.05, "
       "hold_s: 0.3",
       4.0, [](const Vec3& x) { return kToolRadius - x.z(); }},
      {"cylinder.obj",
       "path: [[0, -0.06, 0.06], [0, -0.06, 0.04], [0.012, 0.06, 0.0387]], speed_m_per_s: 0.05, "
       "hold_s: 0.3",
       4.4, [](const Vec3& x) { return 0.04 + kToolRadius - std::hypot(x.x(), x.z()); }},
      {"cup.obj",
       "path: [[-0.07518, -0.02736, 0.025], [-0.03935, -0.0143, 0.025]], circle: {centre: [0, 0, "
       "0.025], axis: [0, 0, -1]}, speed_m_per_s: 0.05, hold_s: 0.3",
       4.5,
       {}}};
  return all;
}

/// Ratios to the mean force while sliding.
struct Fractions {
  double force_n = 0.0, slid_s = 0.0;
  double total = 0.0;    ///< of the force given to the device
  double moved = 0.0;    ///< of the spring times the true depth
  double encoder = 0.0;  ///< of the contact's change between the true and the reported pose
  double rendered =
      0.0;               ///< of the rendering's deviation from spring times depth, at the true pose
  double coupled = 0.0;  ///< of the coupling's change of the contact force: filter and damper
};

Fractions fractions(const ToolRun& run, const Ground& ground) {
  const auto moved = [&](const ToolSample& s) {
    return ground.depth ? run.spring_n_per_m * ground.depth(s.true_hand) : s.true_force.norm();
  };
  Fractions out;
  int count = 0;
  for (std::size_t i = kHalf; i + kHalf < run.samples.size(); ++i)
    if (slides(run, i))
      out.force_n += run.samples[i].commanded.norm(), ++count;
  out.force_n /= std::max(count, 1), out.slid_s = 1e-3 * count;
  const auto fraction = [&](const std::function<double(const ToolSample&)>& of) {
    return noise(run, of) / out.force_n;
  };
  out.total = fraction([](const ToolSample& s) { return s.commanded.norm(); });
  out.moved = fraction(moved);
  out.encoder =
      fraction([](const ToolSample& s) { return s.contact.norm() - s.true_force.norm(); });
  out.rendered = fraction([&](const ToolSample& s) { return s.true_force.norm() - moved(s); });
  out.coupled = fraction([](const ToolSample& s) { return s.commanded.norm() - s.contact.norm(); });
  return out;
}

Fractions slide(const char* name, const sim::SimParameters& device, const Ground& ground,
                const std::string& mesh, const char* kind, const LeftOut& skipped,
                double voxel_m = kToolVoxel) {
  const TemporaryFolder folder;
  const ToolRun run = run_tool(tool_scene(folder, mesh, ground.motion, kind, voxel_m), device,
                               skipped, ground.duration_s);
  const Fractions s = fractions(run, ground);
  std::printf(
      "%-11s %-12s %-14s%s%s: %.0f N/m, %.2f N for %.2f s, noise %.2f %%: true depth %.2f, encoder "
      "%.2f, rendering %.2f, coupling %.2f\n",
      name, ground.mesh, kind, skipped.encoder ? ", no steps" : "",
      skipped.friction ? ", no dry friction" : "", run.spring_n_per_m, s.force_n, s.slid_s,
      100 * s.total, 100 * s.moved, 100 * s.encoder, 100 * s.rendered, 100 * s.coupled);
  EXPECT_GT(s.slid_s, 0.7);
  EXPECT_GT(s.force_n, 0.5);
  return s;
}
Fractions slide(const char* name, const sim::SimParameters& device, const Ground& ground,
                const char* kind, const LeftOut& skipped) {
  return slide(name, device, ground, std::string(VOXTOUCH_DEPLOY) + "/meshes/" + ground.mesh, kind,
               skipped);
}

/// A closed tube as high and as wide as the cup's wall, about z.
std::string tube(const TemporaryFolder& folder, int sides) {
  const std::string file = (folder / "tube.obj").string();
  std::ofstream out(file);
  out.precision(12);
  for (const double z : {0.0, 0.05})
    for (int i = 0; i < sides; ++i) {
      const double turn = 2.0 * std::numbers::pi * (i + 0.5) / sides;
      out << "v " << 0.04 * std::cos(turn) << ' ' << 0.04 * std::sin(turn) << ' ' << z << '\n';
    }
  out << "v 0 0 0\nv 0 0 0.05\n";
  for (int i = 0; i < sides; ++i) {
    const int a = i + 1, b = (i + 1) % sides + 1, bottom = 2 * sides + 1, top = bottom + 1;
    out << "f " << a << ' ' << b << ' ' << b + sides << "\nf " << a << ' ' << b + sides << ' '
        << a + sides << '\n';
    out << "f " << b << ' ' << a << ' ' << bottom << "\nf " << a + sides << ' ' << b + sides << ' '
        << top << '\n';
  }
  return file;
}

/// The encoder's contribution to the noise.
double of_steps(const Fractions& with, const Fractions& without) {
  return std::sqrt(std::max(0.0, with.total * with.total - without.total * without.total));
}

TEST(ToolSlides, QuietlyOnAStylusWithAndWithoutEncoder) {
  for (const Ground& ground : grounds()) {
    EXPECT_LE(slide("sim-phantom", sim::sim_phantom(), ground, "shaping_filter", {}).total, 0.02);
    EXPECT_LE(slide("sim-phantom", sim::sim_phantom(), ground, "shaping_filter",
                    {.encoder = true, .friction = false})
                  .total,
              0.01);
  }
}

/// Of a damper of 125 Ns/m on steps of 0.02 mm. On a velocity of 50 Hz alone it would be 7.6, 7.7
/// and 17.6 %: a slower one takes its place within the speed that a step makes.
TEST(ToolSlides, QuietlyOnAnArmWithAndWithoutEncoder) {
  for (const Ground& ground : grounds()) {
    const bool cup = !ground.depth;
    const Fractions as_it_is = slide("sim-lwr", sim::sim_lwr(), ground, "shaping_filter", {}),
                    no_steps = slide("sim-lwr", sim::sim_lwr(), ground, "shaping_filter",
                                     {.encoder = true, .friction = false}),
                    no_friction = slide("sim-lwr", sim::sim_lwr(), ground, "shaping_filter",
                                        {.encoder = false, .friction = true});
    EXPECT_LE(as_it_is.total, cup ? 0.145 : 0.04);
    EXPECT_LE(no_friction.total, cup ? 0.145 : 0.04) << "nor does dry friction hide it";
    EXPECT_LE(no_steps.total, cup ? 0.135 : 0.003);
    EXPECT_LE(of_steps(as_it_is, no_steps), cup ? 0.06 : 0.04);
    EXPECT_LE(as_it_is.moved, cup ? 0.056 : 0.003);
    EXPECT_LE(as_it_is.encoder, 0.025);
    EXPECT_LE(as_it_is.rendered, 0.002);
  }
}

/// The remainder on the cup is the effect of its 64 sides on the arm: on a tube of 512 sides it is
/// a third. Voxels have no influence.
TEST(ToolSlides, ArmNoiseOnTheCupComesFromItsFacets) {
  const auto noise_of = [](int sides, double voxel_m, const LeftOut& skipped) {
    const TemporaryFolder folder;
    const Ground round{"tube.obj", grounds().back().motion, 4.5, {}};
    std::printf("%d sides, %g mm ", sides, 1e3 * voxel_m);
    return slide("sim-lwr", sim::sim_lwr(), round, tube(folder, sides), "shaping_filter", skipped,
                 voxel_m)
        .total;
  };
  const LeftOut no_steps{.encoder = true, .friction = false};
  const double cup = noise_of(64, 2e-3, no_steps), round = noise_of(512, 2e-3, no_steps),
               fine = noise_of(512, 5e-4, no_steps);
  EXPECT_LE(fine, 0.037);
  EXPECT_NEAR(round, fine, 1e-6);
  EXPECT_GE(cup, 3.0 * fine);
  EXPECT_LE(noise_of(512, 5e-4, {}), 0.067);
}

/// Its law damps a motion between hand and object, not the encoder's steps. Its oscillations along
/// the surface last longer, and only these remain.
TEST(ToolSlides, SpringDamperHidesTheArmsEncoder) {
  for (const Ground& ground : grounds()) {
    const Fractions as_it_is = slide("sim-lwr", sim::sim_lwr(), ground, "spring_damper", {}),
                    no_steps = slide("sim-lwr", sim::sim_lwr(), ground, "spring_damper",
                                     {.encoder = true, .friction = false});
    EXPECT_LE(of_steps(as_it_is, no_steps), 0.03);
    EXPECT_LE(as_it_is.total, 0.055);
    EXPECT_LE(no_steps.total, 0.05);
  }
}

}  // namespace
}  // namespace voxtouch::test
