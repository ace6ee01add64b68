#pragma once
/// Common parts of the loop's tests: the reference's rows and random loops.
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

#include "core/coupling/design/sampled_loop.hpp"

namespace voxtouch::testing {

/// tests/data/vectors/loop_cases.json: 20 loops with eigenvalues in 50 digits and the stiffness
/// limits of an independent program.
inline nlohmann::json loop_cases() {
  std::ifstream in(VOXTOUCH_TEST_DATA "/vectors/loop_cases.json");
  if (!in)
    throw std::runtime_error("no loop_cases.json");
  return nlohmann::json::parse(in)["cases"];
}

inline coupling::design::LoopPlant plant_of(const nlohmann::json& c) {
  return {.mass = c["m"],
          .damping = c["b"],
          .hand_mass = c["m_h"],
          .hand_damping = c["b_h"],
          .hand_stiffness = c["k_h"],
          .period_s = c["T"],
          .delay_s = c["delay"],
          .effort_lag_s = c["force_lag"]};
}

inline coupling::design::LoopController controller_of(const nlohmann::json& c) {
  return {.w0_rad_per_s = c["w0"],
          .damping_ratio = c["d"],
          .gain = c["K"],
          .injected_damping = c["B_inj"],
          .velocity_filter_rad_per_s = c["w_v"]};
}

/// Random numbers with bits independent of the standard library's distributions.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  double log(double low, double high) { return low * std::pow(high / low, uniform(0.0, 1.0)); }
  int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }
  bool chance(double p) { return uniform(0.0, 1.0) < p; }

 private:
  std::mt19937_64 engine_;
};

/// Devices from a small stylus to a heavy arm, with any hand or released, with delay and lag.
inline coupling::design::LoopPlant random_plant(Random& random, bool released) {
  coupling::design::LoopPlant p;
  p.mass = random.log(0.03, 24.0);
  p.damping = random.log(0.003, 60.0);
  p.period_s = random.log(0.25e-3, 4e-3);
  const double delay = random.uniform(0.0, 4.0);
  p.delay_s = p.period_s * (random.chance(0.5) ? std::round(delay) : delay);
  p.effort_lag_s = random.chance(0.5) ? 0.0 : random.uniform(0.0, 5e-3);
  if (released)
    return p;
  p.hand_mass = random.log(0.02, 2.0);
  p.hand_damping = random.log(0.05, 30.0);
  p.hand_stiffness = random.log(20.0, 800.0);
  return p;
}

inline coupling::design::LoopController random_filter(Random& random) {
  constexpr double kRatios[] = {0.2, 0.577, 0.707, 0.866, 1.0, 2.0};
  coupling::design::LoopController c;
  c.w0_rad_per_s = 2.0 * std::numbers::pi * random.log(1.0, 200.0);
  c.damping_ratio = kRatios[random.below(6)];
  return c;
}

}  // namespace voxtouch::testing
