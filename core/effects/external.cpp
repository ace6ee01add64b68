// A wrench from outside the ring: the sensor of a remote robot, a simulator, a custom effect.
#include <algorithm>
#include <array>
#include <optional>

#include "core/effects/effect.hpp"
#include "core/effects/ros_topic.hpp"
#include "core/types/clamp.hpp"
#include "core/types/rotation_vector.hpp"

namespace voxtouch::effects {
namespace {

enum : std::size_t {
  kTopic,
  kMaxForce,
  kMaxTorque,
  kTimeout,
  kFade,
  kSlew,
  kTorqueSlew,
  kEnergy,
  kPower
};

constexpr std::array kParameters = {
    row::text("topic", kRosTopicPattern,
              "Absolute topic of a geometry_msgs/WrenchStamped. Frame: world or <rig>/device; "
              "torque about the tool's origin. Default: /<rig>/external."),
    row::number("max_force_n", 0.0, 100.0, "Largest force [N]. A larger one is scaled down."),
    row::number("max_torque_nm", 0.0, 10.0, 0.0,
                "Largest torque [Nm]; needs a device that gives torque."),
    row::number("timeout_s", 0.002, 1.0, 0.05,
                "Time without a new value after which it fades, counted in samples [s]."),
    row::number("fade_s", 0.02, 1.0, 0.05, "Duration of the fade to zero [s]."),
    row::number("slew_n_per_s", 0.1, 10000.0, 50.0, "Largest rate of change of the force [N/s]."),
    row::number("slew_nm_per_s", 0.01, 1000.0, 2.0, "Largest rate of change of the torque [Nm/s]."),
    row::number("energy_j", 0.001, 1.0, 0.05,
                "Energy that it may give to the hand at once [J]. When it is used up the force "
                "falls to zero."),
    row::number("power_w", 0.0, 1.0, 0.05,
                "Power that it may give for longer [W], plus the power that the hand puts in."),
};

/// Moves `now` towards `goal` by at most `most`.
void step_towards(Vec3& now, const Vec3& goal, double most) noexcept {
  Vec3 step = goal - now;
  clamp_length(step, most);
  now += step;
}

/// Energy budget for a source that may react to the pose, after two-layer teleoperation (Franken et
/// al. 2011). Real-time safe.
/// The source may give at most the energy in the store, which is limited to `most_j`. The store is
/// refilled at `refill_w` and by energy from the operator. In any time t the operator thus receives
/// at most most_j + refill_w t. Energies are those of forces in W along paths in W [J].
class EnergyBudget {
 public:
  /// `energy_generated_j`: energy of the source since the last call; negative: taken. `most_j` > 0.
  void book(double energy_generated_j, double most_j, double refill_w, double dt_s) noexcept {
    if (!begun_)
      level_j_ = most_j, begun_ = true;
    level_j_ = std::min(most_j, level_j_ - energy_generated_j + refill_w * dt_s);
  }
  /// Fraction of its force that the source may exert. It is 1 down to half of the store and then
  /// falls to 0. No period takes more than the remaining energy while its path is shorter than
  /// most_j / (2 force).
  double fraction(double most_j) const noexcept {
    if (!begun_)
      return 1.0;
    return std::clamp(level_j_ / (kFullAbove * most_j), 0.0, 1.0);
  }

 private:
  static constexpr double kFullAbove = 0.5;
  double level_j_ = 0.0;
  bool begun_ = false;
};

class External final : public Effect {
 public:
  void apply(const EffectFrame& frame, const EffectValues& values,
             EffectForce& sum) noexcept override {
    sum.energy_generated_j += book(frame, values);
    follow(frame, values);
    const double fraction = budget_.fraction(values.number(kEnergy));
    const Wrench out{fraction * filtered_.force, fraction * filtered_.torque};
    sum.wrench.force += out.force, sum.wrench.torque += out.torque;
    given_ = {frame.fraction * out.force, frame.fraction * out.torque};
  }
  /// Keeps the budget: leaving and entering a region gives no new one.
  void reset() noexcept override {
    filtered_ = given_ = {};
    last_.reset(), taken_s_.reset();
  }

 private:
  /// Charges the work of the last force along the path to the budget. Returns the part of the force
  /// alone: the observer has no allowance for torque.
  double book(const EffectFrame& frame, const EffectValues& values) noexcept {
    const Pose before = last_.value_or(frame.tool);
    last_ = frame.tool;
    const double translation_j = given_.force.dot(frame.tool.position - before.position);
    const double rotation_j =
        given_.torque.dot(rotation_vector(before.orientation, frame.tool.orientation));
    budget_.book(translation_j + rotation_j, values.number(kEnergy), values.number(kPower),
                 frame.dt_s);
    return translation_j;
  }

  void follow(const EffectFrame& frame, const EffectValues& values) noexcept {
    if (const ExternalWrench* newest = frame.external;
        newest && newest->taken_s != taken_s_ && newest->wrench.finite())
      requested_ = newest->wrench, taken_s_ = newest->taken_s;
    const double age_s = taken_s_ ? frame.time_s - *taken_s_ : -1.0;
    const bool fresh = age_s >= 0.0 && age_s <= values.number(kTimeout);
    Wrench goal = fresh ? requested_ : Wrench{};
    const double max_force = values.number(kMaxForce), max_torque = values.number(kMaxTorque);
    clamp_wrench(goal, max_force, max_torque);
    const auto rate = [&](double slew, double most) {
      return (fresh ? slew : std::max(slew, most / values.number(kFade))) * frame.dt_s;
    };
    step_towards(filtered_.force, goal.force, rate(values.number(kSlew), max_force));
    step_towards(filtered_.torque, goal.torque, rate(values.number(kTorqueSlew), max_torque));
    clamp_wrench(filtered_, max_force, max_torque);  // limits may be ramping down
  }

  Wrench requested_, filtered_, given_;
  std::optional<double> taken_s_;  ///< time of the request
  std::optional<Pose> last_;
  EnergyBudget budget_;
};

EffectNeeds needs(const EffectValues& values) {
  return {.torque = values.number(kMaxTorque) > 0.0,
          .orientation = values.number(kMaxTorque) > 0.0,
          .external = true};
}

EffectBound bound(const EffectValues& values) {
  const double force = values.number(kMaxForce);
  return {
      .force_n = force, .external_force_n = force, .external_torque_nm = values.number(kMaxTorque)};
}

}  // namespace

extern const EffectKind kExternal = {
    .name = "external",
    .summary =
        "Displays a wrench from a program outside the ring. Force, slew rate and energy are "
        "bounded, and it fades when it is late.",
    .equations =
        "F follows the newest value, clamped to max_force_n, at slew_n_per_s; without a value for "
        "timeout_s it fades to zero within fade_s. F is scaled by min(1, 2 E / energy_j) with the "
        "energy tank dE = -F . dx - T . dphi + power_w dt, E <= energy_j: in a time t the hand "
        "receives at most energy_j + power_w t (Franken et al. 2011). The passivity observer "
        "allows the energy of F, but none of the torque. Not conservative and not certified: its "
        "writer may react to the pose.",
    .energy = EnergyBehaviour::kBounded,
    .alone = true,
    .parameters = kParameters,
    .needs = needs,
    .bound = bound,
    .check_text = fault_of_ros_topic,
    .make = [] { return std::unique_ptr<Effect>(std::make_unique<External>()); },
    .expected_ns = 40.0,
};

}  // namespace voxtouch::effects
