#pragma once
/// Arm, drives and operator of a simulated controller: the parts independent of its protocol.
#include <array>
#include <cstddef>
#include <cstdint>

#include "devices/arm/simulated/arm_plant.hpp"
#include "devices/arm/simulated/control_laws.hpp"
#include "devices/arm/simulated/faults.hpp"

namespace voxtouch::arm_sim {

inline constexpr double kTick = 1e-3;  ///< [s] the controller's fine cycle
inline constexpr int kSubsteps = 4;    ///< torque loop and mechanics in one tick
inline constexpr double kSubstep = kTick / kSubsteps;

struct ArmConfig {
  static constexpr int kMaxDelayTicks = 100;
  PlantParameters plant;
  arm::Joints start_rad = arm::Joints::Zero();
  LawParameters laws;
  /// Of commanded torques, in addition to the waiting period of a command; assumed.
  int torque_delay_ticks = 1;
  double torque_lag_s = 0.003;         ///< their first-order lag by the torque loop; assumed
  double angle_resolution_rad = 2e-5;  ///< of the measured angles; assumed
  /// The hand grips the tool, and its clock starts, with the first motion.
  bool hand_waits = true;
  std::uint64_t seed = 0;

  /// Throws std::runtime_error that names field and rule.
  void validate() const;
};

/// Throws std::runtime_error, "simulated controller: FIELD must be RULE", unless `good`.
void require(bool good, const char* field, const char* rule);

/// Time is a count of ticks: equal seeds and calls give bit-identical results. Real-time safe after
/// construction.
class SimulatedArm {
 public:
  const ArmPlant& plant() const noexcept { return plant_; }
  const FaultSchedule& faults() const noexcept { return faults_; }
  /// False: the mechanics are not finite, and the simulation must end.
  bool finite() const noexcept { return plant_.q().allFinite() && plant_.rate().allFinite(); }

 protected:
  /// Throws std::runtime_error for a configuration, hand or motion that cannot be simulated.
  SimulatedArm(const ArmConfig& config, hand::Hand hand, FaultSchedule faults);
  ~SimulatedArm() = default;

  /// The joint angles as measured by their sensors.
  arm::Joints measured_rad() const noexcept;
  /// Discards all commanded torques, in transit and acting.
  void drop_torque() noexcept;
  /// Advances one millisecond. `commanded` enters the delay line; its output is followed with the
  /// lag while `in_motion`. The drives give `law(torque)` in addition to gravity, with the delayed
  /// torque; nothing while `braked`.
  template <class Law>
  void tick(const arm::Joints& commanded, bool in_motion, bool braked, Law&& law) noexcept {
    line_[next_] = commanded;
    const arm::Joints delayed = line_[(next_ + line_.size() - delay_) % line_.size()];
    next_ = (next_ + 1) % line_.size();
    for (int i = 0; i < kSubsteps; ++i) {
      if (in_motion)
        torque_ += follow_ * (delayed - torque_);
      drive_ = braked ? arm::Joints(arm::Joints::Zero()) : arm::Joints(law(torque_));
      const hand::HandAction hand = hand_holds_ ? hand_.step() : hand::HandAction{};
      plant_.step(drive_, braked ? Drives::kBraked : Drives::kTorque, hand, kSubstep);
    }
  }

  ArmPlant plant_;
  hand::Hand hand_;
  FaultSchedule faults_;
  bool hand_holds_;
  arm::Joints torque_ = arm::Joints::Zero();  ///< commanded, as it acts on the joints
  arm::Joints drive_ = arm::Joints::Zero();   ///< in addition to gravity, in the last substep

 private:
  double angle_resolution_rad_, follow_;
  std::array<arm::Joints, ArmConfig::kMaxDelayTicks + 1> line_;  ///< torques in transit
  std::size_t delay_, next_ = 0;
};

}  // namespace voxtouch::arm_sim
