#include "core/coupling/design/design_steps.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace voxtouch::coupling::design {
namespace {

void require(bool kept, std::string_view field, double value, std::string_view rule) {
  if (!kept)
    throw std::invalid_argument(
        fmt::format("Coupling design: {} is {}; it must be {}.", field, value, rule));
}
void positive(std::string_view field, double value) {
  require(value > 0.0 && std::isfinite(value), field, value, "above 0");
}
void not_negative(std::string_view field, double value) {
  require(value >= 0.0 && std::isfinite(value), field, value, "0 or above");
}

void refuse_first(std::string_view whose, const std::vector<std::string>& sentences) {
  if (!sentences.empty())
    throw std::invalid_argument(fmt::format("Coupling design, {}: {}", whose, sentences.front()));
}

/// A stiffness outside the range of hands and devices has a wrong unit. The search over loops would
/// not terminate.
void quantity(std::string_view field, double value) {
  require(value >= kMinQuantity && value <= kMaxQuantity, field, value,
          fmt::format("from {} to {}", kMinQuantity, kMaxQuantity));
}

/// Every case needs a matrix exponential, and the search must terminate. The limits on velocity
/// decay and squared resonance per period far exceed those of real devices. The delay includes the
/// effect of jitter and lost samples.
void check_loop(std::string_view name, const AxisModel& axis, const LoopTiming& timing,
                const HandRange& range) {
  constexpr double kFastest = 1e9;
  const HandRange hand = range.any_passive ? HandRange{} : range;
  const LoopTiming slow = slowest(timing);
  const double damping = axis.damping + hand.damping_max,
               per_mass = slow.period_s / axis.inertia_min;
  require(damping * per_mass <= kFastest, fmt::format("{}.damping", name), damping,
          "at most 1e9 inertias per period");
  require(hand.stiffness_max * slow.period_s * per_mass <= kFastest,
          fmt::format("{}.stiffness_max", name), hand.stiffness_max,
          "at most 1e9 inertias per period squared");
  require(slow.delay_s <= kMaxDelayPeriods * slow.period_s, "the longest delay", slow.delay_s,
          "at most 200 periods");
}

void check_contact(std::string_view name, const ContactRange& contact) {
  quantity(fmt::format("{}.one_point", name), contact.one_point);
  quantity(fmt::format("{}.all_points", name), contact.all_points);
  require(contact.one_point <= contact.all_points, fmt::format("{}.one_point", name),
          contact.one_point, fmt::format("at most all_points, {}", contact.all_points));
}

void check_goals(const DesignProblem& request) {
  const DesignGoals& w = request.goals;
  constexpr std::array kKinds{"auto", "shaping_filter", "spring_damper", "direct"};
  bool known = false;
  for (const std::string_view kind : kKinds)
    known = known || kind == w.kind;
  if (!known)
    throw std::invalid_argument(fmt::format(
        "Coupling design: kind is '{}'; it must be auto, shaping_filter, spring_damper or direct.",
        w.kind));
  positive("cutoff_hz", w.cutoff_hz);
  positive("max_cutoff_hz", w.max_cutoff_hz);
  require(w.cutoff_hz <= w.max_cutoff_hz, "cutoff_hz", w.cutoff_hz,
          fmt::format("at most max_cutoff_hz, {}", w.max_cutoff_hz));
  const double period = request.device.timing.period_s;
  require(2.0 * std::numbers::pi * w.cutoff_hz * period < std::numbers::pi, "cutoff_hz",
          w.cutoff_hz, fmt::format("below half the loop's rate, {:.6g} Hz", 0.5 / period));
  require(w.gain_margin >= 1.0 && std::isfinite(w.gain_margin), "gain_margin", w.gain_margin,
          "1 or above");
  for (const auto& [field, minimum] :
       {std::pair("min_damping.released", w.min_damping.released),
        {"min_damping.gripped", w.min_damping.gripped},
        {"rotation_min_damping.released", w.rotation_min_damping.released},
        {"rotation_min_damping.gripped", w.rotation_min_damping.gripped}})
    require(minimum >= 0.0 && minimum < 1.0, field, minimum, "0 or above, and below 1");
  if (w.damping_force_ratio)
    not_negative("damping_force_ratio", *w.damping_force_ratio);
  not_negative("force_layer_depth_m", w.force_layer_depth_m);
}

}  // namespace

void refuse_impossible(const DesignProblem& request) {
  refuse_first("device", check(request.device));
  refuse_first("hand", check(request.hand.translation));
  if (request.device.gives_torque)
    refuse_first("hand, rotation", check(request.hand.rotation));
  const DeviceModel& device = request.device;
  check_loop("translation", device.translation, device.timing, request.hand.translation);
  if (device.gives_torque)
    check_loop("rotation", device.rotation, device.timing, request.hand.rotation);
  check_contact("contact", request.contact);
  if (device.gives_torque)
    check_contact("contact_rotation", request.contact_rotation);
  check_goals(request);
}

}  // namespace voxtouch::coupling::design
