#include "core/coupling/design/sampled_loop.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <vector>

#include "core/coupling/design/sampled_plant.hpp"
#include "tests/support/coupling_models/pt2.hpp"
#include "tests/unit/coupling_design/routh.hpp"
#include "tests/unit/coupling_design/support.hpp"

namespace voxtouch::coupling::design {
namespace sampled_loop_test {

using testing::controller_of;
using testing::loop_cases;
using testing::plant_of;
using Law = LoopController::Law;

TEST(SampledLoop, RadiusEqualsTheReference) {
  double worst = 0.0;
  int rows = 0;
  for (const auto& c : loop_cases()) {
    const double radius = spectral_radius(plant_of(c), controller_of(c), c["k"]),
                 expected = c["spectral_radius"];
    EXPECT_NEAR(radius, expected, 1e-12) << c["note"] << " k " << c["k"];
    EXPECT_EQ(radius < 1.0, c["stable"].get<bool>()) << c["note"] << " k " << c["k"];
    worst = std::max(worst, std::abs(radius - expected));
    ++rows;
  }
  EXPECT_EQ(rows, 20);
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", worst);
  RecordProperty("worst_radius_error", text);
  std::printf("worst |radius - reference| of %d rows: %s\n", rows, text);
}

/// The plant alone, under a command that changes every period: X after `steps` samples.
Eigen::Vector3d run(const SampledPlant& plant, const std::vector<double>& command) {
  Eigen::Vector3d x(1e-3, 0.0, 0.0);
  const auto sent = [&](int n) { return n < 0 ? 0.0 : command[n] * plant.effort_unit; };
  for (int n = 0; n < static_cast<int>(command.size()); ++n) {
    const int last = n - plant.whole_delay;
    x += (plant.step_less_one * x + plant.newer * sent(last) + plant.older * sent(last - 1)).eval();
  }
  return x;
}

TEST(SampledPlant, FractionalDelayIsAWholeDelayOfShorterPeriods) {
  testing::Random random(11);
  for (const double lag : {0.0, 3e-3, 1e-6}) {
    for (const double stiffness : {0.0, 0.5, 900.0, 1e6}) {
      std::vector<double> slow(40), fast;
      for (double& u : slow)
        u = random.uniform(-1.0, 1.0);
      for (const double u : slow)
        fast.insert(fast.end(), 10, u);
      const auto a = run(sample_plant(0.2, 1.5, stiffness, 1e-3, 2.3e-3, lag), slow);
      const auto b = run(sample_plant(0.2, 1.5, stiffness, 1e-4, 23e-4, lag), fast);
      EXPECT_NEAR(a[0], b[0], 1e-12 * std::abs(b[0]) + 1e-15) << lag << " " << stiffness;
      EXPECT_NEAR(a[1], 10.0 * b[1], 1e-9 * std::abs(b[1]) + 1e-14) << lag << " " << stiffness;
    }
  }
}

TEST(SampledPlant, VanishingDelayEqualsNone) {
  const auto none = sample_plant(0.2, 1.5, 30.0, 1e-3, 2.3e-3, 0.0);
  for (const double lag : {1e-300, 1e-13, 1e-11}) {
    const auto little = sample_plant(0.2, 1.5, 30.0, 1e-3, 2.3e-3, lag);
    EXPECT_NEAR(little.newer[0], none.newer[0], 2.0 * lag / 1e-3 + 1e-15) << lag;
    EXPECT_NEAR(little.older[1], none.older[1], 2.0 * lag / 1e-3 + 1e-15) << lag;
  }
}

TEST(SampledPlant, FreeMassUnderAHeldForceIsKnownInClosedForm) {
  const double m = 0.075, period = 1e-3;
  const SampledPlant p = sample_plant(m, 0.0, 0.0, period, 0.25e-3, 0.0);
  EXPECT_NEAR(p.newer[0], 0.5 * 0.75 * 0.75,
              1e-16);  // x = t^2/2 over the 3/4 of the period that have the new force
  EXPECT_NEAR(p.newer[1], 0.75, 1e-16);
  EXPECT_NEAR(p.older[0], 0.5 - 0.5 * 0.75 * 0.75, 1e-16);
  EXPECT_NEAR(p.older[1], 0.25, 1e-16);
  EXPECT_DOUBLE_EQ(p.effort_unit, period * period / m);
  EXPECT_EQ(p.step_less_one(0, 0), 0.0) << "a released position keeps itself exactly";
  EXPECT_EQ(p.step_less_one(1, 1), 0.0);
}

/// Growth per sample of a simulated oscillation: from the peaks of two windows.
template <class Law>
double growth(const LoopPlant& p, double k, Law&& effort_of) {
  const SampledPlant plant = sample_plant(p.mass + p.hand_mass, p.damping + p.hand_damping,
                                          p.hand_stiffness, p.period_s, p.delay_s, p.effort_lag_s);
  constexpr int kSteps = 60'000, kWindow = 20'000;
  std::vector<double> sent(static_cast<std::size_t>(plant.whole_delay) + 2, 0.0);
  Eigen::Vector3d x(1e-3, 0.0, 0.0);
  double early = 0.0, late = 0.0;
  int early_at = 0, late_at = 0;
  for (int n = 0; n < kSteps; ++n) {
    sent.pop_back();
    sent.insert(sent.begin(), -effort_of(k * x[0]) * plant.effort_unit);
    x += (plant.step_less_one * x + plant.newer * sent[plant.whole_delay] +
          plant.older * sent[plant.whole_delay + 1])
             .eval();
    if (n >= kSteps - 2 * kWindow && n < kSteps - kWindow && std::abs(x[0]) > early)
      early = std::abs(x[0]), early_at = n;
    if (n >= kSteps - kWindow && std::abs(x[0]) > late)
      late = std::abs(x[0]), late_at = n;
  }
  return std::exp(std::log(late / early) / (late_at - early_at));
}

TEST(SampledLoop, RadiusIsTheGrowthOfALoopWithTheRingsOwnFilter) {
  for (const auto& c : loop_cases()) {
    if (c["B_inj"] != 0.0)
      continue;
    const LoopPlant p = plant_of(c);
    for (const double fraction :
         {0.98, 1.02}) {  // near the limit one slow oscillation outlives the rest
      const double k = fraction * c["k_crit"].get<double>();
      coupling_models::Pt2 filter(c["w0"], c["d"], c["K"]);
      const double grown = growth(p, k, [&](double f) { return filter.step(f, p.period_s); });
      EXPECT_NEAR(grown, spectral_radius(p, controller_of(c), k), 3e-7)
          << c["note"] << " share " << fraction;
    }
  }
}

TEST(SampledLoop, RadiusIsTheGrowthOfALoopWithASpringDamper) {
  const LoopPlant p{
      .mass = 0.1, .damping = 0.05, .hand_stiffness = 300.0, .period_s = 1e-3, .delay_s = 1.4e-3};
  for (const double r : {0.0, 0.5, 5.0}) {
    const LoopController c{.law = Law::kSpringDamper, .stiffness = 700.0, .damping = r};
    const double k = 2000.0, damper = r / p.period_s;
    double object = 0.0;
    const double grown = growth(p, k, [&](double f) {
      object = (f + damper * object) / (k + c.stiffness + damper);
      return f - k * object;
    });
    EXPECT_NEAR(grown, spectral_radius(p, c, k), 3e-6) << r;
  }
}

TEST(SampledLoop, InjectedDampingMatchesTheClosedForm) {
  // A free mass with one sample's difference fed back at once: the velocity decreases by the
  // fraction B T/m per sample, the position stays. m v+ = m v - B (x - x_prev)/T has the
  // characteristic z^2 - (1 - c/2) z + c/2 over z - 1, c = B T/m.
  const LoopPlant p{.mass = 0.1, .period_s = 1e-3};
  const LoopController c{.law = Law::kDirect, .gain = 1.0, .injected_damping = 20.0};
  EXPECT_DOUBLE_EQ(spectral_radius(p, c, 0.0), 1.0);       // the position
  EXPECT_NEAR(inner_limit(p, 0.0).damping, 200.0, 1e-10);  // c = 2
  LoopController over = c;
  over.injected_damping = 201.0;
  EXPECT_NEAR(spectral_radius(p, over, 0.0), std::sqrt(0.5 * 201.0 * 1e-3 / 0.1), 1e-12);
}

TEST(SampledLoop, ReleasedDeviceWithoutContactKeepsItsPlaceExactly) {
  const LoopController filter{.w0_rad_per_s = 31.4, .damping_ratio = 1.0};
  for (const double b : {0.0, 0.005, 30.0}) {
    const LoopPlant p{
        .mass = 0.075, .damping = b, .period_s = 1e-3, .delay_s = 2.3e-3, .effort_lag_s = 1e-3};
    EXPECT_EQ(spectral_radius(p, filter, 0.0), 1.0) << b;
    LoopController none = filter;
    none.gain = 0.0;
    EXPECT_EQ(spectral_radius(p, none, 1000.0), 1.0) << b;
    EXPECT_EQ(critical_stiffness(p, none).stiffness, 0.0) << b;
  }
}

TEST(SampledLoop, SoftContactMovesTheEigenvalueOffOne) {
  const LoopPlant p{.mass = 0.075, .damping = 0.05, .period_s = 1e-3, .delay_s = 1e-3};
  for (const double k : {1e-3, 1e-5, 1e-7}) {
    const double radius = spectral_radius(p, {.w0_rad_per_s = 31.4, .damping_ratio = 1.0}, k);
    EXPECT_NEAR((1.0 - radius) / (k * p.period_s / p.damping), 1.0, 0.05 + 1e-15 / (k * p.period_s))
        << k;
  }
}

TEST(SampledLoop, SlowFiltersLoseNoDigits) {
  // With a millionth of a radian a sample the hold and the delay are nothing: the continuous limit
  // is exact.
  const LoopPlant p{.mass = 2.0, .damping = 1e-3, .period_s = 1e-3, .delay_s = 1e-3};
  const LoopController c{.w0_rad_per_s = 1e-3, .damping_ratio = 0.8};
  const double limit = critical_stiffness(p, c).stiffness;
  EXPECT_NEAR(limit / test::routh_stiffness(p, c), 1.0, 1e-5);
  EXPECT_LT(spectral_radius(p, c, 0.9 * limit), 1.0);
  EXPECT_GT(spectral_radius(p, c, 1.1 * limit), 1.0);
}

TEST(SampledLoop, RefusesUnrepresentableNumbers) {
  EXPECT_THROW(spectral_radius({.mass = 1e-300}, {.law = Law::kDirect}, 1e300),
               std::invalid_argument);
}

}  // namespace sampled_loop_test
}  // namespace voxtouch::coupling::design
