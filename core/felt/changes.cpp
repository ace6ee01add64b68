#include "core/felt/changes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/fitting/design_problem.hpp"

namespace voxtouch::felt {
namespace {

using coupling::design::DeviceModel;

const effects::EffectSpec* body_of(const scene::Scene& scene) {
  const auto found = std::ranges::find_if(
      scene.effects, [](const effects::EffectSpec& e) { return e.kind->needs(e.values).body; });
  return found == scene.effects.end() ? nullptr : &*found;
}

/// The place of a parameter among its kind's.
std::size_t parameter(const effects::EffectSpec& effect, std::string_view name) {
  const auto& all = effect.kind->parameters;
  return static_cast<std::size_t>(
      std::ranges::find_if(all, [&](const auto& p) { return p.name == name; }) - all.begin());
}

/// Two digits, not rounded up.
double two_digits(double value) {
  const double step = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return std::floor(value / step) * step;
}

class Finder {
 public:
  Finder(const Felt& now, double now_n, rendering::BuiltScene& built, const Motion* motion,
         std::size_t most, Search search)
      : now_(now),
        now_n_(now_n),
        built_(built),
        motion_(motion),
        most_(most),
        search_(search) {}

  std::vector<Change> find() {
    const coupling::design::AxisModel& device = now_.device.translation;
    if (now_n_ >= 0.999 * device.max_effort ||
        stiffness_n_per_m(now_) >= 0.999 * device.max_stiffness)
      return {};  // all that the device gives
    if (body_of(now_.scene))
      grip();
    else if (!now_.scene.virtual_tool())
      contact();
    if (coupling_limits())
      coupling();
    if (coupling_limits() && found_.size() < most_)
      laboratory();
    std::ranges::stable_sort(found_, std::greater{}, &Change::force_n);
    found_.resize(std::min(most_, found_.size()));
    return std::move(found_);
  }

 private:
  /// Whether the coupling could pass on more than contact or grip have.
  bool coupling_limits() const {
    if (body_of(now_.scene))
      return stiffness_n_per_m(now_) < 0.999 * grip_at_hand();
    return true;
  }
  double grip_at_hand() const {
    return bounds_of(now_).translation.one_point *
           fitting::hand_scales(now_.scene.device).translation;
  }

  bool gives(std::string what, const std::function<void(Felt&)>& change) {
    if (search_ == Search::kKnown || (search_ == Search::kFirst && found_.size() >= most_))
      return false;
    Felt with = now_;
    change(with);
    const rendering::StiffnessBounds bounds = bounds_of(with);
    with.fitted =
        fitting::fit_coupling(with.scene, with.device, bounds, fitting::demand_of(with.scene));
    return counts({std::move(what), force_n(with, built_, motion_)});
  }
  bool counts(Change change) {
    if (!(change.force_n > 0.0 && change.force_n >= kWorthTelling * now_n_))
      return false;
    found_.push_back(std::move(change));
    return true;
  }

  void coupling() {
    const fitting::FittedCoupling& fitted = now_.fitted;
    if (!now_.scene.design) {
      gives("coupling: {design: auto}", [](Felt& f) { f.scene.design.emplace(); });
      return;
    }
    const scene::DesignOptions& asked = *now_.scene.design;
    without_floor(asked);
    if (asked.kind == "shaping_filter")
      gives("coupling.kind: direct", [](Felt& f) { f.scene.design->kind = "direct"; });
    if (asked.kind == "spring_damper" || asked.kind == "direct")
      gives("coupling.kind: auto", [](Felt& f) { f.scene.design->kind = "auto"; });
    if (asked.stiffness_cap_n_per_m || asked.stiffness_cap_nm_per_rad)
      gives("a coupling without caps", [](Felt& f) {
        f.scene.design->stiffness_cap_n_per_m = f.scene.design->stiffness_cap_nm_per_rad =
            std::nullopt;
      });
    if (!asked.inject_damping)
      gives("coupling.inject_damping: true",
            [](Felt& f) { f.scene.design->inject_damping = true; });
    if (!asked.velocity_windows)
      gives("coupling.velocity_windows: true",
            [](Felt& f) { f.scene.design->velocity_windows = true; });
    if (fitted.spec.damper_share > 0.0 && fitted.spec.injected_damping_ns_per_m > 0.0)
      gives("coupling.damper_share: 0, with which a blow is felt as hard as its speed,",
            [](Felt& f) { f.scene.design->damper_share = 0.0; });
    if (asked.released && asked.hand != scene::HandOption::kAnyPassive)
      gives("coupling.released: false, where somebody always holds the device,",
            [](Felt& f) { f.scene.design->released = false; });
    lever();
  }

  /// What would be shown without it with the same share of the damper was worked out in the fit,
  /// which is known at once; another share may show more.
  void without_floor(const scene::DesignOptions& asked) {
    const coupling::design::Design& design = now_.fitted.design;
    const double cost = design.floors.cost_n_per_m, cost_turning = design.floors.cost_nm_per_rad;
    if (!(asked.damping_floor > 0.0) || !(cost > 0.0 || cost_turning > 0.0))
      return;
    const std::string what = "coupling.damping_floor: 0, with which swings take longer to die out,";
    if (search_ != Search::kKnown || !rendering::is_spring(now_.contact) ||
        !now_.scene.effects.empty() || asked.rotation_damping_floor > 0.0) {
      gives(what, [](Felt& f) { f.scene.design->damping_floor = 0.0; });
      return;
    }
    const double lever2 = now_.contact.rotation.one_point / now_.contact.translation.one_point /
                          std::pow(now_.scene.device.position_scale, 2);
    const double along = design.translation.shown_stiffness + cost,
                 turning = (design.rotation.shown_stiffness + cost_turning) / lever2;
    counts(
        {what, std::min((now_.device.gives_torque ? std::min(along, turning) : along) * kDepthToldM,
                        now_.device.translation.max_effort)});
  }

  /// Where turning asks for more than the shift does.
  void lever() {
    const rendering::StiffnessBounds bounds = bounds_of(now_);
    if (!rendering::is_spring(bounds))
      return;
    const double shown = fitting::spring_n_per_m(now_.fitted, now_.scene, now_.device, bounds),
                 along = fitting::spring_n_per_m(now_.fitted, now_.scene, now_.device,
                                                 {bounds.translation, {}});
    const double lever_m = two_digits(std::sqrt(shown / along * now_.contact.rotation.one_point /
                                                now_.contact.translation.one_point));
    if (along > kWorthTelling * shown)
      gives(fmt::format("tool.lever_m: {:.2g}", lever_m), [&](Felt& f) {
        f.scene.lever_m = lever_m, f.contact = rendering::spring_of_any_device(lever_m);
      });
  }

  void grip() {
    if (coupling_limits())
      return;
    const effects::EffectSpec& body = *body_of(now_.scene);
    const std::size_t at = parameter(body, "grip_n_per_m"),
                      which = static_cast<std::size_t>(&body - now_.scene.effects.data());
    const double largest = std::min(body.kind->parameters[at].high,
                                    fitting::largest_spring_n_per_m(now_.scene, now_.device));
    for (double grip = two_digits(largest); grip > kWorthTelling * body.values.number(at);
         grip = two_digits(0.5 * grip))
      if (gives(fmt::format("body.grip_n_per_m: {:.4g}", grip),
                [&](Felt& f) { f.scene.effects[which].values.at(at)[0] = grip; }))
        break;
    stronger();
  }

  /// Of forces of depth.
  void contact() {
    if (const double shown = as_virtual_tool(); shown > 0.0)
      counts({"contact: {model: field, rendering: virtual_tool}",
              std::min(shown * kDepthToldM, now_.device.translation.max_effort)});
    stronger();
  }

  /// Stiffness at the hand. A device without torque gets the same design where contact and spring
  /// both have more than it can show.
  double as_virtual_tool() const {
    if (!now_.scene.design)
      return 0.0;
    Felt with = now_;
    with.scene.contact = {.model = "field", .rendering = scene::RenderingKind::kVirtualTool};
    with.contact = rendering::spring_of_any_device(
        now_.scene.lever_m.value_or(built_.renderer().query().reach_m()));
    const double all =
        now_.contact.translation.all_points * fitting::hand_scales(now_.scene.device).translation;
    const bool same = !now_.device.gives_torque && now_.scene.effects.empty() &&
                      all >= now_.device.translation.max_stiffness;
    if (same)
      return now_.fitted.design.translation.shown_stiffness;
    if (search_ == Search::kKnown)
      return 0.0;
    with.fitted = fitting::fit_coupling(with.scene, with.device, bounds_of(with),
                                        fitting::demand_of(with.scene));
    return stiffness_n_per_m(with);
  }

  /// More newtons at the hand for each of the scene: a stiffer contact, where there is nothing
  /// else.
  void stronger() {
    for (const double times : {10.0, 3.0}) {
      const scene::ContactSpec& c = now_.scene.contact;
      const bool by_area = c.stiffness_n_per_m3 > 0.0,
                 contact_alone = now_.scene.effects.empty() && now_.scene.objects.empty();
      const std::string what =
          contact_alone
              ? fmt::format("contact.{}: {:g}",
                            by_area ? "stiffness_n_per_m3" : "stiffness_n_per_m",
                            times * (by_area ? c.stiffness_n_per_m3 : c.stiffness_n_per_m))
              : fmt::format("device.force_scale: {:g}", times * now_.scene.device.force_scale);
      if (gives(what, [&](Felt& f) { f.scene.device.force_scale *= times; }))
        return;
    }
  }

  /// What another bus, card or device is needed for.
  void laboratory() {
    const coupling::design::LoopTiming& timing = now_.device.timing;
    if (timing.delay_s > 0.0)
      gives(fmt::format("a delay of {:.3g} ms instead of {:.3g}", 500.0 * timing.delay_s,
                        1e3 * timing.delay_s),
            [](Felt& f) { f.device.timing.delay_s *= 0.5; });
    gives(fmt::format("a rate of {:.4g} Hz instead of {:.4g}", 2.0 / timing.period_s,
                      1.0 / timing.period_s),
          [](Felt& f) { f.device.timing.period_s *= 0.5; });
  }

  const Felt& now_;
  double now_n_;
  rendering::BuiltScene& built_;
  const Motion* motion_;
  std::size_t most_;
  Search search_;
  std::vector<Change> found_;
};

}  // namespace

rendering::StiffnessBounds bounds_of(const Felt& felt) {
  return rendering::with_effects(felt.contact, felt.scene.effects);
}

double stiffness_n_per_m(const Felt& felt) {
  if (!felt.fitted.refusal.empty())
    return 0.0;
  const rendering::StiffnessBounds bounds = bounds_of(felt);
  const double in_scene =
      rendering::is_spring(bounds)
          ? fitting::spring_n_per_m(felt.fitted, felt.scene, felt.device, bounds)
      : body_of(felt.scene) != nullptr ? bounds.translation.one_point
                                       : 0.0;
  return in_scene > 0.0
             ? fitting::stiffness_at_hand_n_per_m(felt.fitted.spec, felt.scene.device, in_scene)
             : 0.0;
}

double force_n(const Felt& felt, rendering::BuiltScene& built, const Motion* motion) {
  if (!felt.fitted.refusal.empty())
    return 0.0;
  if (rendering::is_spring(felt.contact) || body_of(felt.scene))
    return std::min(stiffness_n_per_m(felt) * kDepthToldM, felt.device.translation.max_effort);
  if (!motion)
    return 0.0;
  const std::vector<Pressed> pressed = press(built, felt.scene, felt.fitted, felt.device, *motion);
  return pressed.empty() ? 0.0 : pressed.back().force_n;
}

std::vector<Change> changes(const Felt& now, double now_n, rendering::BuiltScene& built,
                            const Motion* motion, std::size_t most, Search search) {
  return Finder(now, now_n, built, motion, most, search).find();
}

}  // namespace voxtouch::felt
