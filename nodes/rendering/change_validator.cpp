#include "nodes/rendering/change_validator.hpp"

#include <string.h>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/rendering/reload_check.hpp"
#include "nodes/rendering/effect_action.hpp"

namespace voxtouch::rendering_node {
namespace {

using namespace msg::effect_change;

constexpr std::size_t kMaxNameBytes = 64;
/// A change that waits for its sample delays all later requests. The limit keeps that delay
/// acceptable for an operator.
constexpr double kMaxWaitS = 10.0;

bool too_long(const char* text) {
  return text && ::strnlen(text, kMaxNameBytes + 1) > kMaxNameBytes;
}
std::string_view view(const char* text) { return text ? text : ""; }

}  // namespace

ChangeValidator::ChangeValidator(const scene::Scene& scene, const rendering::BuiltScene& built)
    : scene_(scene),
      effects_(scene.effects) {
  come_to_rest();
  set_plan(built);
  sum_up();
}

void ChangeValidator::set_plan(const rendering::BuiltScene& built) {
  plan_ = built.plan();
  largest_shell_gap_m_ = built.largest_shell_gap_m();
}

std::string ChangeValidator::check(const msg::EffectChange& m, std::uint64_t session,
                                   std::uint64_t sample, const PendingChanges& pending) const {
  if (too_long(m.effect) || too_long(m.parameter) || too_long(m.model))
    return fmt::format("name too long, limit {} characters", kMaxNameBytes);
  if (m.action < kActionSwitch || m.action > kActionReload)
    return fmt::format(
        "unknown action {}; valid: 1 switch, 2 gain, 3 parameter, 4 rebuild the scene", m.action);
  if (m.session_id != 0 && m.session_id != session)
    return fmt::format("session {} is not running{}; 0 selects the running session", m.session_id,
                       session == 0 ? ", none is" : fmt::format(" ({} does)", session));
  const double period_s = std::clamp(on_device_.period_s(), 1e-5, 1.0);
  const auto farthest = static_cast<std::uint64_t>(kMaxWaitS / period_s);
  if (m.from_sample > sample + farthest)
    return fmt::format(
        "sample {} is too far ahead, limit {} samples ({:g} s): changes are applied in order and "
        "all later ones would wait",
        m.from_sample, farthest, kMaxWaitS);
  if (m.from_sample > 0 && m.from_sample < pending.last_sample())
    return fmt::format("an earlier request waits for sample {}, and changes are applied in order",
                       pending.last_sample());
  return {};
}

std::string ChangeValidator::check_reload(const msg::EffectChange& m,
                                          const PendingChanges& pending) {
  if (m.voxel_size_m != 0.0 && !(std::isfinite(m.voxel_size_m) && m.voxel_size_m > 0.0))
    return "'voxel_size_m' must be a number > 0 [m], or 0 for the scene's value";
  contact::ContactModelKind kind{};
  if (!view(m.model).empty() && !contact::parse_contact_model(view(m.model), kind))
    return fmt::format("unknown contact model '{}'; valid: original, adapted, field",
                       effects::quotable(view(m.model)));
  if (pending.last_sample() > 0)
    return fmt::format("a change is pending until sample {}; repeat the request after it",
                       pending.last_sample());
  return {};
}

void ChangeValidator::Next::carry_out(const effects::EffectCommand& command) {
  effects::EffectSpec& effect = effects[command.effect];
  voxtouch::effects::carry_out(effect, command);
  reach[command.effect].widen(effect);
}

ChangeValidator::Next ChangeValidator::after(const PendingChanges& pending) const {
  const auto& all = pending.all();
  const auto last = std::find_if(
      all.rbegin(), all.rend(), [](const PendingChange& waits) { return waits.scene.has_value(); });
  Next next = last == all.rend() ? Next{scene_, plan_.of_contact_alone, effects_, reach_}
                                 : Next{*last->scene, last->change.scene->plan().of_contact_alone,
                                        last->effects, effects::at_rest(last->effects)};
  for (auto waits = last.base(); waits != all.end(); ++waits)
    next.carry_out(waits->change.effect);
  return next;
}

std::expected<std::vector<PendingChange>, std::string> ChangeValidator::judge(
    std::span<const msg::EffectChange> changes, std::vector<ChangeRequest> requests,
    const PendingChanges& pending) {
  Next next = after(pending);
  std::vector<effects::EffectRequest> requested;
  for (const msg::EffectChange& m : changes)
    requested.push_back({.action = effect_action(m.action),
                         .effect = view(m.effect),
                         .parameter = view(m.parameter),
                         .value = {m.value[0], m.value[1], m.value[2]}});
  const auto commands = effects::judge(next.effects, requested);
  if (!commands)
    return std::unexpected(commands.error());
  std::vector<PendingChange> out;
  for (const effects::EffectCommand& command : *commands) {
    next.carry_out(command);
    out.push_back({.request = std::move(requests[out.size()])});
    out.back().change.effect = command;
  }
  if (std::string why = check_device(next); !why.empty())
    return std::unexpected(std::move(why));
  return out;
}

std::string ChangeValidator::judge(const PendingChanges& pending) {
  return pending.all().empty() ? "" : check_device(after(pending));
}

std::expected<std::vector<effects::EffectSpec>, std::string> ChangeValidator::judge(
    const scene::Scene& next, const rendering::Plan& plan) {
  std::vector<effects::EffectSpec> effects =
      rendering::carried_over(scene_.effects, effects_, next.effects);
  const device_fit::Refusal why =
      on_device_.check(next, plan.of_contact_alone, effects::at_rest(effects));
  if (!why.empty())
    return std::unexpected(design_text::sentence_of(why));
  return effects;
}

void ChangeValidator::judge_running() {
  on_device_.runs(scene_, plan_.of_contact_alone, {plan_.contact_n_per_m, plan_.contact_nm_per_rad},
                  demand_);
}

void ChangeValidator::apply(PendingChange& done) {
  if (!done.scene) {
    effects::EffectSpec& effect = effects_[done.change.effect.effect];
    effects::carry_out(effect, done.change.effect);
    return reach_[done.change.effect.effect].widen(effect);
  }
  scene_ = std::move(*done.scene);
  effects_ = std::move(done.effects);
  come_to_rest();
  fading_ = demand_;
  set_plan(*done.change.scene);
}

bool ChangeValidator::sum_up() {
  const rendering::StiffnessBounds bounds =
      rendering::with_effects(plan_.of_contact_alone, effects_);
  device_fit::SceneRequirements demand = device_fit::demand_of(scene_, reach_);
  if (fading_)
    demand = device_fit::larger_of(*fading_, demand);
  const bool another =
      demand != demand_ ||
      bounds != rendering::StiffnessBounds{plan_.contact_n_per_m, plan_.contact_nm_per_rad};
  plan_.contact_n_per_m = bounds.translation, plan_.contact_nm_per_rad = bounds.rotation;
  demand_ = std::move(demand);
  return another;
}

}  // namespace voxtouch::rendering_node
