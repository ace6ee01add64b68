#include "devices/phantom/counterpart.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/types/number.hpp"
#include "devices/counterpart.hpp"
#include "devices/phantom/phantom_driver.hpp"
#include "devices/phantom/phantom_models.hpp"
#include "devices/settings.hpp"
#include "devices/sim/parameters.hpp"

namespace voxtouch {
namespace {

constexpr std::string_view kWire = "wire-phantom";

struct FaultKind {
  std::string_view name;
  int code;
  double usual;  // amount
};
constexpr std::array kFaults{
    FaultKind{"comm_error", HDSIM_COMM_ERROR, -1.0},     FaultKind{"device_fault", HDSIM_DEVICE_FAULT, -1.0},
    FaultKind{"timer_error", HDSIM_TIMER_ERROR, 0.0},    FaultKind{"warm_motors", HDSIM_WARM_MOTORS, 1.5},
    FaultKind{"late_tick", HDSIM_LATE_TICK, 0.05},       FaultKind{"skipped_ticks", HDSIM_SKIPPED_TICKS, 50.0},
    FaultKind{"nan_position", HDSIM_NAN_POSITION, 20.0},
};

struct Fault {
  std::int64_t at_ns = 0;
  int code = 0;
  double amount = 0.0;
};

double number_in(std::string_view text, const SettingReader& settings, const std::string& whole) {
  const auto value = parse_number<double>(text);
  if (!value || !(std::abs(*value) <= 1e6))
    settings.refuse("fault", whole, "KIND@SECONDS[:AMOUNT] with numbers up to a million");
  return *value;
}

Fault parse_fault(const std::string& text, const SettingReader& settings) {
  const auto at = text.find('@');
  const auto kind =
      std::find_if(kFaults.begin(), kFaults.end(), [&](const FaultKind& k) { return k.name == text.substr(0, at); });
  if (at == std::string::npos || kind == kFaults.end())
    settings.refuse("fault", text,
                    "KIND@SECONDS[:AMOUNT] with one of comm_error, device_fault, timer_error, warm_motors, late_tick, "
                    "skipped_ticks, nan_position");
  const std::string_view rest = std::string_view(text).substr(at + 1);
  const auto colon = rest.find(':');
  const double amount =
      colon == std::string_view::npos ? kind->usual : number_in(rest.substr(colon + 1), settings, text);
  if (kind->code == HDSIM_LATE_TICK && !(amount >= 0.0 && amount <= 10.0))
    settings.refuse("fault", text, "a tick that is 0 to 10 s late");
  if (kind->code == HDSIM_WARM_MOTORS && !(amount >= 0.0 && amount <= 10.0))
    settings.refuse("fault", text, "a temperature from 0 to 10");
  return {std::llround(1e9 * number_in(rest.substr(0, colon), settings, text)), kind->code, amount};
}

std::vector<Fault> parse_faults(const SettingReader& settings) {
  std::vector<Fault> faults;
  for (const std::string& text : settings.all("fault")) faults.push_back(parse_fault(text, settings));
  std::stable_sort(faults.begin(), faults.end(), [](const Fault& a, const Fault& b) { return a.at_ns < b.at_ns; });
  return faults;
}

SettingReader hardware_settings(const DeviceOptions& options) {
  return {"phantom",
          options.settings,
          {"library", "name", "rate_hz", "max_force_n", "max_speed_m_per_s", "encoder_reset", "calibration_timeout_s",
           "rest"}};
}

SettingReader wire_settings(const DeviceOptions& options) {
  return {kWire, options.settings, {"library", "model", "rate_hz", "max_force_n", "rest", "fault"}, {"fault"}};
}

/// What both names share.
PhantomOptions driver_options(const SettingReader& settings) {
  PhantomOptions o;
  o.library = settings.text("library").value_or("");
  o.origin_in_d = settings.vector("rest").value_or(usual_rest_in_d());
  o.rate_hz = settings.whole("rate_hz");
  o.max_force_n = settings.number("max_force_n");
  return o;
}

PhantomOptions hardware_options(const DeviceOptions& options) {
  const SettingReader settings = hardware_settings(options);
  PhantomOptions o = driver_options(settings);
  o.name = settings.text("name").value_or("");
  o.max_speed_m_per_s = settings.number("max_speed_m_per_s");
  const std::string reset = settings.text("encoder_reset").value_or("if_needed");
  if (reset != "if_needed" && reset != "always") settings.refuse("encoder_reset", reset, "if_needed or always");
  o.encoder_reset = reset == "always" ? EncoderReset::kAlways : EncoderReset::kIfNeeded;
  o.calibration_timeout_s = settings.number("calibration_timeout_s").value_or(o.calibration_timeout_s);
  o.validate();
  return o;
}

/// The hooks that set the scene for the simulated library, which stays loaded for as long as the process runs.
struct Hooks {
  decltype(&hdsim_use_virtual_time) use_virtual_time = nullptr;
  decltype(&hdsim_set_seed) set_seed = nullptr;
  decltype(&hdsim_set_model) set_model = nullptr;
  decltype(&hdsim_set_motion) set_motion = nullptr;
  decltype(&hdsim_set_hand) set_hand = nullptr;
  decltype(&hdsim_set_switches) set_switches = nullptr;
  decltype(&hdsim_inject) inject = nullptr;
  decltype(&hdsim_last_message) last_message = nullptr;

  explicit Hooks(const std::string& library) {
    void* const handle = dlopen(library.c_str(), RTLD_LAZY | RTLD_NOLOAD);
    const auto find = [&](auto& function, const char* name) {
      function = reinterpret_cast<std::decay_t<decltype(function)>>(handle != nullptr ? dlsym(handle, name) : nullptr);
      if (function == nullptr)
        throw DeviceOpenError(fmt::format(
            "device '{}': {} is no simulated library (it has no {}); leave out the option library, or open 'phantom'",
            kWire, library, name));
    };
    find(use_virtual_time, "hdsim_use_virtual_time");
    find(set_seed, "hdsim_set_seed");
    find(set_model, "hdsim_set_model");
    find(set_motion, "hdsim_set_motion");
    find(set_hand, "hdsim_set_hand");
    find(set_switches, "hdsim_set_switches");
    find(inject, "hdsim_inject");
    find(last_message, "hdsim_last_message");
  }
  void must(int result) const {
    if (result < 0) throw DeviceOpenError(fmt::format("device '{}' cannot be opened: {}", kWire, last_message()));
  }
};

void set_motion(const Hooks& hooks, const Motion& motion) {
  std::vector<double> points;
  for (const Vec3& point : motion.path) points.insert(points.end(), point.begin(), point.end());
  const Vec3 centre = motion.circle_centre.value_or(Vec3::Zero());
  const Vec3& axis = motion.circle_axis;
  const Quat& q = motion.orientation;
  const hdsim_motion out{.points = points.data(),
                         .point_count = motion.path.size(),
                         .speed = motion.speed_m_per_s,
                         .hold = motion.hold_s,
                         .repeat_from = motion.repeat_from ? static_cast<std::int64_t>(*motion.repeat_from) : -1,
                         .circle_centre = motion.circle_centre ? centre.data() : nullptr,
                         .circle_axis = {axis.x(), axis.y(), axis.z()},
                         .orientation = {q.w(), q.x(), q.y(), q.z()}};
  hooks.must(hooks.set_motion(&out));
}

void set_hand(const Hooks& hooks, const OperatorConfig& hand) {
  const auto never_is_negative = [](double time_s) { return std::isinf(time_s) ? -1.0 : time_s; };
  const hdsim_hand out{.mass = hand.mass_kg,
                       .damping = hand.damping_ns_per_m,
                       .stiffness = hand.stiffness_n_per_m,
                       .let_go_at = never_is_negative(hand.let_go_at_s),
                       .grip_harder_at = never_is_negative(hand.grip_harder_at_s),
                       .grip_factor = hand.grip_factor,
                       .tremor = hand.tremor_n,
                       .tremor_bandwidth = hand.tremor_bandwidth_hz,
                       .released = hand.released,
                       .carries_tool = hand.carries_tool};
  hooks.must(hooks.set_hand(&out));
}

class WirePhantom final : public Counterpart {
 public:
  WirePhantom(const PhantomOptions& driver, const DeviceOptions& options, const SettingReader& settings)
      : hooks_(HdLibrary::load(driver.library).name()), faults_(parse_faults(settings)) {
    hooks_.must(hooks_.use_virtual_time(options.lockstep));
    hooks_.must(hooks_.set_seed(options.seed));
    if (const auto model = settings.text("model")) hooks_.must(hooks_.set_model(model->c_str()));
    set_hand(hooks_, options.hand.value_or(sim_phantom().hand));
    set_motion(hooks_, motion_in_device(motion_of(options), {driver.origin_in_d, Quat::Identity()}, {}, 1.0));
    hooks_.must(hooks_.set_switches(0, 1, 1));  // the stylus is in its inkwell until the device is open
    driver_ = std::make_unique<PhantomDriver>(driver);
    hooks_.set_switches(0, 1, 0);
  }

  DeviceResult<DeviceSample> read(std::chrono::microseconds timeout) noexcept override {
    for (; next_ < faults_.size() && faults_[next_].at_ns <= now_ns_; ++next_)
      hooks_.inject(faults_[next_].code, faults_[next_].amount);
    auto sample = driver_->read(timeout);
    if (sample) now_ns_ = sample->time_ns;
    return sample;
  }

 private:
  Hooks hooks_;
  std::vector<Fault> faults_;  // by time
  std::size_t next_ = 0;
  std::int64_t now_ns_ = 0;
};

std::string simulated_library() { return (program_folder() / "../lib/libHD_sim.so").lexically_normal().string(); }

}  // namespace

std::unique_ptr<Driver> open_phantom(const DeviceOptions& options) {
  return std::make_unique<PhantomDriver>(hardware_options(options));
}

DeviceDescription describe_phantom_device(const DeviceOptions& options) {
  const PhantomOptions o = hardware_options(options);
  return describe_phantom(
      {.model = "", .rate_hz = static_cast<double>(o.rate_hz.value_or(0)), .max_force_n = o.max_force_n.value_or(0.0)});
}

std::unique_ptr<Driver> open_wire_phantom(const DeviceOptions& options) {
  const SettingReader settings = wire_settings(options);
  PhantomOptions driver = driver_options(settings);
  if (driver.library.empty()) driver.library = simulated_library();
  driver.validate();
  return std::make_unique<WirePhantom>(driver, options, settings);
}

DeviceDescription describe_wire_phantom(const DeviceOptions& options) {
  const SettingReader settings = wire_settings(options);
  parse_faults(settings);
  const PhantomOptions driver = driver_options(settings);
  driver.validate();
  const std::string model = settings.text("model").value_or("premium");
  PhantomFacts facts;
  facts.model = model == "premium"        ? "PHANTOM Premium 1.5"
                : model == "premium-6dof" ? "PHANTOM Premium 1.5 6DOF"
                : model == "desktop"      ? "PHANTOM Desktop"
                : model == "omni"         ? "PHANTOM Omni"
                                          : "";
  if (facts.model.empty()) settings.refuse("model", model, "premium, premium-6dof, desktop or omni");
  if (model == "premium-6dof") facts.output_dof = 6;
  facts.rate_hz = driver.rate_hz.value_or(0);
  facts.max_force_n = std::min(phantom_figures(facts.model).max_force_n, driver.max_force_n.value_or(1e9));
  return describe_phantom(facts);
}

}  // namespace voxtouch
