// Implementation of the hooks in Library.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "devices/phantom/simulated/library.hpp"

namespace voxtouch::hd_sim {
namespace {

void copy(const Vec3& from, double* to) { std::copy_n(from.data(), 3, to); }

/// Ticks of a fault; negative is permanent.
long ticks_of(double amount) {
  if (!(std::abs(amount) <= 1e9))
    throw std::runtime_error("simulated Phantom: the amount of a fault must be a number of ticks");
  return amount < 0.0 ? -1 : std::lround(amount);
}

double in_range(double amount, double low, double high, const char* sentence) {
  if (!(amount >= low && amount <= high))
    throw std::runtime_error(sentence);
  return amount;
}

}  // namespace

void Library::set_motion(const Motion& motion) {
  const Lock lock(mutex_);
  Settings candidate = settings_;
  candidate.motion = motion;
  if (device_->ticks > 0) {
    device_->plant.follow(motion);
  } else {  // no time has passed: the arm can still be moved there
    device_->plant = PhantomPlant(candidate.plant, candidate.hand, motion, candidate.seed,
                                  candidate.hand_bandwidth_hz);
  }
  settings_ = candidate;
}

void Library::set_hand(const sim::OperatorConfig& hand) {
  const Lock lock(mutex_);
  device_->plant.set_hand(hand);
  settings_.hand = hand;
}

void Library::set_switches(const Switches& switches) {
  const Lock lock(mutex_);
  device_->switches = switches;
}

void Library::inject(int fault, double amount) {
  const Lock lock(mutex_);
  switch (fault) {
    case HDSIM_COMM_ERROR:
      device_->faults.communication = ticks_of(amount);
      return;
    case HDSIM_DEVICE_FAULT:
      device_->faults.device = ticks_of(amount);
      device_->amplifier.set_power(device_->faults.device == 0);
      return;
    case HDSIM_TIMER_ERROR:
      if (!running_)
        throw std::runtime_error(
            "simulated Phantom: no servo loop is running; start the scheduler first");
      dead_ = true;
      note(phantom::hd::kTimerError);
      return;
    case HDSIM_WARM_MOTORS:
      device_->amplifier.set_temperature(
          in_range(amount, 0.0, 10.0, "simulated Phantom: a temperature must be in [0, 10]"));
      return;
    case HDSIM_LATE_TICK:
      late_s_ =
          in_range(amount, 0.0, 10.0, "simulated Phantom: the delay of a tick must be 0 to 10 s");
      return;
    case HDSIM_SKIPPED_TICKS:
      skip_ticks_ = std::max(0L, ticks_of(amount));
      return;
    case HDSIM_FAIL_INIT:
      fail_init_ = static_cast<phantom::hd::HDerror>(
          in_range(amount, 1.0, 65535.0, "simulated Phantom: the amount must be an error code"));
      return;
    case HDSIM_FAIL_START:
      fail_start_ = true;
      return;
    case HDSIM_NAN_POSITION:
      device_->faults.lost_position = ticks_of(amount);
      return;
  }
  throw std::runtime_error("simulated Phantom: unknown fault");
}

void Library::read_state(hdsim_state& state) {
  const Lock lock(mutex_);
  const PhantomPlant& plant = device_->plant;
  state.time = plant.hand().time_s();
  copy(plant.tip(), state.tip);
  copy(plant.tip_velocity(), state.tip_velocity);
  copy(plant.joints(), state.joints);
  copy(plant.rates(), state.joint_rates);
  const Quat& q = plant.hand().orientation();
  state.orientation[0] = q.w();
  copy(q.vec(), state.orientation + 1);
  copy(plant.motor_torque(), state.motor_torque);
  copy(plant.motor_force(), state.motor_force);
  copy(plant.hand_force(), state.hand_force);
  copy(plant.hand().target(), state.hand_target);
  copy(device_->amplifier.temperature(), state.temperature);
  state.energy = plant.energy();
  state.ticks = device_->ticks;
  state.ticks_without_callbacks = ticks_without_callbacks_;
  state.non_finite_sets = device_->non_finite_sets;
  state.errors_waiting = static_cast<std::uint32_t>(errors_.size());
  state.callbacks = static_cast<std::uint32_t>(callbacks_.size());
  state.held = plant.hand().holds();
  state.scheduler_running = serves();
  state.virtual_time = settings_.virtual_time;
  state.device_open = open_;
}

}  // namespace voxtouch::hd_sim
