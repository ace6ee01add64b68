#include "core/coupling/design/loop_parts.hpp"

#include <fmt/core.h>

#include <cmath>
#include <string_view>

#include "core/types/enum_name.hpp"

namespace voxtouch::coupling::design {
namespace {

constexpr std::array<std::string_view, 2> kGrips{"pen", "arm"};
const std::string kRangeText = fmt::format("from {} to {}", kMinQuantity, kMaxQuantity);
const std::string kOrZeroText = fmt::format("from 0 to {}", kMaxQuantity);
const std::string kZeroOrText = "0, or " + kRangeText;
const std::string kNoLimitText = fmt::format("{} or above, infinity for no limit", kMinQuantity);

/// Collects sentences about fields whose names begin with `prefix`. Comparisons with NaN are false,
/// so NaN satisfies no rule.
class Findings {
 public:
  Findings(std::string prefix, std::vector<std::string>& out)
      : prefix_(std::move(prefix)),
        out_(out) {}

  void positive(std::string_view field, double value) {
    rule(value >= kMinQuantity && value <= kMaxQuantity, field, value, kRangeText);
  }
  /// For times that are differences of others: rounding may leave a tiny remainder.
  void not_negative(std::string_view field, double value) {
    rule(value >= 0.0 && value <= kMaxQuantity, field, value, kOrZeroText);
  }
  void quantity_or_zero(std::string_view field, double value) {
    rule(value == 0.0 || (value >= kMinQuantity && value <= kMaxQuantity), field, value,
         kZeroOrText);
  }
  void positive_or_none(std::string_view field, double value) {
    rule(value >= kMinQuantity, field, value, kNoLimitText);
  }
  void not_below(std::string_view field, double value, std::string_view least_field, double least) {
    if (value < least)
      out_.push_back(fmt::format("{0}{1} is {2}; it must not be below {0}{3}, which is {4}.",
                                 prefix_, field, value, least_field, least));
  }
  void rule(bool kept, std::string_view field, double value, std::string_view text) {
    if (!kept)
      out_.push_back(fmt::format("{}{} is {}; it must be {}.", prefix_, field, value, text));
  }

 private:
  std::string prefix_;
  std::vector<std::string>& out_;
};

void check_axis(const AxisModel& axis, const char* prefix, std::vector<std::string>& out) {
  Findings find(prefix, out);
  find.positive("inertia_min", axis.inertia_min);
  find.positive("inertia_max", axis.inertia_max);
  find.not_below("inertia_max", axis.inertia_max, "inertia_min", axis.inertia_min);
  find.quantity_or_zero("damping", axis.damping);
  find.quantity_or_zero("coulomb_friction", axis.coulomb_friction);
  find.quantity_or_zero("resolution", axis.resolution);
  find.positive_or_none("max_effort", axis.max_effort);
  find.positive_or_none("max_stiffness", axis.max_stiffness);
  find.positive_or_none("effort_bandwidth_hz", axis.effort_bandwidth_hz);
}

void check_timing(const LoopTiming& timing, std::vector<std::string>& out) {
  Findings find("timing.", out);
  find.positive("period_s", timing.period_s);
  find.not_negative("delay_s", timing.delay_s);
  find.not_negative("jitter", timing.jitter);
  find.rule(timing.consecutive_losses >= 0, "consecutive_losses", timing.consecutive_losses,
            "0 or above");
  if (timing.period_s > 0.0 && timing.delay_s > kMaxDelayPeriods * timing.period_s)
    out.push_back(fmt::format("timing.delay_s is {}; it must be at most {} periods of {} s.",
                              timing.delay_s, kMaxDelayPeriods, timing.period_s));
}

}  // namespace

std::vector<std::string> check(const DeviceModel& device) {
  std::vector<std::string> out;
  check_axis(device.translation, "translation.", out);
  if (device.gives_torque)
    check_axis(device.rotation, "rotation.", out);
  check_timing(device.timing, out);
  return out;
}

std::vector<std::string> check(const HandRange& hand) {
  std::vector<std::string> out;
  if (hand.any_passive)
    return out;
  Findings find("", out);
  const auto range = [&](const char* least_field, double least, const char* most_field,
                         double most) {
    find.quantity_or_zero(least_field, least);
    find.quantity_or_zero(most_field, most);
    find.not_below(most_field, most, least_field, least);
  };
  range("mass_min", hand.mass_min, "mass_max", hand.mass_max);
  range("damping_min", hand.damping_min, "damping_max", hand.damping_max);
  range("stiffness_min", hand.stiffness_min, "stiffness_max", hand.stiffness_max);
  return out;
}

std::string_view name_of(Grip grip) noexcept { return name_in(kGrips, grip); }
bool parse_grip(std::string_view word, Grip& grip) noexcept {
  return find_name(kGrips, word, grip);
}

DeviceModel model_of(const DeviceDescription& d) {
  DeviceModel m;
  m.name = d.model;
  m.translation = {.inertia_min = d.mass_min_kg,
                   .inertia_max = d.mass_max_kg,
                   .damping = d.damping_ns_per_m,
                   .coulomb_friction = d.coulomb_friction_n,
                   .resolution = d.position_resolution_m,
                   .max_effort = d.max_force_n,
                   .max_stiffness = d.max_stiffness_n_per_m,
                   .effort_bandwidth_hz = d.force_bandwidth_hz};
  m.gives_torque = d.max_torque_nm > 0.0;
  m.rotation = {.inertia_min = d.inertia_min_kg_m2,
                .inertia_max = d.inertia_max_kg_m2,
                .damping = d.damping_nms_per_rad,
                .coulomb_friction = d.coulomb_friction_nm,
                .resolution = d.orientation_resolution_rad,
                .max_effort = d.max_torque_nm,
                .max_stiffness = d.max_stiffness_nm_per_rad,
                .effort_bandwidth_hz = d.force_bandwidth_hz};
  m.timing.period_s = 1.0 / d.rate_hz;
  m.timing.network_s = d.network_delay_s;
  m.timing.delay_s = d.delay_s + d.network_delay_s + (d.simulated ? 0.0 : m.timing.period_s);
  m.timing.jitter = d.jitter;
  m.timing.consecutive_losses = static_cast<int>(d.consecutive_losses);
  parse_grip(d.grip, m.grip);
  return m;
}

}  // namespace voxtouch::coupling::design
