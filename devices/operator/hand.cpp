#include "devices/operator/hand.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace voxtouch::hand {
namespace {

struct NamedGrip {
  std::string_view name;
  sim::OperatorConfig config;
};

constexpr sim::OperatorConfig holding(double mass_kg, double damping_ns_per_m,
                                      double stiffness_n_per_m, double inertia_kg_m2,
                                      double damping_nms_per_rad, double stiffness_nm_per_rad) {
  return {.mass_kg = mass_kg,
          .damping_ns_per_m = damping_ns_per_m,
          .stiffness_n_per_m = stiffness_n_per_m,
          .inertia_kg_m2 = inertia_kg_m2,
          .damping_nms_per_rad = damping_nms_per_rad,
          .stiffness_nm_per_rad = stiffness_nm_per_rad,
          .carries_tool = true};
}

// Only "arm-measured" is one published subject (0.554 kg, 6.45 Ns/m, 135 N/m). The rest are middles
// and corners of published or remembered ranges: fingertip 3.5..8.7 g, 4..7.4 Ns/m, 255..1255 N/m;
// pen 0.05..0.2 kg, 2..6 Ns/m, 200..1000 N/m; arm 0.5..2 kg, 10..50 Ns/m, 50..800 N/m. Their
// rotation is assumed.
constexpr std::array kGrips{
    NamedGrip{"fingertip", holding(0.006, 5.7, 750.0, 1e-5, 0.002, 0.1)},
    NamedGrip{"pen", holding(0.1, 4.0, 300.0, 1e-4, 0.01, 0.5)},
    NamedGrip{"pen-light", holding(0.05, 2.0, 200.0, 1e-4, 0.005, 0.2)},
    NamedGrip{"pen-firm", holding(0.05, 2.0, 1000.0, 1e-4, 0.01,
                                  1.0)},  // light, stiff, hardly damped: the hardest to keep stable
    NamedGrip{"arm", holding(1.3, 15.0, 200.0, 0.01, 0.3, 5.0)},
    NamedGrip{"arm-light", holding(0.5, 10.0, 50.0, 0.005, 0.1, 2.0)},
    NamedGrip{"arm-firm", holding(2.0, 50.0, 800.0, 0.02, 1.0, 20.0)},
    NamedGrip{"arm-measured", holding(0.554, 6.45, 135.0, 0.005, 0.2, 3.0)},
    NamedGrip{"released", {.released = true}},
};

double checked_step(double step_s, double bandwidth_hz) {
  if (!(step_s > 0.0 && step_s <= 0.01))
    throw std::runtime_error("simulated hand: the step must be in (0, 0.01] s");
  if (!(bandwidth_hz > 0.0))
    throw std::runtime_error("simulated hand: the bandwidth must be > 0 Hz (infinity: unlimited)");
  return step_s;
}

}  // namespace

const sim::OperatorConfig& checked_grip(const sim::OperatorConfig& grip) {
  grip.validate();
  return grip;
}

Motion checked_motion(Motion motion) {
  const auto finite = [](const Vec3& point) { return point.allFinite(); };
  if (motion.path.empty() || !std::all_of(motion.path.begin(), motion.path.end(), finite))
    throw std::runtime_error("simulated hand: the motion needs at least one way point, all finite");
  if (!(motion.speed_m_per_s > 0.0 && std::isfinite(motion.speed_m_per_s)))
    throw std::runtime_error("simulated hand: the motion's speed must be > 0 and finite");
  if (!(motion.hold_s >= 0.0 && std::isfinite(motion.hold_s)))
    throw std::runtime_error("simulated hand: the motion's hold must be >= 0 and finite");
  if (motion.repeat_from && *motion.repeat_from >= motion.path.size())
    throw std::runtime_error(
        "simulated hand: the motion repeats from a way point that does not exist");
  if (motion.circle_centre &&
      !(motion.circle_centre->allFinite() && std::abs(motion.circle_axis.norm() - 1.0) < 1e-6))
    throw std::runtime_error(
        "simulated hand: the motion's circle needs a finite centre and an axis of norm 1");
  if (const MotionRotation& t = motion.turn;
      !(std::isfinite(t.angle_rad) && std::isfinite(t.from_s) && t.to_s > t.from_s &&
        std::abs(t.axis.norm() - 1.0) < 1e-6))
    throw std::runtime_error(
        "simulated hand: the motion's rotation needs a finite angle, an end after its start and an "
        "axis of norm 1");
  if (!normalise_within(motion.orientation, 1e-3, 1e3))
    throw std::runtime_error("simulated hand: the motion's orientation is not a rotation");
  return motion;
}

std::optional<sim::OperatorConfig> grip(std::string_view name) {
  const auto found = std::find_if(kGrips.begin(), kGrips.end(),
                                  [name](const NamedGrip& g) { return g.name == name; });
  if (found == kGrips.end())
    return std::nullopt;
  return found->config;
}

const std::vector<std::string_view>& grip_names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const NamedGrip& g : kGrips)
      all.push_back(g.name);
    return all;
  }();
  return names;
}

Hand::Hand(const sim::OperatorConfig& config, Motion motion, double step_s, std::uint64_t seed,
           const ToolDrag& drag, double bandwidth_hz)
    : config_(checked_grip(config)),
      motion_(checked_motion(std::move(motion))),
      step_s_(checked_step(step_s, bandwidth_hz)),
      drag_(drag),
      seed_(seed),
      tremor_(config.tremor_n, config.tremor_bandwidth_hz, step_s, seed),
      first_(motion_at(motion_, 0.0).position),
      second_(first_),
      orientation_(orientation_at(motion_, 0.0).orientation) {
  if (!std::isfinite(bandwidth_hz))
    return;
  // Two equal lags are down by 3 dB where each is down by 1.5 dB: at sqrt(sqrt(2) - 1) of the
  // corner of each.
  rate_ = 2.0 * std::numbers::pi * bandwidth_hz / std::sqrt(std::numbers::sqrt2 - 1.0);
  const double half = 0.5 * rate_ * step_s;
  gain_ =
      2.0 * half / (1.0 + half);  // trapezoidal rule, input held at its middle: no library function
  gain_ = std::min(gain_, 1.0);   // over 1 a lag would swing
}

HandAction Hand::step() noexcept {
  const double now_s = time_s();
  const bool held = holds();
  HandAction action;
  const double middle_s = now_s - motion_start_s_ + 0.5 * step_s_;
  action.target = lead(motion_at(motion_, middle_s), orientation_at(motion_, middle_s).orientation);
  action.target_orientation = orientation_;
  const Vec3 tremor = tremor_.next();  // also for an open hand, so that the random sequence does
                                       // not depend on the grip
  ++steps_;
  if (!held)
    return action;
  const double factor = now_s >= config_.grip_change_time_s ? config_.grip_factor : 1.0;
  action.mass_kg = config_.mass_kg;
  action.damping_ns_per_m = factor * config_.damping_ns_per_m;
  action.stiffness_n_per_m = factor * config_.stiffness_n_per_m;
  action.inertia_kg_m2 = config_.inertia_kg_m2;
  action.damping_nms_per_rad = factor * config_.damping_nms_per_rad;
  action.stiffness_nm_per_rad = factor * config_.stiffness_nm_per_rad;
  action.steady_force = tremor;
  if (config_.carries_tool) {
    // Friction is full above 1 mm/s and proportional below, so the force has no step when the
    // target starts to move.
    const double fraction =
        drag_.coulomb_friction_n / std::max(action.target.velocity.norm(), 1e-3);
    action.steady_force += (drag_.damping_ns_per_m + fraction) * action.target.velocity;
  }
  return action;
}

/// Advances the lags by one step. Returns the target in the middle of the step.
MotionPoint Hand::lead(const MotionPoint& requested, const Quat& goal) noexcept {
  const double sign = orientation_.dot(goal) < 0.0 ? -1.0 : 1.0;
  orientation_.coeffs() += gain_ * (sign * goal.coeffs() - orientation_.coeffs());
  orientation_.normalize();
  if (rate_ == 0.0)
    return first_ = second_ = requested.position, requested;
  const Vec3 first_before = first_, second_before = second_;
  first_ += gain_ * (requested.position - first_);
  second_ += gain_ * (0.5 * (first_before + first_) - second_);
  return {0.5 * (second_before + second_), (second_ - second_before) / step_s_};
}

void Hand::grip_as(const sim::OperatorConfig& config) {
  config_ = checked_grip(config);
  tremor_ = sim::Tremor(config.tremor_n, config.tremor_bandwidth_hz, step_s_, seed_);
}

void Hand::follow(Motion motion) {
  motion_ = checked_motion(std::move(motion));
  motion_start_s_ = time_s();
}

}  // namespace voxtouch::hand
