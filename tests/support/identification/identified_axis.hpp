#pragma once
/// One axis of a device that is not the model of the fit: presliding, Stribeck, force lag, a
/// structural
/// mode, a jittering clock, lost samples and commands.
#include <cstdint>
#include <deque>
#include <optional>
#include <random>

namespace voxtouch::testing {

struct AxisTruth {
  double mass_kg = 1.0, viscous_ns_per_m = 0.0, coulomb_n = 0.1, bias_n = 0.0;
  double delay_s = 1e-3;  ///< transport
  double lag_s = 0.0;     ///< time constant of the force
  double presliding_m = 20e-6;
  double stribeck = 0.0;         ///< 0.5: half more friction at rest
  double stribeck_speed = 5e-3;  ///< [m/s]
  double encoder_step_m = 1e-5;
  double rate_hz = 1000.0, jitter = 0.2, loss = 0.01;
  double mode_hz = 0.0, mode_damping = 0.03, mode_mass_ratio = 0.3;  ///< 0 Hz: rigid
  bool encoder_at_far_mass = false;
  double max_force_n = 10.0;
  double mean_delay_s() const { return delay_s + lag_s; }
};

enum class AxisFault : std::uint8_t {
  kNone,
  kWrongSign,
  kRunaway,
  kStuck,
  kClockStops,
  kNotFinite,
  kForceTenfold,
  kEncoderFrozen,
  kEncoderScale
};

/// A hand at the tool: a mass that moves with it, coupled by spring and damper to a slow sine.
struct AxisHand {
  double mass_kg = 0.0, damping_ns_per_m = 0.0, stiffness_n_per_m = 0.0;
  double amplitude_m = 0.0, frequency_hz = 0.5, phase = 0.0;
  double tremor_n = 0.0, tremor_hz = 9.0;
};

struct AxisSample {
  double time_s = 0.0, position_m = 0.0;
};

class IdentifiedAxis {
 public:
  IdentifiedAxis(const AxisTruth& truth, std::uint64_t seed);
  void fail(AxisFault fault, double at_s) {
    fault_ = fault;
    fault_s_ = at_s;
  }
  void hold(const AxisHand& hand) { hand_ = hand; }

  /// Moves to the next sample that is not lost.
  AxisSample next();
  /// The reply to it; may be lost.
  void command(double force_n);

  double time() const { return time_; }
  double position() const { return x_[0]; }
  double velocity() const { return v_[0]; }
  double energy_given() const { return energy_; }  ///< work of the motor [J]
  bool applies_force() const { return applied_ != 0.0; }

 private:
  void move(double until);
  double friction(double velocity, double dx);
  double hand_force() const;
  double uniform() { return std::uniform_real_distribution<double>(0.0, 1.0)(random_); }

  AxisTruth truth_;
  AxisHand hand_;
  std::mt19937_64 random_;
  struct Arrival {
    double time_s, force_n;
  };
  std::deque<Arrival> arrivals_;
  double time_ = 0.0, applied_ = 0.0, lagged_ = 0.0, bristle_ = 0.0, energy_ = 0.0;
  double x_[2] = {0.0, 0.0}, v_[2] = {0.0, 0.0};
  double offset_;
  AxisFault fault_ = AxisFault::kNone;
  double fault_s_ = 0.0, frozen_time_ = 0.0;
  std::optional<double> frozen_;
};

}  // namespace voxtouch::testing
