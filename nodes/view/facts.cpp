#include "nodes/view/facts.hpp"

#include <fmt/format.h>

#include "nodes/view/rounded.hpp"

namespace voxtouch::view {
namespace {

using nlohmann::json;

template <class Strings>
json texts(const Strings& strings) {
  json all = json::array();
  for (std::uint32_t n = 0; n < strings._length; ++n)
    all.push_back(strings._buffer[n]);
  return all;
}

json values_of(const effects::EffectParameter& parameter, const std::array<double, 3>& value) {
  json values = json::array();
  for (std::size_t n = 0; n < (parameter.shape == effects::ParameterShape::kNumber ? 1 : 3); ++n)
    values.push_back(rounded(value[n]));
  return values;
}

json effect_json(const effects::EffectSpec& effect) {
  json parameters = json::array();
  for (std::size_t n = 0; n < effect.kind->parameters.size(); ++n) {
    const effects::EffectParameter& p = effect.kind->parameters[n];
    if (p.shape == effects::ParameterShape::kWord || p.shape == effects::ParameterShape::kText)
      continue;  // never changes while running
    parameters.push_back({{"name", p.name},
                          {"meaning", p.meaning},
                          {"low", rounded(p.low)},
                          {"high", rounded(p.high)},
                          {"value", values_of(p, effect.values.at(n))}});
  }
  return {{"name", effect.name},
          {"says", effect.kind->summary},
          {"on", effect.on},
          {"gain", rounded(effect.gain)},
          {"fixed", effect.kind->everywhere},
          {"parameters", parameters}};
}

}  // namespace

std::string design_sentence(const msg::CouplingDesign& d) {
  const std::string kind = d.kind;
  std::string what = kind == "shaping_filter"
                         ? fmt::format("shaping filter {:.3g} Hz, gain {:.3g}", d.cutoff_hz, d.gain)
                     : kind == "spring_damper"
                         ? fmt::format("spring {:.4g} N/m, damper {:.3g} Ns/m", d.stiffness_n_per_m,
                                       d.damping_ns_per_m)
                         : kind;
  if (d.injected_damping_ns_per_m > 0.0)
    what += fmt::format(", {:.3g} Ns/m injected", d.injected_damping_ns_per_m);
  if (d.displayed_stiffness_n_per_m > 0.0)
    what += fmt::format(": certified {:.4g} N/m, stability limit {:.4g} N/m",
                        d.displayed_stiffness_n_per_m, d.critical_stiffness_n_per_m);
  return what;
}

void Facts::take(const msg::ScenePlan& p) {
  scene_hash_ = p.scene_hash;
  plan_ = {
      {"scene", p.scene}, {"model", p.contact_model}, {"voxel_size_m", rounded(p.voxel_size_m)}};
}

void Facts::take(const msg::CouplingDesign& d) {
  design_ = {{"sentence", design_sentence(d)},
             {"status", d.status},
             {"worst_case", d.worst_case},
             {"reasons", texts(d.reasons)}};
}

void Facts::take(const msg::DeviceDescription& d) {
  device_ = {{"model", d.model},
             {"max_force_n", rounded(d.max_force_n)},
             {"simulated", d.simulated},
             {"lockstep", d.lockstep}};
}

void Facts::take(const msg::EffectChange& c) {
  constexpr std::size_t kMaxChanges = 64;  // any participant may send some
  if (unanswered_.size() >= kMaxChanges)
    unanswered_.erase(unanswered_.begin());
  unanswered_[c.request] = {c.action, c.effect, c.parameter, {c.value[0], c.value[1], c.value[2]}};
}

void Facts::take(const msg::EffectChanged& a) {
  constexpr std::size_t kMaxAnswers = 12;
  constexpr const char* kResults[] = {"", "waiting", "done", "refused"};
  answers_.push_back({{"request", std::to_string(a.request)},
                      {"result", a.result < std::size(kResults) ? kResults[a.result] : ""},
                      {"sentence", a.sentence},
                      {"from_sample", a.from_sample}});
  if (answers_.size() > kMaxAnswers)
    answers_.pop_front();
  if (a.result == msg::effect_changed::kResultPending)
    return;
  const auto change = unanswered_.extract(a.request);
  if (change && a.result == msg::effect_changed::kResultDone)
    apply(change.mapped());
}

void Facts::apply(const runtime::ChangeRequest& change) {
  using namespace msg::effect_change;
  for (json& effect : effects_) {
    if (effect["name"] != change.effect)
      continue;
    if (change.action == kActionSwitch)
      effect["on"] = change.value[0] != 0.0;
    if (change.action == kActionGain)
      effect["gain"] = rounded(change.value[0]);
    if (change.action != kActionValue)
      continue;
    for (json& parameter : effect["parameters"])
      if (parameter["name"] == change.parameter)
        for (std::size_t n = 0; n < parameter["value"].size(); ++n)
          parameter["value"][n] = rounded(change.value[n]);
  }
}

void Facts::set_scene(const scene::Scene& scene) {
  has_virtual_tool_ = scene.virtual_tool();
  effects_ = json::array();
  for (const effects::EffectSpec& effect : scene.effects)
    effects_.push_back(effect_json(effect));
  first_effects_ = effects_;
}

json Facts::to_json() const {
  json plan = plan_;
  if (!plan.is_null())
    plan["virtual_tool"] = has_virtual_tool_;
  return {{"plan", plan},
          {"design", design_},
          {"device", device_},
          {"effects", effects_},
          {"answers", answers_}};
}

}  // namespace voxtouch::view
