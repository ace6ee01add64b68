#include "devices/fr3/emulator.hpp"

#include "core/types/number.hpp"
#include "devices/arm/emulated_arm.hpp"
#include "devices/fr3/fr3_driver.hpp"

namespace voxtouch::fr3 {
namespace {

devices::SettingReader hardware_settings(const devices::DeviceOptions& options) {
  return {"fr3",
          options.settings,
          {"address", "port", "connect_timeout_s", "rest", "tool", "load_kg", "load_centre"}};
}

devices::SettingReader emulator_settings(const devices::DeviceOptions& options) {
  return {"emulated-fr3", options.settings, {"rest", "tool", "server_version", "fault"}, {"fault"}};
}

/// Common options of both devices.
Fr3Options driver_options(const devices::SettingReader& settings) {
  Fr3Options o;
  place(o, settings.vector("rest").value_or(devices::usual_rest_in_d()),
        settings.vector("tool").value_or(Vec3::Zero()));
  return o;
}

Fr3Options hardware_options(const devices::DeviceOptions& options) {
  const devices::SettingReader settings = hardware_settings(options);
  Fr3Options o = driver_options(settings);
  o.address = settings.text("address").value_or(o.address);
  if (!arm::parse_ipv4(o.address))
    settings.refuse("address", o.address, "the robot's IPv4 address, such as 172.16.0.2");
  o.port = static_cast<std::uint16_t>(settings.whole("port", 1, 65535).value_or(o.port));
  o.connect_timeout_s =
      settings.number("connect_timeout_s", 0.0, 3600.0).value_or(o.connect_timeout_s);
  o.load.mass_kg = settings.number("load_kg", 0.0, 3.0).value_or(0.0);
  o.load.centre_m = settings.vector("load_centre").value_or(Vec3::Zero());
  o.load.inertia_kg_m2.setConstant(1e-3 * o.load.mass_kg);  // of a ball of 5 cm radius
  o.cancelled = options.cancelled;
  return o;
}

std::uint32_t server_version(const devices::SettingReader& settings) {
  return settings.whole("server_version", 1, 65535).value_or(fci::kNewestVersion);
}

using EmulatedFr3 = arm::EmulatedArm<Fr3Driver, Fr3Options>;

/// The first line of the robot gives its address: "... TCP 127.0.0.1:PORT, ...".
Fr3Options at_port(Fr3Options driver, const std::string& said) {
  const std::string mark = fmt::format("TCP {}:", driver.address);
  const auto begin = said.find(mark);
  const std::string_view rest = begin == std::string::npos
                                    ? std::string_view()
                                    : std::string_view(said).substr(begin + mark.size());
  const auto port = parse_number<std::uint16_t>(rest.substr(0, rest.find(',')));
  if (!port)
    throw devices::DeviceOpenError(
        "device 'emulated-fr3': its simulated controller printed no address: " + said);
  driver.port = *port;
  return driver;
}

}  // namespace

void place(Fr3Options& options, const Vec3& rest_in_d, const Vec3& tool_F) {
  arm::place(options, Fr3Arm().at(options.posture.posture).flange, rest_in_d, tool_F);
}

std::unique_ptr<devices::Driver> open_fr3(const devices::DeviceOptions& options) {
  return std::make_unique<Fr3Driver>(hardware_options(options));
}

DeviceDescription describe_fr3_device(const devices::DeviceOptions& options) {
  hardware_options(options);
  return describe_fr3();
}

std::unique_ptr<devices::Driver> open_emulated_fr3(const devices::DeviceOptions& options) {
  const devices::SettingReader settings = emulator_settings(options);
  Fr3Options driver = driver_options(settings);
  driver.address = "127.0.0.1";
  driver.virtual_time = options.lockstep;
  driver.virtual_timeout_s = arm::kVirtualTimeoutS;
  driver.cancelled = options.cancelled;
  std::vector<std::string> arguments =
      arm::emulator_arguments(driver.pose_FT.position, options, settings);
  arguments.insert(arguments.end(), {"--address", driver.address, "--server-version",
                                     fmt::to_string(server_version(settings))});
  return std::make_unique<EmulatedFr3>("emulated-fr3", "voxtouch_fci_robot", arguments, options,
                                       driver, at_port);
}

DeviceDescription describe_emulated_fr3(const devices::DeviceOptions& options) {
  const devices::SettingReader settings = emulator_settings(options);
  driver_options(settings);
  server_version(settings);
  return describe_fr3();
}

}  // namespace voxtouch::fr3
