#pragma once
/// Arm, drives and operator of a simulated controller: what does not depend on the protocol in
/// front of it.
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
  int torque_delay_ticks =
      1;  ///< of commanded torques in addition to the period that a command waits; assumed
  double torque_lag_s = 0.003;         ///< first-order lag of them, by the torque loop; assumed
  double angle_resolution_rad = 2e-5;  ///< of the measured angles; assumed
  bool hand_waits = true;  ///< the hand takes the tool, and its clock starts, with the first motion
  std::uint64_t seed = 0;

  /// Throws std::runtime_error that names field and rule.
  void validate() const;
};

/// Throws std::runtime_error, "simulated controller: FIELD has to be RULE", unless `good`.
void require(bool good, const char* field, const char* rule);

/// Time is a count of ticks: the same seed and calls give bit-identical results. Real-time safe
/// after construction.
class SimulatedArm {
 public:
  const ArmPlant& plant() const noexcept { return plant_; }
  const FaultSchedule& faults() const noexcept { return faults_; }
  /// False: the arm's mechanics have left the numbers, and the simulation is of no more use.
  bool finite() const noexcept { return plant_.q().allFinite() && plant_.rate().allFinite(); }

 protected:
  /// Throws std::runtime_error where the configuration, the hand or the motion cannot be simulated.
  SimulatedArm(const ArmConfig& config, hand::Hand hand, FaultSchedule faults);
  ~SimulatedArm() = default;

  /// The joints' angles as their sensors report them.
  arm::Joints measured_rad() const noexcept;
  /// No commanded torque is on its way any more, or acts.
  void drop_torque() noexcept;
  /// One millisecond: `commanded` goes into the delay line, and what comes out of it is followed
  /// with the lag while `in_motion`. The drives give `law(torque)` beyond gravity, with the torque
  /// that has come through; nothing while `braked`.
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
  arm::Joints torque_ = arm::Joints::Zero();  ///< commanded, as the joints feel it
  arm::Joints drive_ = arm::Joints::Zero();   ///< beyond gravity, in the last substep

 private:
  double angle_resolution_rad_, follow_;
  std::array<arm::Joints, ArmConfig::kMaxDelayTicks + 1> line_;  ///< torques on their way
  std::size_t delay_, next_ = 0;
};

}  // namespace voxtouch::arm_sim
