#include "nodes/replay/scene_replay.hpp"

#include "core/rendering/reload_check.hpp"
#include "core/scene/scene_file.hpp"
#include "nodes/rendering/effect_action.hpp"
#include "nodes/replay/loop_arithmetic.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/scene_build/build_here.hpp"

namespace voxtouch::replay {
namespace {

std::unique_ptr<rendering::BuiltScene> built_from(const scene::Scene& scene,
                                                  const scene_build::CacheOptions& cache) {
  return scene_build::build_here(scene, {.who = "replay", .cache = cache});
}

}  // namespace

SceneReplay::SceneReplay(const scene::Scene& scene, const scene_build::CacheOptions& cache)
    : cache_(cache),
      scene_(scene),
      settled_(scene.effects),
      renderer_(scene_.device, *built_.emplace_back(built_from(scene, cache))) {
  sum_up();
}

void SceneReplay::begin_session(const coupling::design::DeviceModel& device,
                                std::optional<std::int64_t> begin_ns) {
  renderer_.begin_session(begin_ns);
  on_device_.device_is(device);
  sum_up();
}

void SceneReplay::sum_up() {
  bounds_ = rendering::with_effects(built_.back()->plan().of_contact_alone, settled_);
  on_device_.runs(scene_, bounds_, demand());
}

fitting::DeviceDemand SceneReplay::demand() const {
  return fitting::demand_of(scene_, effects::at_rest(settled_));
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
    if (!change.asked || change.action == msg::effect_change::kActionReload)
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
    auto built = built_from(next, cache_);
    std::vector<effects::EffectSpec> effects =
        rendering::carried_over(scene_.effects, settled_, next.effects);
    built->scene_renderer().effects() = effects::EffectChain(effects);
    renderer_.live()
        .finish();  // over, where the bag is whole: the loop takes no scene while another fades in
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
  const LoopArithmetic arithmetic;
  renderer_.take_external(runtime::from_msg(sample.wrench), next);
}

msg::ContactState SceneReplay::answer(const msg::DeviceState& state) noexcept {
  const LoopArithmetic arithmetic;
  renderer_.live().aim_for_spring(on_device_.spring_n_per_m());
  return renderer_.answer(state);
}

}  // namespace voxtouch::replay
