#include "nodes/rendering/scene_reloader.hpp"

#include <chrono>
#include <stdexcept>

#include <fmt/format.h>

#include "core/rendering/reload_check.hpp"
#include "core/scene/scene_file.hpp"
#include "nodes/runtime/realtime.hpp"
#include "nodes/scene_build/build_here.hpp"

namespace voxtouch::rendering_node {

void SceneReloader::start(ChangeRequest request, const scene::Scene& running, double voxel_size_m,
                          std::string model) {
  request_ = std::move(request);
  result_ =
      std::async(std::launch::async, [this, &running, voxel_size_m, model = std::move(model)] {
        runtime::ordinary_priority();
        return build(running, voxel_size_m, model);
      });
}

bool SceneReloader::has_result() const {
  return result_.valid() && result_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

SceneReloader::Result SceneReloader::build(const scene::Scene& running, double voxel_size_m,
                                           const std::string& model) const {
  Result out;
  try {
    out.scene = scene::load_scene(file_);
    out.refusal = rendering::reload_refusal(running, out.scene);
    if (!out.refusal.empty())
      return out;
    if (voxel_size_m > 0.0)
      out.scene.voxel_size_m = voxel_size_m;
    if (!model.empty() && out.scene.virtual_tool() && model != out.scene.contact.model) {
      out.refusal = fmt::format("A virtual tool requires contact model {}, not {}",
                                out.scene.contact.model, model);
      return out;
    }
    if (!model.empty())
      out.scene.contact.model = model;
    const auto go_on = [this] {
      if (stop_.load())
        throw std::runtime_error("the ring has stopped");
    };
    // One thread only, because the ring keeps running.
    out.built = scene_build::build_here(
        out.scene,
        {.who = "rendering", .loop = serial_for(), .go_on = go_on, .reports_progress = false});
  } catch (const std::exception& error) {
    out.refusal = error.what();
  }
  return out;
}

rendering::BuiltScene* SceneReloader::keep(std::unique_ptr<rendering::BuiltScene> scene) {
  scenes_.push_back(std::move(scene));
  return scenes_.back().get();
}

void SceneReloader::release(const rendering::BuiltScene* scene) {
  std::erase_if(scenes_, [&](const auto& kept) { return kept.get() == scene; });
}

}  // namespace voxtouch::rendering_node
