#pragma once
/// Options for opening the light-weight robot.
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

#include "devices/arm/posture_torque.hpp"
#include "devices/lwr/fri_composer.hpp"
#include "devices/lwr/fri_session.hpp"

namespace voxtouch::lwr {

struct LwrOptions {
  std::string address = "0.0.0.0";         ///< of the receiving interface; 0.0.0.0: all
  std::uint16_t port = fri::kDefaultPort;  ///< UDP; the one in the KRL program's friSetup
  /// The only IPv4 address to accept; empty: the sender of the first measurement.
  std::string controller;
  double connect_timeout_s = 10.0;  ///< for the first measurement
  double silence_s = 1.0;           ///< without a measurement for this long the controller is lost
  double max_age_s = 0.02;          ///< a measurement that waited longer in the kernel is outdated
  /// Longest time until the next measurement of a controller in virtual time.
  double virtual_timeout_s = 10.0;
  double stop_timeout_s = 0.5;  ///< for leaving command mode at the end
  Pose pose_FT;                 ///< the tool T in the flange F
  Pose pose_BD;                 ///< frame D in the robot's base B (z up, along axis 1)
  fri::SessionRules session;
  fri::ComposerRules composer;  ///< the driver sets the step limit
  arm::PostureRules posture{.posture = lwr_rest_posture()};
  double rate_cutoff_hz = 50.0;  ///< low-pass of the joint rates for the twist
  /// Torque in addition to the arm's own, for each joint: the limits minus the torque that holds
  /// the arm, and at most the $stiffness limits (100 and 30 Nm) of KRL programs in use.
  LwrJoints max_add_torque_nm = (LwrJoints() << 100, 100, 80, 80, 80, 24, 24).finished();
  std::string capture_file;  ///< pcap of the last packets, written at the end; empty: no capture
  std::size_t capture_packets = 20000;
  const std::atomic<bool>* cancelled = nullptr;  ///< DeviceOptions::cancelled
};

}  // namespace voxtouch::lwr
