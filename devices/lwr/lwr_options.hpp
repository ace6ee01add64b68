#pragma once
/// What opening the light-weight robot needs to know.
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

#include "devices/arm/posture_torque.hpp"
#include "devices/lwr/fri_composer.hpp"
#include "devices/lwr/fri_session.hpp"

namespace voxtouch::lwr {

struct LwrOptions {
  std::string address = "0.0.0.0";         ///< of the interface to receive on; 0.0.0.0: all
  std::uint16_t port = fri::kDefaultPort;  ///< UDP; the one in the KRL program's friSetup
  std::string controller;  ///< the only IPv4 address to listen to; empty: whoever sends the first
                           ///< measurement
  double connect_timeout_s = 10.0;  ///< for the first measurement
  double silence_s = 1.0;           ///< without a measurement for this long the controller has gone
  double max_age_s = 0.02;          ///< a measurement that lay in the kernel for longer is no news
  double virtual_timeout_s =
      10.0;  ///< how long a controller in virtual time may take for its next measurement
  double stop_timeout_s = 0.5;  ///< for leaving command mode at the end
  Pose pose_FT;                 ///< the tool T in the flange F
  Pose pose_BD;                 ///< frame D in the robot's base B (z up, along axis 1)
  fri::SessionRules session;
  fri::ComposerRules composer;  ///< the step limit is set by the driver
  arm::PostureRules posture{.posture = lwr_rest_posture()};
  double rate_cutoff_hz = 50.0;  ///< low-pass of the joint rates, which the twist is made of
  /// Torque on top of the arm's own, joint by joint: the limits less what holds the arm up, and no
  /// more than the $stiffness limits (100 and 30 Nm) that KRL programs in use set.
  LwrJoints max_add_torque_nm = (LwrJoints() << 100, 100, 80, 80, 80, 24, 24).finished();
  std::string capture_file;  ///< pcap of the last packets, written at the end; empty: none
  std::size_t capture_packets = 20000;
  const std::atomic<bool>* cancelled = nullptr;  ///< DeviceOptions::cancelled
};

}  // namespace voxtouch::lwr
