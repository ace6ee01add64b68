#include "devices/registry.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "devices/arm/emulated_arm.hpp"
#include "devices/fr3/emulator.hpp"
#include "devices/lwr/emulator.hpp"
#include "devices/phantom/emulator.hpp"
#include "devices/settings.hpp"
#include "devices/sim/simulated_device.hpp"

namespace voxtouch::devices {
namespace {

std::unique_ptr<Driver> open_simulated(std::string_view name, const sim::SimParameters& parameters,
                                       const DeviceOptions& options) {
  const SettingReader none(name, options.settings, {});
  return std::make_unique<sim::SimulatedDevice>(parameters, options.hand.value_or(parameters.hand),
                                                motion_of(options), options.seed, options.is_led);
}

DeviceDescription describe_simulated(std::string_view name, const sim::SimParameters& parameters,
                                     const DeviceOptions& options) {
  const SettingReader none(name, options.settings, {});
  return parameters.description;
}

const DeviceDescription& described(const DeviceOptions& options) {
  if (!options.described)
    throw DeviceOpenError("the device file of 'sim:FILE' is not loaded");
  return *options.described;
}

struct Entry {
  std::string_view name;
  std::unique_ptr<Driver> (*open)(const DeviceOptions&);
  DeviceDescription (*describe)(const DeviceOptions&);
  sim::OperatorConfig (*hand)(const DeviceOptions&);  ///< null: no simulated hand holds it
};

const std::array kEntries{
    Entry{
        "sim-phantom",
        [](const DeviceOptions& o) { return open_simulated("sim-phantom", sim::sim_phantom(), o); },
        [](const DeviceOptions& o) {
          return describe_simulated("sim-phantom", sim::sim_phantom(), o);
        },
        [](const DeviceOptions&) { return sim::sim_phantom().hand; }},
    Entry{"sim-lwr",
          [](const DeviceOptions& o) { return open_simulated("sim-lwr", sim::sim_lwr(), o); },
          [](const DeviceOptions& o) { return describe_simulated("sim-lwr", sim::sim_lwr(), o); },
          [](const DeviceOptions&) { return sim::sim_lwr().hand; }},
    Entry{"emulated-phantom", phantom::open_emulated_phantom, phantom::describe_emulated_phantom,
          [](const DeviceOptions&) { return sim::sim_phantom().hand; }},
    Entry{"emulated-lwr", lwr::open_emulated_lwr, lwr::describe_emulated_lwr,
          [](const DeviceOptions&) { return arm::default_emulator_hand(); }},
    Entry{"emulated-fr3", fr3::open_emulated_fr3, fr3::describe_emulated_fr3,
          [](const DeviceOptions&) { return arm::default_emulator_hand(); }},
    Entry{"phantom", phantom::open_phantom, phantom::describe_phantom_device, nullptr},
    Entry{"lwr", lwr::open_lwr, lwr::describe_lwr_device, nullptr},
    Entry{"fr3", fr3::open_fr3, fr3::describe_fr3_device, nullptr},
};

const Entry kDescribed{kDescribedPrefix,
                       [](const DeviceOptions& o) {
                         return open_simulated("sim:FILE", sim::simulated(described(o)), o);
                       },
                       [](const DeviceOptions& o) {
                         return describe_simulated("sim:FILE", sim::simulated(described(o)), o);
                       },
                       [](const DeviceOptions& o) { return sim::simulated(described(o)).hand; }};

const Entry& find(std::string_view name) {
  if (name.starts_with(kDescribedPrefix))
    return kDescribed;
  const auto found = std::find_if(kEntries.begin(), kEntries.end(),
                                  [&](const Entry& e) { return e.name == name; });
  if (found == kEntries.end() && name.starts_with("wire-"))
    throw DeviceOpenError(
        fmt::format("unknown device '{0}'. Use 'emulated-{1}'", name, name.substr(5)));
  if (found == kEntries.end())
    throw DeviceOpenError(
        fmt::format("unknown device '{}'. Valid: {}, and sim:NAME or sim:FILE of a device file, "
                    "such as sim:touch (deploy/devices/README.md)",
                    name, fmt::join(device_names(), ", ")));
  return *found;
}

/// Force limits and the design rely on these numbers, so values of a faulty file or controller are
/// refused.
void require_possible(std::string_view name, const DeviceDescription& description) {
  if (const std::string wrong = validate(description); !wrong.empty())
    throw DeviceOpenError(fmt::format("device '{}' cannot be used: {}", name, wrong));
}

}  // namespace

const std::vector<std::string>& device_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Entry& entry : kEntries)
      all.emplace_back(entry.name);
    return all;
  }();
  return names;
}

std::unique_ptr<Driver> open_device(std::string_view name, const DeviceOptions& options) {
  const Entry& entry = find(name);
  if (options.is_led)
    require_led(name);
  try {
    std::unique_ptr<Driver> driver = entry.open(options);
    require_possible(name, driver->description());
    return driver;
  } catch (const DeviceOpenError& error) {
    if (entry.hand != nullptr)
      throw;
    throw DeviceOpenError(
        fmt::format("{} (without the hardware: '--device emulated-{}')", error.what(), name));
  } catch (const std::runtime_error& error) {
    throw DeviceOpenError(fmt::format("device '{}' cannot be opened: {}", name, error.what()));
  }
}

DeviceDescription describe_device(std::string_view name, const DeviceOptions& options) {
  DeviceDescription description = find(name).describe(options);
  description.simulated = can_be_led(name);
  require_possible(name, description);
  return description;
}

bool has_simulated_hand(std::string_view name) { return find(name).hand != nullptr; }

bool can_be_led(std::string_view name) {
  return name.starts_with("sim-") || name.starts_with(kDescribedPrefix);
}

void require_led(std::string_view name) {
  const Entry& entry = find(name);
  if (can_be_led(name))
    return;
  throw DeviceOpenError(
      fmt::format("device '{}' is {}: --hand-from page needs sim-phantom, sim-lwr or sim:FILE",
                  name, entry.hand == nullptr ? "a real device" : "moved by its emulator's hand"));
}

sim::OperatorConfig usual_hand(std::string_view name, const DeviceOptions& options) {
  const Entry& entry = find(name);
  if (entry.hand == nullptr)
    throw DeviceOpenError(
        fmt::format("device '{}' is a real device: a simulated hand is not possible", name));
  return entry.hand(options);
}

}  // namespace voxtouch::devices
