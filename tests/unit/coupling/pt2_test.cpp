#include "tests/support/coupling_models/pt2.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

namespace voxtouch::coupling {
namespace {

nlohmann::json read(const char* name) {
  std::ifstream in(std::string(VOXTOUCH_TEST_DATA "/vectors/") + name);
  EXPECT_TRUE(in) << name;
  return nlohmann::json::parse(in);
}

/// Steps a case in the reference is followed for; VOXTOUCH_PT2_STEPS=1000000000 follows all of them
/// to the end (minutes).
std::int64_t step_limit() {
  const char* text = std::getenv("VOXTOUCH_PT2_STEPS");
  return text ? std::strtoll(text, nullptr, 10) : 1'000'000;
}

/// The tolerance that the reference recommends for this realisation.
double tolerance(double d) { return d <= 1e-9 ? 1e-10 : 1e-12; }

TEST(Pt2, StepResponsesEqualTheReference) {
  const auto reference = read("pt2_reference.json");
  const std::int64_t limit = step_limit();
  double worst = 0;
  int cases = 0;
  for (const auto& c : reference["cases"]) {
    const double w0 = c["w0"], d = c["d"], gain = c["K"], period = c["T"];
    const auto& plain = c["plain"];
    coupling_models::Pt2 filter(w0, d, gain);
    std::int64_t n = -1;
    double y = 0;
    for (std::size_t i = 0; i < plain["step_n"].size(); ++i) {
      const std::int64_t until = plain["step_n"][i];
      if (until > limit)
        continue;
      for (; n < until; ++n)
        y = filter.step(1.0, period);
      const double error = std::abs(y - plain["step_y"][i].get<double>()) / std::abs(gain);
      EXPECT_LE(error, tolerance(d)) << c["note"] << " w0 T " << w0 * period << " n " << until;
      if (d > 1e-9)
        worst = std::max(worst, error);
    }
    ++cases;
  }
  EXPECT_EQ(cases, 37);
  RecordProperty("worst_error", std::to_string(worst));
  std::printf("worst |y - ref|/|K| with d > 1e-9: %.3g, up to n = %lld\n", worst,
              static_cast<long long>(limit));
}

TEST(Pt2, ChangingPeriodsEqualTheReference) {
  const auto reference = read("pt2_reference.json");
  int rows = 0;
  for (const auto& c : reference["variable_T"]) {
    coupling_models::Pt2 filter(c["w0"], c["d"], c["K"]);
    for (std::size_t i = 0; i < c["T"].size(); ++i, ++rows)
      EXPECT_NEAR(filter.step(c["u"][i], c["T"][i]), c["y"][i].get<double>(), 1e-12)
          << "w0 " << c["w0"] << " row " << i;
  }
  EXPECT_EQ(rows, 3 * 64);
}

TEST(Pt2, StepsAndImpulsesOfTheOtherTableAgree) {
  int rows = 0;
  for (const auto& c : read("pt2.json")) {
    const double w0 = 2 * std::numbers::pi * c["f0_Hz"].get<double>();
    coupling_models::Pt2 step(w0, c["zeta"], c["K"]), impulse(w0, c["zeta"], c["K"]);
    std::int64_t n = -1;
    double ys = 0, yi = 0;
    for (std::size_t i = 0; i < c["samples"].size(); ++i, ++rows) {
      for (; n < c["samples"][i].get<std::int64_t>(); ++n) {
        ys = step.step(1.0, c["TA"]);
        yi = impulse.step(n < 0 ? 1.0 : 0.0, c["TA"]);
      }
      EXPECT_NEAR(ys, c["step"][i].get<double>(), 1e-11);
      EXPECT_NEAR(yi, c["impulse"][i].get<double>(), 1e-11);
    }
  }
  EXPECT_GT(rows, 20);
}

TEST(Pt2, FrequencyResponseEqualsTheReference) {
  const auto reference = read("pt2_reference.json");
  int checked = 0;
  for (const auto& c : reference["cases"]) {
    const double w0 = c["w0"], d = c["d"], period = c["T"], gain = c["K"];
    if (w0 * period < 0.01 || d * w0 * period < 0.003 || d > 10)
      continue;  // settles within the steps below
    for (const auto& row : c["plain"]["freq_theta_abs_arg"]) {
      const double theta = row[0], magnitude = row[1], phase = row[2];
      if (theta < 0.01)
        continue;
      coupling_models::Pt2 filter(w0, d, gain);
      const int settle = 30'000, window = 1000;
      double worst = 0;
      for (int n = 0; n < settle + window; ++n) {
        const double y = filter.step(std::cos(theta * n), period);
        if (n >= settle)
          worst = std::max(worst, std::abs(y - magnitude * std::cos(theta * n + phase)));
      }
      EXPECT_LE(worst, 1e-10 * std::abs(gain)) << c["note"] << " theta " << theta;
      ++checked;
    }
  }
  EXPECT_GT(checked, 50);
}

TEST(Pt2, DcGainIsExact) {
  for (const double gain : {1.0, 0.3, 2.0, -2.0}) {
    coupling_models::Pt2 filter(2 * std::numbers::pi * 5, 1.0, gain);
    double y = 0;
    for (int n = 0; n < 200'000; ++n)
      y = filter.step(3.7, 1e-3);
    EXPECT_NEAR(y, gain * 3.7, 4e-15 * std::abs(gain * 3.7));
  }
}

/// w0 T from 1e-9 to beyond the Nyquist frequency, d over fifteen decades: bounded and never NaN.
TEST(Pt2, ExtremeParametersStayBounded) {
  for (const double angle : {1e-9, 1e-6, 1e-3, 0.5, 3.0, 3.15, 100.0, 1e6, 1e12})
    for (const double d : {1e-9, 1e-3, 0.7, 1.0, 1e3, 1e6})
      for (const double gain : {0.0, 1.0, -2.0, 1e3}) {
        coupling_models::Pt2 filter(angle / 1e-3, d, gain);
        double peak = 0;
        for (int n = 0; n < 5000; ++n) {
          const double y = filter.step(1.0, 1e-3);
          ASSERT_TRUE(std::isfinite(y)) << angle << " " << d;
          peak = std::max(peak, std::abs(y));
        }
        EXPECT_LE(peak, 2 * std::abs(gain) * (1 + 1e-9)) << angle << " " << d;
      }
}

TEST(Pt2, RefusesInvalidParameters) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               inf = std::numeric_limits<double>::infinity();
  coupling_models::Pt2 filter(100, 1, 1);
  for (int n = 0; n < 10; ++n)
    filter.step(1, 1e-3);
  coupling_models::Pt2 untouched = filter;
  for (const double bad : {nan, inf, -inf, 0.0, -1.0}) {
    EXPECT_FALSE(filter.design(bad, 1, 1));
    EXPECT_FALSE(filter.design(100, bad, 1));
  }
  for (const double bad : {nan, inf})
    EXPECT_FALSE(filter.design(100, 1, bad));
  EXPECT_TRUE(filter.design(100, 1, 1));
  EXPECT_EQ(filter.step(1, 1e-3), untouched.step(1, 1e-3));
}

TEST(Pt2, ResetContinuesWithoutAJump) {
  for (const double gain : {1.0, 0.25, -3.0, 0.0}) {
    coupling_models::Pt2 filter(200, 0.7, gain);
    for (int n = 0; n < 50; ++n)
      filter.step(5, 1e-3);
    filter.reset(1.5);
    if (gain == 0.0) {
      EXPECT_LT(std::abs(filter.step(9.0, 1e-3) - 1.5), 0.05);
    } else {
      for (int n = 0; n < 100; ++n)
        EXPECT_NEAR(filter.step(1.5 / gain, 1e-3), 1.5, 1e-12);
    }
  }
}

/// (y - K u)^2 + v^2 never grows while the input rests, whatever the parameters do; so no step is
/// larger than w0 T times its root.
TEST(Pt2, ParametersMayChangeAtEverySample) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> u(0, 1);
  for (int run = 0; run < 20; ++run) {
    coupling_models::Pt2 filter(300, 0.3, 1.0);
    double y = 0, energy = 1.0, largest = 0;
    for (int n = 0; n < 20'000; ++n) {
      const double w0 = 2 * std::numbers::pi * std::pow(10.0, 3.5 * u(random)),
                   d = std::pow(10.0, 3 * u(random) - 2);
      const double period = u(random) < 0.5 ? 2e-4 : 5e-3;
      ASSERT_TRUE(filter.design(w0, d, 1.0));
      // The first step sees the input's jump from 0 to 1.
      const double before = n == 0 ? 1.0 : energy, y_before = y;
      y = filter.step(1.0, period);
      energy = (y - 1) * (y - 1) + filter.state().v * filter.state().v;
      ASSERT_LE(energy, before * (1 + 1e-12) + 4e-16 * std::sqrt(before) + 1e-30);
      ASSERT_LE(std::abs(y - y_before), w0 * period * std::sqrt(before) * (1 + 1e-9) + 1e-14);
      largest = std::max(largest, std::abs(y));
    }
    EXPECT_LE(largest, 2.0);
  }
}

TEST(Pt2, SteadyErrorDoesNotGrowWithTheSteps) {
  coupling_models::Pt2 filter(31.41592653589793, 1.0, 1.0);
  double worst = 0;
  for (std::int64_t n = 0; n < std::max<std::int64_t>(step_limit(), 20'000'000); ++n) {
    const double y = filter.step(1.0, 1e-3);
    if (n > 2000)
      worst = std::max(worst, std::abs(y - 1));
  }
  EXPECT_LE(worst, 1e-14);
}

/// A minute after release the state is exactly zero, and a step has its usual cost.
TEST(Pt2, ReleasesToExactlyZeroAndNeverComputesWithDenormals) {
  for (const double gain : {1.0, 0.01, 1000.0}) {
    coupling_models::Pt2 filter(31.41592653589793, 1.0, gain);
    for (int n = 0; n < 1000; ++n)
      filter.step(4.0, 1e-3);
    for (int n = 0; n < 60'000; ++n) {
      const double y = filter.step(0.0, 1e-3);
      ASSERT_TRUE(y == 0.0 || std::abs(y) > std::numeric_limits<double>::min());
      ASSERT_TRUE(filter.state().v == 0.0 || std::abs(filter.state().v) > 1e-300);
    }
    EXPECT_EQ(filter.step(0.0, 1e-3), 0.0);
    EXPECT_EQ(filter.state().v, 0.0);
  }
}

}  // namespace
}  // namespace voxtouch::coupling
