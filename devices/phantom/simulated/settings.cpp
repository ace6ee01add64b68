#include "devices/phantom/simulated/settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <stdexcept>

#include "core/types/number.hpp"

namespace voxtouch::hd_sim {
namespace {

struct Number {
  std::string_view name;
  double low, high;
  double& (*of)(Settings&);
};

constexpr std::array kNumbers{
    Number{"coulomb_nm", 0.0, 10.0, [](Settings& s) -> double& { return s.plant.coulomb_nm; }},
    Number{"viscous_nms_per_rad", 0.0, 1.0,
           [](Settings& s) -> double& { return s.plant.viscous_nms_per_rad; }},
    Number{"gravity_m_per_s2", 0.0, 100.0,
           [](Settings& s) -> double& { return s.plant.gravity_m_per_s2; }},
    Number{"hand_bandwidth_hz", 0.01, 1e3,
           [](Settings& s) -> double& { return s.hand_bandwidth_hz; }},
    Number{"resolution_m", 1e-9, 0.01, [](Settings& s) -> double& { return s.resolution_m; }},
    Number{"gimbal_resolution_rad", 1e-9, 0.1,
           [](Settings& s) -> double& { return s.gimbal_resolution_rad; }},
    Number{"velocity_filter_hz", 0.1, 1e6,
           [](Settings& s) -> double& { return s.velocity_filter_hz; }},
    Number{"thermal_time_s", 0.01, 1e9, [](Settings& s) -> double& { return s.thermal_time_s; }},
    Number{"watchdog_s", 0.0, 1e3, [](Settings& s) -> double& { return s.watchdog_s; }},
    Number{"reset_error_turret_rad", -1.0, 1.0,
           [](Settings& s) -> double& { return s.reset_error_rad[0]; }},
    Number{"reset_error_thigh_rad", -1.0, 1.0,
           [](Settings& s) -> double& { return s.reset_error_rad[1]; }},
    Number{"reset_error_shin_rad", -1.0, 1.0,
           [](Settings& s) -> double& { return s.reset_error_rad[2]; }},
};

template <class T>
T number(std::string_view text, std::string_view whole) {
  const auto value = parse_number<T>(text);
  if (!value)
    throw std::runtime_error(
        fmt::format("simulated Phantom: setting '{}' has no number after '='", whole));
  return *value;
}

void read_one(Settings& settings, std::string_view item) {
  const std::size_t equals = item.find('=');
  const std::string_view name = item.substr(0, equals);
  const std::string_view value =
      equals == std::string_view::npos ? std::string_view{} : item.substr(equals + 1);
  if (name == "model") {
    const Model* model = find_model(value);
    if (model == nullptr)
      throw std::runtime_error(
          fmt::format("simulated Phantom: unknown model '{}'; valid: {}", value, model_keys()));
    settings.model = model;
  } else if (name == "grip") {
    const auto hand = hand::grip(value);
    if (!hand)
      throw std::runtime_error(fmt::format("simulated Phantom: unknown grip '{}'; valid: {}", value,
                                           fmt::join(hand::grip_names(), ", ")));
    settings.hand = *hand;
  } else if (name == "seed") {
    settings.seed = number<std::uint64_t>(value, item);
  } else if (name == "virtual") {
    settings.virtual_time = number<int>(value, item) != 0;
  } else {
    settings.set(name, number<double>(value, item));
  }
}

}  // namespace

void Settings::set(std::string_view name, double value) {
  std::string names;
  for (const Number& known : kNumbers) {
    if (known.name != name) {
      names += fmt::format(" {}", known.name);
      continue;
    }
    if (!(value >= known.low && value <= known.high))
      throw std::runtime_error(fmt::format("simulated Phantom: {} is {}, limits [{}, {}]", name,
                                           value, known.low, known.high));
    known.of(*this) = value;
    return;
  }
  throw std::runtime_error(
      fmt::format("simulated Phantom: unknown setting '{}'. Valid settings:{}", name, names));
}

void read_settings(Settings& settings, std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = text.find(';');
    if (const std::string_view item = text.substr(0, end); !item.empty())
      read_one(settings, item);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
}

}  // namespace voxtouch::hd_sim
