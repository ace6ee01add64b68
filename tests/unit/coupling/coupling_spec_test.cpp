#include "core/coupling/coupling_spec.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "core/coupling/running_coupling.hpp"

namespace voxtouch::coupling {
namespace coupling_spec_test {

constexpr double kT = 1e-3;
const double kNan = std::numeric_limits<double>::quiet_NaN(),
             kInf = std::numeric_limits<double>::infinity();

/// The field that the one refusal names, or "" / "many".
std::string refused(const CouplingSpec& spec, const CouplingLimits& limits = {}, double t = kT) {
  std::string field;
  for (const CouplingIssue& issue : validate(spec, limits, t)) {
    if (!issue.refuse)
      continue;
    if (!field.empty())
      return "many";
    field = issue.field;
    EXPECT_NE(issue.sentence.find(issue.field), std::string::npos);
    EXPECT_EQ(issue.sentence.back(), '.');
    EXPECT_THROW(RunningCoupling(spec, limits, t), std::invalid_argument);
  }
  return field;
}

CouplingSpec with(double CouplingSpec::*member, double value, const char* kind = "shaping_filter") {
  CouplingSpec spec;
  spec.cutoff_hz = 20, spec.kind = kind, spec.*member = value;
  return spec;
}

TEST(CouplingSpec, NamesTheWrongField) {
  for (const double bad : {kNan, kInf, -1.0, 0.0}) {
    EXPECT_EQ(refused(with(&CouplingSpec::cutoff_hz, bad)), "cutoff_hz");
    EXPECT_EQ(refused(with(&CouplingSpec::damping_ratio, bad)), "damping_ratio");
    EXPECT_EQ(refused(with(&CouplingSpec::stiffness_n_per_m, bad, "spring_damper")),
              "stiffness_n_per_m");
    EXPECT_EQ(refused(with(&CouplingSpec::gain, 1), {}, bad), "sample_time_s");
  }
  for (const double bad : {kNan, kInf, -1.0}) {
    EXPECT_EQ(refused(with(&CouplingSpec::gain, bad)), "gain");
    EXPECT_EQ(refused(with(&CouplingSpec::damping_ns_per_m, bad, "spring_damper")),
              "damping_ns_per_m");
  }
  EXPECT_EQ(refused(with(&CouplingSpec::gain, 0.0)), "");
  EXPECT_EQ(refused(with(&CouplingSpec::damping_ns_per_m, 0.0, "spring_damper")), "");
  EXPECT_EQ(refused(with(&CouplingSpec::gain, 1), {kNan, 1}), "max_force_n");
  EXPECT_EQ(refused(with(&CouplingSpec::gain, 1), {1, -1}), "max_torque_nm");
  EXPECT_EQ(refused(with(&CouplingSpec::gain, 1, "spring")), "kind");
}

TEST(CouplingSpec, NamesTheFieldsCommonToAllKinds) {
  for (const char* kind : {"shaping_filter", "spring_damper", "direct"}) {
    for (const double bad : {kNan, -1.0, 0.0}) {
      EXPECT_EQ(refused(with(&CouplingSpec::stiffness_cap_n_per_m, bad, kind)),
                "stiffness_cap_n_per_m");
      EXPECT_EQ(refused(with(&CouplingSpec::stiffness_cap_nm_per_rad, bad, kind)),
                "stiffness_cap_nm_per_rad");
      EXPECT_EQ(refused(with(&CouplingSpec::velocity_filter_hz, bad, kind)), "velocity_filter_hz");
    }
    CouplingSpec window = with(&CouplingSpec::velocity_filter_hz, 100.0, kind);
    window.velocity_window = kMaxVelocityWindow;
    EXPECT_EQ(refused(window), "");
    ++window.velocity_window;
    EXPECT_EQ(refused(window), "velocity_window");
    EXPECT_EQ(refused(with(&CouplingSpec::stiffness_cap_n_per_m, kInf, kind)), "");
    EXPECT_EQ(refused(with(&CouplingSpec::velocity_filter_hz, kInf, kind)), "velocity_filter_hz");
    for (const double bad : {kNan, kInf, -1.0}) {
      EXPECT_EQ(refused(with(&CouplingSpec::injected_damping_ns_per_m, bad, kind)),
                "injected_damping_ns_per_m");
      EXPECT_EQ(refused(with(&CouplingSpec::injected_damping_nms_per_rad, bad, kind)),
                "injected_damping_nms_per_rad");
      EXPECT_EQ(refused(with(&CouplingSpec::slow_velocity_hz, bad, kind)), "slow_velocity_hz");
      EXPECT_EQ(refused(with(&CouplingSpec::velocity_band_m_per_s, bad, kind)),
                "velocity_band_m_per_s");
    }
  }
}

TEST(CouplingSpec, IgnoresTheParametersOfOtherKinds) {
  EXPECT_EQ(refused(with(&CouplingSpec::cutoff_hz, kNan, "spring_damper")), "");
  EXPECT_EQ(refused(with(&CouplingSpec::cutoff_hz, kNan, "direct")), "");
  EXPECT_EQ(refused(with(&CouplingSpec::stiffness_n_per_m, -1)), "");
}

TEST(CouplingSpec, RefusesACutoffBeyondTheSampleRateAndWarnsBefore) {
  EXPECT_EQ(refused(with(&CouplingSpec::cutoff_hz, 500)), "cutoff_hz");
  EXPECT_EQ(refused(with(&CouplingSpec::cutoff_hz, 499)), "");
  EXPECT_EQ(refused(with(&CouplingSpec::cutoff_hz, 250), {}, 2e-3), "cutoff_hz")
      << "the same filter at half the rate";
  const auto warnings = validate(with(&CouplingSpec::cutoff_hz, 100), {}, kT);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_FALSE(warnings[0].refuse);
  EXPECT_TRUE(validate(with(&CouplingSpec::cutoff_hz, 95), {}, kT).empty());
  EXPECT_NO_THROW(RunningCoupling(with(&CouplingSpec::cutoff_hz, 100), {}, kT))
      << "a warning refuses nothing";
}

TEST(CouplingSpec, CutoffIsTheNaturalFrequencyOverTwoPi) {
  CouplingSpec spec = with(&CouplingSpec::cutoff_hz, 5);
  spec.damping_ratio = 1;
  EXPECT_DOUBLE_EQ(cutoff_rad_per_s(spec), 10 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(lag_s(spec), 0.2 / std::numbers::pi);
  spec.kind = "direct";
  EXPECT_EQ(lag_s(spec), 0.0);
}

TEST(CouplingSpec, ReturnsTheDisplayedStiffness) {
  EXPECT_DOUBLE_EQ(displayed_stiffness_n_per_m(with(&CouplingSpec::gain, 0.5), 800), 400);
  EXPECT_DOUBLE_EQ(displayed_stiffness_n_per_m(
                       with(&CouplingSpec::stiffness_n_per_m, 500, "spring_damper"), 500),
                   250);
  EXPECT_DOUBLE_EQ(displayed_stiffness_n_per_m(with(&CouplingSpec::gain, 0.5, "direct"), 800), 800);
  CouplingSpec capped = with(&CouplingSpec::gain, 0.5);
  capped.stiffness_cap_n_per_m = 500;
  EXPECT_DOUBLE_EQ(displayed_stiffness_n_per_m(capped, 1e5), 250)
      << "10^4 points show what the cap lets through";
  EXPECT_DOUBLE_EQ(displayed_stiffness_n_per_m(capped, 100), 50);
  capped.kind = "spring_damper", capped.stiffness_n_per_m = 500;
  EXPECT_DOUBLE_EQ(displayed_stiffness_n_per_m(capped, 1e5), 250);
  EXPECT_TRUE(std::isnan(displayed_stiffness_n_per_m(capped, kNan)))
      << "what is no stiffness stays none";
}

TEST(CouplingSpec, NamesOfKindsReadBack) {
  for (const auto kind :
       {CouplingKind::kDirect, CouplingKind::kShapingFilter, CouplingKind::kSpringDamper}) {
    CouplingKind back{};
    EXPECT_TRUE(parse_coupling(name_of(kind), back));
    EXPECT_EQ(back, kind);
  }
  CouplingKind kind = CouplingKind::kSpringDamper;
  EXPECT_FALSE(parse_coupling("Direct", kind));
  EXPECT_FALSE(parse_coupling("", kind));
  EXPECT_EQ(kind, CouplingKind::kSpringDamper);
}

TEST(CouplingSpec, RefusesAnInvalidRamp) {
  for (const double bad : {-1.0, kNan, kInf})
    EXPECT_THROW(RunningCoupling({}, {}, kT, bad), std::invalid_argument);
  EXPECT_NO_THROW(RunningCoupling({}, {}, kT, 0.0));
}

}  // namespace coupling_spec_test
}  // namespace voxtouch::coupling
