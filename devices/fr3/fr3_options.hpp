#pragma once
/// Options for opening the Franka arm.
#include <atomic>
#include <cstdint>
#include <string>

#include "devices/arm/posture_torque.hpp"
#include "devices/fr3/fci_session.hpp"
#include "devices/fr3/fr3_arm.hpp"

namespace voxtouch::fr3 {

struct Fr3Options {
  std::string address = "172.16.0.2";  ///< of the robot; the one in the manufacturer's manual
  std::uint16_t port = fci::kCommandPort;
  /// For the connection, and again for its first reply and the first state.
  double connect_timeout_s = 3.0;
  double silence_s = 1.0;       ///< without a state for this long the robot is lost
  double max_age_s = 0.02;      ///< a state that waited longer in the kernel is outdated
  double stop_timeout_s = 0.5;  ///< for leaving torque control at the end
  Pose pose_FT;                 ///< the tool T in the flange F
  Pose pose_BD;                 ///< frame D in the robot's base B (z up, along axis 1)
  fci::SessionRules session;
  fci::CollisionBehavior collision;
  fci::Load load;  ///< load in addition to that of the robot's web page; 0 kg: not sent
  arm::PostureRules posture{.posture = fr3_rest_posture()};
  double step_nm = 0.95;  ///< Largest change of a joint torque between two commands; the robot
                          ///< allows 1 (1000 Nm/s).
  /// For each joint: the limits (87 and 12 Nm) minus the torque that holds the arm.
  Joints max_add_torque_nm = (Joints() << 60, 45, 60, 45, 10, 10, 10).finished();
  bool virtual_time = false;        ///< a simulated robot that waits for the reply to each state
  double virtual_timeout_s = 10.0;  ///< longest time until the next state
  const std::atomic<bool>* cancelled = nullptr;  ///< DeviceOptions::cancelled
};

}  // namespace voxtouch::fr3
