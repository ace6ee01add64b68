#include "core/coupling/design/sampled_loop.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <stdexcept>

#include "core/coupling/pt2.hpp"
#include "tests/unit/coupling_design/support.hpp"

namespace voxtouch {
namespace {

using testing::controller_of;
using testing::loop_cases;
using testing::plant_of;
using Law = LoopController::Law;

/// A row's number has the digits printed: half a unit of the last of `digits`.
double half_digit(double value, int digits) {
  return 0.5000001 * std::pow(10.0, std::floor(std::log10(std::abs(value))) - digits + 1);
}

TEST(SampledLoop, RadiusEqualsTheReference) {
  double worst = 0.0;
  int rows = 0;
  for (const auto& c : loop_cases()) {
    const double radius = spectral_radius(plant_of(c), controller_of(c), c["k"]), expected = c["spectral_radius"];
    EXPECT_NEAR(radius, expected, 1e-11) << c["note"] << " k " << c["k"];
    EXPECT_EQ(radius < 1.0, c["stable"].get<bool>()) << c["note"] << " k " << c["k"];
    worst = std::max(worst, std::abs(radius - expected));
    ++rows;
  }
  EXPECT_EQ(rows, 20);
  RecordProperty("worst_radius_error", std::to_string(worst));
  std::printf("worst |radius - reference| of %d rows: %.3g\n", rows, worst);
}

TEST(SampledLoop, LimitsEqualTheReferenceToTheDigitsGiven) {
  double worst = 0.0, worst_frequency = 0.0, worst_routh = 0.0;
  for (const auto& c : loop_cases()) {
    SCOPED_TRACE(c["note"].get<std::string>());
    const CriticalStiffness found = critical_stiffness(plant_of(c), controller_of(c));
    const double k = c["k_crit"], omega = c["omega_crit"];
    EXPECT_NEAR(found.stiffness, k, half_digit(k, 9));
    EXPECT_NEAR(found.frequency_rad_per_s, omega, half_digit(omega, 6));
    worst = std::max(worst, std::abs(found.stiffness / k - 1.0));
    worst_frequency = std::max(worst_frequency, std::abs(found.frequency_rad_per_s / omega - 1.0));
    if (c["routh_no_delay_k"].is_null()) continue;
    const double routh = c["routh_no_delay_k"];
    EXPECT_NEAR(routh_stiffness(plant_of(c), controller_of(c)), routh, half_digit(routh, 9));
    worst_routh = std::max(worst_routh, std::abs(routh_stiffness(plant_of(c), controller_of(c)) / routh - 1.0));
  }
  RecordProperty("worst_critical_stiffness_error", std::to_string(worst));
  std::printf("worst relative difference: k_crit %.2g, omega_crit %.2g, Routh %.2g\n", worst, worst_frequency, worst_routh);
}

}  // namespace
}  // namespace voxtouch
