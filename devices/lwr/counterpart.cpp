#include "devices/lwr/counterpart.hpp"

#include <fmt/format.h>

#include "devices/arm/controller_process.hpp"
#include "devices/lwr/lwr_driver.hpp"
#include "devices/operator/hand.hpp"
#include "devices/operator/hand_file.hpp"
#include "devices/settings.hpp"

namespace voxtouch::lwr {
namespace {

constexpr double kConnectTimeoutS = 3.0;  // a controller that runs sends every few milliseconds
// The ring gives a silent peer up after 5 s, and a controller that died has to be seen before that.
constexpr double kVirtualTimeoutS = 4.0;
// In lockstep the controller waits as long as the ring does; it goes with its parent, so no patience of its own is needed.
constexpr const char* kPatienceS = "86400";

devices::SettingReader hardware_settings(const devices::DeviceOptions& options) {
  return {"lwr", options.settings, {"address", "port", "controller", "connect_timeout_s", "rest", "tool", "capture"}};
}

devices::SettingReader wire_settings(const devices::DeviceOptions& options) {
  return {"wire-lwr", options.settings, {"period_ms", "rest", "tool", "capture", "trace", "fault"}, {"fault"}};
}

/// What both names share.
LwrOptions driver_options(const devices::SettingReader& settings) {
  LwrOptions o;
  place(o, settings.vector("rest").value_or(devices::usual_rest_in_d()), settings.vector("tool").value_or(Vec3::Zero()));
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
    settings.refuse("controller", o.controller, "an IPv4 address like 192.168.0.20, or empty");
  o.connect_timeout_s = settings.number("connect_timeout_s", 0.0, 3600.0).value_or(o.connect_timeout_s);
  o.cancelled = options.cancelled;
  return o;
}

std::uint32_t period_ms(const devices::SettingReader& settings) {
  return settings.whole("period_ms", 1, 100).value_or(1);
}

/// The controller begins before the driver and ends after it, whose last messages need it.
class WireLwr final : arm::ControllerProcess, public LwrDriver {
 public:
  WireLwr(const LwrOptions& driver, const devices::DeviceOptions& options, const devices::SettingReader& settings)
      : ControllerProcess("wire-lwr", "voxtouch_fri_controller", arguments(driver, options, settings), hand(driver, options)),
        LwrDriver(driver) {}

  std::string trouble() const override {
    const std::string of_driver = LwrDriver::trouble(), how = ending();
    if (how.empty()) return of_driver;
    return fmt::format("its simulated controller {}{}{}", how, of_driver.empty() ? "" : "; ", of_driver);
  }

 private:
  static std::vector<std::string> arguments(const LwrOptions& driver, const devices::DeviceOptions& options,
                                            const devices::SettingReader& settings) {
    const Vec3& tool = driver.pose_FT.position;
    std::vector<std::string> a = {"--remote",
                                  fmt::format("127.0.0.1:{}", driver.port),
                                  "--period-ms",
                                  fmt::to_string(period_ms(settings)),
                                  "--tool",
                                  fmt::to_string(tool.x()),
                                  fmt::to_string(tool.y()),
                                  fmt::to_string(tool.z())};
    if (options.lockstep) a.insert(a.end(), {"--virtual-time", "--patience", kPatienceS});
    for (const std::string& fault : settings.all("fault")) a.insert(a.end(), {"--fault", fault});
    if (const auto trace = settings.text("trace")) a.insert(a.end(), {"--trace", *trace});
    return a;
  }
  /// The controller's tool has the flange's axes, ours is turned against them: so is the motion in the base.
  static std::string hand(const LwrOptions& driver, const devices::DeviceOptions& options) {
    hand::HandFile file;
    file.motion = motion_in_device(devices::motion_of(options), driver.pose_BD.inverse(),
                                   {Vec3::Zero(), driver.pose_FT.orientation}, 1.0);
    file.hand = options.hand.value_or(usual_hand_at_wire_lwr());
    file.seed = options.seed;
    return hand::to_text(file);
  }
};

}  // namespace

void place(LwrOptions& options, const Vec3& rest_in_d, const Vec3& tool_F) {
  const Pose flange = LwrArm().flange(options.posture.posture);
  options.pose_FT = {tool_F, flange.orientation.conjugate().normalized()};
  options.pose_BD = {(flange * options.pose_FT).position - rest_in_d, Quat::Identity()};
}

std::unique_ptr<devices::Driver> open_lwr(const devices::DeviceOptions& options) {
  return std::make_unique<LwrDriver>(hardware_options(options));
}

DeviceDescription describe_lwr_device(const devices::DeviceOptions& options) {
  hardware_options(options);
  return describe_lwr(0.001);
}

std::unique_ptr<devices::Driver> open_wire_lwr(const devices::DeviceOptions& options) {
  const devices::SettingReader settings = wire_settings(options);
  LwrOptions driver = driver_options(settings);
  driver.address = driver.controller = "127.0.0.1";
  driver.port = UdpSocket(driver.address, 0).local().port;
  driver.virtual_timeout_s = kVirtualTimeoutS;
  driver.cancelled = options.cancelled;
  return std::make_unique<WireLwr>(driver, options, settings);
}

sim::OperatorConfig usual_hand_at_wire_lwr() { return *hand::grip("arm-firm"); }

DeviceDescription describe_wire_lwr(const devices::DeviceOptions& options) {
  const devices::SettingReader settings = wire_settings(options);
  driver_options(settings);
  return describe_lwr(1e-3 * period_ms(settings));
}

}  // namespace voxtouch::lwr
