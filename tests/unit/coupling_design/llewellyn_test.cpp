#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <complex>
#include <vector>

#include "core/coupling/design/certificates.hpp"
#include "core/coupling/design/sampled_loop.hpp"
#include "core/coupling/design/sampled_plant.hpp"
#include "tests/unit/coupling_design/support.hpp"

namespace voxtouch::coupling::design {
namespace {

using testing::Random;
using Polynomial = std::vector<double>;  ///< coefficients from z^0 up
constexpr double kPeriod = 1e-3;

Polynomial product(const Polynomial& a, const Polynomial& b) {
  Polynomial c(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j)
      c[i + j] += a[i] * b[j];
  return c;
}

Polynomial sum(Polynomial a, const Polynomial& b) {
  a.resize(std::max(a.size(), b.size()), 0.0);
  for (std::size_t i = 0; i < b.size(); ++i)
    a[i] += b[i];
  return a;
}

double largest_root(Polynomial p) {
  while (p.size() > 1 && std::abs(p.back()) < 1e-14)
    p.pop_back();
  const auto n = static_cast<Eigen::Index>(p.size()) - 1;
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(n, n);
  companion.diagonal(-1).setOnes();
  for (Eigen::Index i = 0; i < n; ++i)
    companion(i, n - 1) = -p[i] / p.back();
  return Eigen::EigenSolver<Eigen::MatrixXd>(companion, false).eigenvalues().cwiseAbs().maxCoeff();
}

struct Coupling {
  double c, r;
};
/// A passive world behind the massless object, in backward differences as the coupling itself:
/// spring, damper, mass.
struct World {
  double spring, damper, mass;
};

/// Largest modulus of device + hand, coupling and world, from transfer functions: independent of
/// the loop's matrix.
double radius(const LoopPlant& p, const Coupling& coupling, const World& world, int delay) {
  const SampledPlant s = sample_plant(p.mass + p.hand_mass, p.damping + p.hand_damping,
                                      p.hand_stiffness, kPeriod, 0.0, 0.0);
  const auto& e = s.step_less_one;
  // G = effort_unit ((q - e11) g0 + e01 g1) / ((q - e00)(q - e11) - e01 e10), q = z - 1.
  const Polynomial numerator = {
      s.effort_unit * ((-1.0 - e(1, 1)) * s.newer[0] + e(0, 1) * s.newer[1]),
      s.effort_unit * s.newer[0]};
  const Polynomial denominator =
      sum(product({-1.0 - e(0, 0), 1.0}, {-1.0 - e(1, 1), 1.0}), {-e(0, 1) * e(1, 0)});
  // Times z^2 each: Z = c + r (z-1)/(T z), W = k + damper (z-1)/(T z) + mass ((z-1)/(T z))^2.
  const Polynomial z =
      product({-coupling.r / kPeriod, coupling.c + coupling.r / kPeriod}, {0.0, 1.0});
  const double m = world.mass / (kPeriod * kPeriod), b = world.damper / kPeriod;
  const Polynomial w = {m, -2.0 * m - b, world.spring + b + m};
  // 1 + z^-n G Z W/(Z + W) = 0 with everything over z^2.
  Polynomial shift(static_cast<std::size_t>(delay) + 1, 0.0);
  shift.back() = 1.0;
  return largest_root(sum(product(product(shift, denominator), product(sum(z, w), {0.0, 0.0, 1.0})),
                          product(numerator, product(z, w))));
}

TEST(Llewellyn, IsTheMaximumOverAllFrequencies) {
  Random random(4);
  for (int i = 0; i < 300; ++i) {
    const double c = random.log(10.0, 1e4), r = random.chance(0.1) ? 0.0 : random.log(1e-3, 1e2),
                 a = 0.5 * c * kPeriod;
    const int n = random.below(12);
    double dense = 0.0;
    for (int j = 1; j <= 100'000; ++j) {
      const double half = 0.5 * std::numbers::pi * j / 100'000, s = std::sin(half),
                   u = std::sin((n + 1) * half) / s;
      dense =
          std::max(dense, u * u * ((r + a) * (r + a) * s * s + a * a * (1.0 - s * s)) / (r + a));
    }
    const double found = llewellyn_damping(c, r, kPeriod, n);
    ASSERT_GE(found, dense * (1.0 - 1e-12)) << c << " " << r << " " << n;
    ASSERT_LE(found, dense * (1.0 + 1e-7)) << c << " " << r << " " << n;
  }
}

TEST(Llewellyn, IsColgateWithoutDelay) {
  for (const double r : {0.0, 0.3, 7.0})
    EXPECT_NEAR(llewellyn_damping(1000.0, r, kPeriod, 0), r + 0.5, 1e-12);
  EXPECT_EQ(llewellyn_damping(0.0, 0.0, kPeriod, 2), 0.0);
  EXPECT_NEAR(llewellyn_damping(0.0, 2.0, kPeriod, 3), 2.0, 1e-12)
      << "a damper alone, late: as much again";
}

TEST(Llewellyn, OptimumHasThePublishedStiffnessAndUsesAllDamping) {
  const double stiffness[] = {2.0, .770, .483, .355, .281, .233},
               damping[] = {0.0, .279, .378, .427, .460, .488};
  for (int n = 0; n < 6; ++n) {
    const double b = 0.5;
    const SpringDamperPair best = llewellyn_optimum(b, kPeriod, n);
    EXPECT_NEAR(best.stiffness * kPeriod / b, stiffness[n], 0.0006) << n;
    EXPECT_NEAR(best.damping / b, damping[n], 0.006)
        << n << ": the published pairs come from a grid";
    EXPECT_NEAR(llewellyn_damping(best.stiffness, best.damping, kPeriod, n), b, 1e-9 * b) << n;
    for (double r = 0.0; r < 2.0 * b; r += 0.01 * b)
      EXPECT_GE(llewellyn_damping(best.stiffness, r, kPeriod, n), b * (1.0 - 1e-9))
          << "a better pair: n " << n << " r " << r;
    std::printf("n %d: c T/b %.4f, r/b %.4f\n", n, best.stiffness * kPeriod / b, best.damping / b);
  }
  EXPECT_NEAR(llewellyn_optimum(0.5, kPeriod, 1).stiffness, 385.0, 1.0);
  EXPECT_NEAR(llewellyn_optimum(30.0, kPeriod, 5).stiffness, 6990.0, 10.0);
  EXPECT_EQ(llewellyn_optimum(0.0, kPeriod, 2).stiffness, 0.0);
}

TEST(Llewellyn, RadiusOfTheTestAgreesWithTheLoopsOwn) {
  const LoopPlant p{.mass = 0.3,
                    .damping = 0.8,
                    .hand_stiffness = 500.0,
                    .period_s = kPeriod,
                    .delay_s = 2 * kPeriod};
  const LoopController c{
      .law = LoopController::Law::kSpringDamper, .stiffness = 700.0, .damping = 0.4};
  EXPECT_NEAR(radius(p, {700.0, 0.4}, {300.0, 0.0, 0.0}, 2), spectral_radius(p, c, 300.0), 1e-9);
}

/// A lossless hand that, with the device, resonates at the angle [rad per sample], and a lossless
/// world.
struct Pair {
  LoopPlant plant;
  World world{};
  Pair(Random& random, double b, double angle) {
    plant.mass = random.log(0.03, 3.0);
    plant.damping = b;
    plant.period_s = kPeriod;
    plant.hand_stiffness = plant.mass * std::pow(angle / kPeriod, 2);
    if (random.chance(0.5)) {
      world.spring = random.log(1.0, 1e6);
    } else {
      world.mass = random.log(1e-5, 1e2);
    }
  }
};

TEST(Llewellyn, BoundsEveryPassivePairAndIsTight) {
  const std::uint64_t seed = 20260102;
  Random random(seed);
  int violations = 0, sets_with_unstable = 0, pairs = 0;
  constexpr int kSets = 24, kPairs = 1500;
  for (int set = 0; set < kSets; ++set) {
    const Coupling coupling{random.log(50.0, 5e3), random.log(0.01, 20.0)};
    const int n = random.below(5);
    const double need = llewellyn_damping(coupling.c, coupling.r, kPeriod, n);
    bool unstable = false;
    for (int i = 0; i < kPairs; ++i, ++pairs) {
      const Pair pair(random, 1.001 * need, random.log(1e-3, 3.0));
      violations += radius(pair.plant, coupling, pair.world, n) > 1.0 + 1e-9;
      if (unstable)
        continue;
      Pair weaker = pair;
      weaker.plant.damping = need / 1.3;
      unstable = radius(weaker.plant, coupling, weaker.world, n) > 1.0 + 1e-9;
    }
    sets_with_unstable += unstable;
  }
  std::printf(
      "%d pairs: %d unstable with the damping needed; with 1/1.3 of it %d of %d couplings had an "
      "unstable one\n",
      pairs, violations, sets_with_unstable, kSets);
  EXPECT_EQ(violations, 0) << "seed " << seed;
  EXPECT_GE(sets_with_unstable, kSets * 3 / 4) << "seed " << seed;
}

}  // namespace
}  // namespace voxtouch::coupling::design
