#include "devices/phantom/emulator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/types/number.hpp"
#include "core/types/program_folder.hpp"
#include "devices/operator/hand_file.hpp"
#include "devices/phantom/phantom_driver.hpp"
#include "devices/phantom/phantom_models.hpp"
#include "devices/phantom/simulated/models.hpp"
#include "devices/settings.hpp"
#include "devices/sim/parameters.hpp"

namespace voxtouch::phantom {
namespace {

constexpr std::string_view kWire = "emulated-phantom";

struct FaultKind {
  std::string_view name;
  int code;
  double usual;  // default amount
};
constexpr std::array kFaults{
    FaultKind{"comm_error", HDSIM_COMM_ERROR, -1.0},
    FaultKind{"device_fault", HDSIM_DEVICE_FAULT, -1.0},
    FaultKind{"timer_error", HDSIM_TIMER_ERROR, 0.0},
    FaultKind{"warm_motors", HDSIM_WARM_MOTORS, 1.5},
    FaultKind{"late_tick", HDSIM_LATE_TICK, 0.05},
    FaultKind{"skipped_ticks", HDSIM_SKIPPED_TICKS, 50.0},
    FaultKind{"nan_position", HDSIM_NAN_POSITION, 20.0},
};

struct Fault {
  std::int64_t at_ns = 0;
  int code = 0;
  double amount = 0.0;
};

double number_in(std::string_view text, const devices::SettingReader& settings,
                 const std::string& whole) {
  const auto value = parse_number<double>(text);
  if (!value || !(std::abs(*value) <= 1e6))
    settings.refuse("fault", whole, "KIND@SECONDS[:AMOUNT] with numbers up to a million");
  return *value;
}

Fault parse_fault(const std::string& text, const devices::SettingReader& settings) {
  const auto at = text.find('@');
  const auto kind = std::find_if(kFaults.begin(), kFaults.end(),
                                 [&](const FaultKind& k) { return k.name == text.substr(0, at); });
  if (at == std::string::npos || kind == kFaults.end())
    settings.refuse("fault", text,
                    "KIND@SECONDS[:AMOUNT] with one of comm_error, device_fault, timer_error, "
                    "warm_motors, late_tick, "
                    "skipped_ticks, nan_position");
  const std::string_view rest = std::string_view(text).substr(at + 1);
  const auto colon = rest.find(':');
  const double amount = colon == std::string_view::npos
                            ? kind->usual
                            : number_in(rest.substr(colon + 1), settings, text);
  if (kind->code == HDSIM_LATE_TICK && !(amount >= 0.0 && amount <= 10.0))
    settings.refuse("fault", text, "a tick that is 0 to 10 s late");
  if (kind->code == HDSIM_WARM_MOTORS && !(amount >= 0.0 && amount <= 10.0))
    settings.refuse("fault", text, "a temperature from 0 to 10");
  return {std::llround(1e9 * number_in(rest.substr(0, colon), settings, text)), kind->code, amount};
}

std::vector<Fault> parse_faults(const devices::SettingReader& settings) {
  std::vector<Fault> faults;
  for (const std::string& text : settings.all("fault"))
    faults.push_back(parse_fault(text, settings));
  std::stable_sort(faults.begin(), faults.end(),
                   [](const Fault& a, const Fault& b) { return a.at_ns < b.at_ns; });
  return faults;
}

devices::SettingReader hardware_settings(const devices::DeviceOptions& options) {
  return {"phantom",
          options.settings,
          {"library", "name", "rate_hz", "max_force_n", "max_speed_m_per_s", "encoder_reset",
           "calibration_timeout_s", "rest"}};
}

devices::SettingReader emulator_settings(const devices::DeviceOptions& options) {
  return {kWire,
          options.settings,
          {"library", "model", "rate_hz", "max_force_n", "rest", "fault"},
          {"fault"}};
}

/// Common options of both devices.
PhantomOptions driver_options(const devices::SettingReader& settings) {
  PhantomOptions o;
  o.library = settings.text("library").value_or("");
  o.origin_in_d = settings.vector("rest").value_or(devices::usual_rest_in_d());
  if (o.origin_in_d.cwiseAbs().maxCoeff() > 10.0)
    settings.refuse("rest", *settings.text("rest"), "within 10 m of the origin of D");
  o.rate_hz = settings.whole("rate_hz", 100, 10000);
  o.max_force_n = settings.number("max_force_n", 1e-3, 1e3);
  return o;
}

PhantomOptions hardware_options(const devices::DeviceOptions& options) {
  const devices::SettingReader settings = hardware_settings(options);
  PhantomOptions o = driver_options(settings);
  o.name = settings.text("name").value_or("");
  o.max_speed_m_per_s = settings.number("max_speed_m_per_s", 1e-3, 100.0);
  const std::string reset = settings.text("encoder_reset").value_or("if_needed");
  if (reset != "if_needed" && reset != "always")
    settings.refuse("encoder_reset", reset, "if_needed or always");
  o.encoder_reset = reset == "always" ? EncoderReset::kAlways : EncoderReset::kIfNeeded;
  o.calibration_timeout_s =
      settings.number("calibration_timeout_s", 0.0, 3600.0).value_or(o.calibration_timeout_s);
  return o;
}

/// The hooks that configure the simulated library. It stays loaded until the process ends.
const HdSimHooks& hooks_of(const HdLibrary& library) {
  if (library.hooks().complete())
    return library.hooks();
  throw devices::DeviceOpenError(
      fmt::format("device '{}': {} is not a simulated library (no hdsim_ functions). Remove option "
                  "library, or open 'phantom'",
                  kWire, library.name()));
}

/// The simulated library, configured for the driver that opens it.
class SimulatedArm {
 protected:
  SimulatedArm(const PhantomOptions& driver, const devices::DeviceOptions& options,
               const devices::SettingReader& settings)
      : hooks_(hooks_of(HdLibrary::load(driver.library))),
        faults_(parse_faults(settings)) {
    must(hooks_.use_virtual_time(options.lockstep));
    must(hooks_.set_seed(options.seed));
    if (const auto model = settings.text("model"))
      must(hooks_.set_model(model->c_str()));
    hand::HandFile file;
    file.hand = options.hand.value_or(sim::sim_phantom().hand);
    file.motion = motion_in_device(devices::motion_of(options),
                                   {driver.origin_in_d, Quat::Identity()}, {}, 1.0);
    const std::string hand = hand::to_text(file);
    must(hooks_.set_hand(hand.c_str()));
    must(hooks_.set_motion(hand.c_str()));
    must(hooks_.set_switches(0, 1, 1));  // the stylus is in its inkwell until the device is open
  }

  const HdSimHooks& hooks_;
  std::vector<Fault> faults_;  // by time

 private:
  void must(int result) const {
    if (result < 0)
      throw devices::DeviceOpenError(
          fmt::format("device '{}' cannot be opened: {}", kWire, hooks_.last_message()));
  }
};

class EmulatedPhantom final : SimulatedArm, public PhantomDriver {
 public:
  EmulatedPhantom(const PhantomOptions& driver, const devices::DeviceOptions& options,
                  const devices::SettingReader& settings)
      : SimulatedArm(driver, options, settings),
        PhantomDriver(driver) {
    hooks_.set_switches(0, 1, 0);
  }

  devices::DeviceResult<devices::DeviceSample> read(
      std::chrono::microseconds timeout) noexcept override {
    for (; next_ < faults_.size() && faults_[next_].at_ns <= now_ns_; ++next_)
      hooks_.inject(faults_[next_].code, faults_[next_].amount);
    auto sample = PhantomDriver::read(timeout);
    if (sample)
      now_ns_ = sample->time_ns;
    return sample;
  }

 private:
  std::size_t next_ = 0;
  std::int64_t now_ns_ = 0;
};

std::string simulated_library() { return (library_folder() / "libHD_sim.so").string(); }

}  // namespace

std::unique_ptr<devices::Driver> open_phantom(const devices::DeviceOptions& options) {
  return std::make_unique<PhantomDriver>(hardware_options(options));
}

DeviceDescription describe_phantom_device(const devices::DeviceOptions& options) {
  const PhantomOptions o = hardware_options(options);
  return describe_phantom({.model = "",
                           .rate_hz = static_cast<double>(o.rate_hz.value_or(0)),
                           .max_force_n = o.max_force_n.value_or(0.0)});
}

std::unique_ptr<devices::Driver> open_emulated_phantom(const devices::DeviceOptions& options) {
  const devices::SettingReader settings = emulator_settings(options);
  PhantomOptions driver = driver_options(settings);
  if (driver.library.empty())
    driver.library = simulated_library();
  return std::make_unique<EmulatedPhantom>(driver, options, settings);
}

DeviceDescription describe_emulated_phantom(const devices::DeviceOptions& options) {
  const devices::SettingReader settings = emulator_settings(options);
  parse_faults(settings);
  const PhantomOptions driver = driver_options(settings);
  const std::string model = settings.text("model").value_or("premium");
  const hd_sim::Model* known = hd_sim::find_model(model);
  if (known == nullptr)
    settings.refuse("model", model, fmt::format("one of {}", hd_sim::model_keys()));
  PhantomFacts facts{.model = known->type, .output_dof = known->output_dof};
  facts.rate_hz = driver.rate_hz.value_or(0);
  facts.max_force_n =
      std::min(phantom_figures(facts.model).max_force_n, driver.max_force_n.value_or(1e9));
  return describe_phantom(facts);
}

}  // namespace voxtouch::phantom
