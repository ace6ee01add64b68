#include "devices/lwr/emulator.hpp"

#include "devices/arm/emulated_arm.hpp"
#include "devices/lwr/lwr_driver.hpp"

namespace voxtouch::lwr {
namespace {

constexpr double kConnectTimeoutS = 3.0;  // a running controller sends every few milliseconds

devices::SettingReader hardware_settings(const devices::DeviceOptions& options) {
  return {"lwr",
          options.settings,
          {"address", "port", "controller", "connect_timeout_s", "rest", "tool", "capture"}};
}

devices::SettingReader emulator_settings(const devices::DeviceOptions& options) {
  return {"emulated-lwr",
          options.settings,
          {"period_ms", "rest", "tool", "capture", "trace", "fault"},
          {"fault"}};
}

/// Common options of both devices.
LwrOptions driver_options(const devices::SettingReader& settings) {
  LwrOptions o;
  place(o, settings.vector("rest").value_or(devices::usual_rest_in_d()),
        settings.vector("tool").value_or(Vec3::Zero()));
  o.connect_timeout_s = kConnectTimeoutS;
  o.capture_file = settings.text("capture").value_or("");
  return o;
}

LwrOptions hardware_options(const devices::DeviceOptions& options) {
  const devices::SettingReader settings = hardware_settings(options);
  LwrOptions o = driver_options(settings);
  o.address = settings.text("address").value_or(o.address);
  o.port = static_cast<std::uint16_t>(settings.whole("port", 1, 65535).value_or(o.port));
  o.controller = settings.text("controller").value_or("");
  if (!o.controller.empty() && !parse_ipv4(o.controller))
    settings.refuse("controller", o.controller, "an IPv4 address, such as 192.168.0.20, or empty");
  o.connect_timeout_s =
      settings.number("connect_timeout_s", 0.0, 3600.0).value_or(o.connect_timeout_s);
  o.cancelled = options.cancelled;
  return o;
}

std::uint32_t period_ms(const devices::SettingReader& settings) {
  return settings.whole("period_ms", 1, 100).value_or(1);
}

using EmulatedLwr = arm::EmulatedArm<LwrDriver, LwrOptions>;

}  // namespace

void place(LwrOptions& options, const Vec3& rest_in_d, const Vec3& tool_F) {
  arm::place(options, LwrArm().flange(options.posture.posture), rest_in_d, tool_F);
}

std::unique_ptr<devices::Driver> open_lwr(const devices::DeviceOptions& options) {
  return std::make_unique<LwrDriver>(hardware_options(options));
}

DeviceDescription describe_lwr_device(const devices::DeviceOptions& options) {
  hardware_options(options);
  return describe_lwr(0.001);
}

std::unique_ptr<devices::Driver> open_emulated_lwr(const devices::DeviceOptions& options) {
  const devices::SettingReader settings = emulator_settings(options);
  LwrOptions driver = driver_options(settings);
  driver.address = driver.controller = "127.0.0.1";
  driver.port = UdpSocket(driver.address, 0).local().port;
  driver.virtual_timeout_s = arm::kVirtualTimeoutS;
  driver.cancelled = options.cancelled;
  std::vector<std::string> arguments =
      arm::emulator_arguments(driver.pose_FT.position, options, settings);
  arguments.insert(arguments.end(), {"--remote", fmt::format("127.0.0.1:{}", driver.port),
                                     "--period-ms", fmt::to_string(period_ms(settings))});
  if (const auto trace = settings.text("trace"))
    arguments.insert(arguments.end(), {"--trace", *trace});
  return std::make_unique<EmulatedLwr>(
      "emulated-lwr", "voxtouch_fri_controller", arguments, options, driver,
      [](LwrOptions as_they_are, const std::string&) { return as_they_are; });
}

DeviceDescription describe_emulated_lwr(const devices::DeviceOptions& options) {
  const devices::SettingReader settings = emulator_settings(options);
  driver_options(settings);
  return describe_lwr(1e-3 * period_ms(settings));
}

}  // namespace voxtouch::lwr
