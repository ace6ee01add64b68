#include "nodes/replay/scene_replay.hpp"

#include <algorithm>

#include "core/rendering/reload_check.hpp"
#include "core/scene/scene_file.hpp"
#include "nodes/rendering/effect_action.hpp"
#include "nodes/replay/flush_denormals_guard.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/scene_build/build_here.hpp"

namespace voxtouch::replay {
namespace {

std::unique_ptr<rendering::BuiltScene> built_from(const scene::Scene& scene) {
  return scene_build::build_here(scene, {.who = "replay"});
}

}  // namespace

SceneReplay::SceneReplay(const scene::Scene& scene)
    : scene_(scene),
      settled_(scene.effects),
      renderer_(scene_.device, *built_.emplace_back(built_from(scene))) {
  sum_up();
}

void SceneReplay::begin_session(const coupling::design::DeviceModel& device,
                                std::optional<std::int64_t> begin_ns) {
  renderer_.begin_session(begin_ns);
  on_device_.set_device(device);
  found_.clear(), in_use_ = 0;
  sum_up();
}

void SceneReplay::sum_up() {
  bounds_ = rendering::with_effects(built_.back()->plan().of_contact_alone, settled_);
  on_device_.runs(scene_, built_.back()->plan().of_contact_alone, bounds_, demand());
  found_.push_back({on_device_.spring_n_per_m(), on_device_.series_spring()});
}

device_fit::SceneRequirements SceneReplay::demand() const {
  return device_fit::demand_of(scene_, effects::at_rest(settled_));
}

std::string SceneReplay::apply(std::span<const RecordedChange> changes) {
  const RecordedChange& change = changes.front();
  std::string why =
      change.action == msg::effect_change::kActionReload ? reload(change) : change_effect(changes);
  sum_up();
  return why;
}

std::string SceneReplay::change_effect(std::span<const RecordedChange> changes) {
  std::vector<effects::EffectRequest> requests;
  for (const RecordedChange& change : changes) {
    if (!change.requested || change.action == msg::effect_change::kActionReload)
      break;
    requests.push_back({.action = rendering_node::effect_action(change.action),
                        .effect = change.effect,
                        .parameter = change.parameter,
                        .value = change.value});
  }
  const auto commands = effects::judge(settled_, requests);
  if (!commands)
    return commands.error();
  const effects::EffectCommand& command = commands->front();
  renderer_.live().effects().carry_out(command);
  effects::carry_out(settled_[command.effect], command);
  return {};
}

std::string SceneReplay::reload(const RecordedChange& change) {
  try {
    scene::Scene next = scene::load_scene(scene_.file);
    if (change.voxel_size_m > 0.0)
      next.voxel_size_m = change.voxel_size_m;
    if (!change.model.empty())
      next.contact.model = change.model;
    auto built = built_from(next);
    std::vector<effects::EffectSpec> effects =
        rendering::carried_over(scene_.effects, settled_, next.effects);
    built->scene_renderer().effects() = effects::EffectChain(effects);
    renderer_.live()
        .finish();  // finished, if the bag is complete: the loop accepts no scene during a fade
    renderer_.live().swap_to(*built);
    built_.push_back(std::move(built));
    scene_ = std::move(next), settled_ = std::move(effects);
  } catch (const std::exception& error) {
    return error.what();
  }
  return {};
}

void SceneReplay::take_external(const msg::ExternalSample& sample,
                                const msg::DeviceState& next) noexcept {
  const FlushDenormalsGuard arithmetic;
  renderer_.take_external(runtime::from_msg(sample.wrench), next);
}

/// Selects a result of the search: the last one, or that of the recorded answer.
void SceneReplay::take_springs(const msg::ContactState* recorded) noexcept {
  if (!recorded) {
    in_use_ = found_.size() - 1;
  } else {
    const Springs named{
        recorded->spring_n_per_m,
        {recorded->series_m_per_n, recorded->series_rad_per_nm, recorded->series_effects_m_per_n}};
    const auto from = found_.begin() + static_cast<std::ptrdiff_t>(in_use_),
               match = std::find(from, found_.end(), named);
    if (match != found_.end())
      in_use_ = static_cast<std::size_t>(match - found_.begin());
  }
  renderer_.live().set_spring_target(found_[in_use_].tool_n_per_m);
  renderer_.live().set_series_target(found_[in_use_].series);
}

msg::ContactState SceneReplay::answer(const msg::DeviceState& state,
                                      const msg::ContactState* recorded) noexcept {
  const FlushDenormalsGuard arithmetic;
  take_springs(recorded);
  return renderer_.answer(state);
}

}  // namespace voxtouch::replay
