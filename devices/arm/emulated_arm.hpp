#pragma once
/// Common parts of the emulated devices of both arms: a driver and a simulated controller in a
/// separate process.
#include <fmt/format.h>

#include "devices/arm/controller_process.hpp"
#include "devices/device_options.hpp"
#include "devices/operator/hand.hpp"
#include "devices/operator/hand_file.hpp"
#include "devices/settings.hpp"

namespace voxtouch::arm {

/// The ring ends after a peer is silent for 5 s; a dead controller must be detected earlier.
inline constexpr double kVirtualTimeoutS = 4.0;

/// A firm grip: an undamped tool of several kilograms would overshoot the motion of a relaxed hand.
inline sim::OperatorConfig default_emulator_hand() { return *hand::grip("arm-firm"); }

/// Common arguments of every simulated controller. In lockstep it waits as long as the ring. It
/// ends with its parent and needs no time limit.
inline std::vector<std::string> emulator_arguments(const Vec3& tool_F,
                                                   const devices::DeviceOptions& options,
                                                   const devices::SettingReader& settings) {
  std::vector<std::string> a = {"--tool", fmt::to_string(tool_F.x()), fmt::to_string(tool_F.y()),
                                fmt::to_string(tool_F.z())};
  if (options.lockstep)
    a.insert(a.end(), {"--virtual-time", "--patience", "86400"});
  for (const std::string& fault : settings.all("fault"))
    a.insert(a.end(), {"--fault", fault});
  return a;
}

/// Sets D and T of `options` so that the tool is at `rest_in_d` while the flange is at `flange_B`,
/// with the axes of T, D and the base parallel.
template <class Options>
void place(Options& options, const Pose& flange_B, const Vec3& rest_in_d, const Vec3& tool_F) {
  options.pose_FT = {tool_F, flange_B.orientation.conjugate().normalized()};
  options.pose_BD = {(flange_B * options.pose_FT).position - rest_in_d, Quat::Identity()};
}

/// The controller starts first and ends last, because it receives the driver's last messages.
template <class ArmDriver, class Options>
class EmulatedArm final : ControllerProcess, public ArmDriver {
 public:
  /// `ready`: derives the driver's options from the first line of the controller. Throws
  /// DeviceOpenError.
  EmulatedArm(std::string_view device, const std::string& program,
              const std::vector<std::string>& arguments, const devices::DeviceOptions& requested,
              const Options& options, Options (*ready)(Options, const std::string& said))
      : ControllerProcess(device, program, arguments, hand_text(requested, options)),
        ArmDriver(ready(options, said())) {}

  std::string last_error() const override {
    const std::string of_driver = ArmDriver::last_error(), how = ending();
    if (how.empty())
      return of_driver;
    return fmt::format("its simulated controller {}{}{}", how, of_driver.empty() ? "" : "; ",
                       of_driver);
  }

 private:
  /// The controller's tool has the axes of the flange; the driver's tool is rotated relative to
  /// them, and so is the motion in the base.
  static std::string hand_text(const devices::DeviceOptions& requested, const Options& options) {
    hand::HandFile file;
    file.motion = motion_in_device(devices::motion_of(requested), options.pose_BD.inverse(),
                                   {Vec3::Zero(), options.pose_FT.orientation}, 1.0);
    file.hand = requested.hand.value_or(default_emulator_hand());
    file.seed = requested.seed;
    return hand::to_text(file);
  }
};

}  // namespace voxtouch::arm
