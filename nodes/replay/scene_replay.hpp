#pragma once
/// The rendering of a recorded run once more: scene, effects as they were set, and each sample
/// through them.
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/device_fit/device_compatibility.hpp"
#include "core/scene/scene.hpp"
#include "nodes/rendering/sample_renderer.hpp"
#include "nodes/replay/recording.hpp"

namespace voxtouch::replay {

/// Performs the work of the node's loop and of its update server in one thread, each at its sample.
class SceneReplay {
 public:
  /// Builds `scene`. Throws as rendering::build_scene and mesh readers do.
  explicit SceneReplay(const scene::Scene& scene);
  SceneReplay(const SceneReplay&) = delete;
  SceneReplay& operator=(const SceneReplay&) = delete;

  /// `begin_ns`: as SampleRenderer::begin_session.
  void begin_session(const coupling::design::DeviceModel& device,
                     std::optional<std::int64_t> begin_ns);
  /// Applies the first of `changes`, which have the same first sample. They may be combined:
  /// validated by the state after all of them. Returns why it was refused, or an empty text. Builds
  /// the scene if requested.
  std::string apply(std::span<const RecordedChange> changes);
  /// The effect `external` is given this, and `next` is the first sample to see it.
  void take_external(const msg::ExternalSample& sample, const msg::DeviceState& next) noexcept;
  /// `time_spent_ns` is 0. `recorded`: the answer in the bag of a run in real time of this scene,
  /// or null. It decides at which sample a spring that was found takes the place of the one before.
  msg::ContactState answer(const msg::DeviceState& state,
                           const msg::ContactState* recorded) noexcept;

  /// Bounds and requirements of contact and effects with their present values, in W, as the plan
  /// reports them to the coupling.
  const rendering::StiffnessBounds& bounds() const noexcept { return bounds_; }
  device_fit::SceneRequirements demand() const;
  const std::string& scene_hash() const noexcept { return scene_.hash; }

 private:
  std::string change_effect(std::span<const RecordedChange> changes);
  std::string reload(const RecordedChange& change);
  void sum_up();
  void take_springs(const msg::ContactState* recorded) noexcept;

  struct Springs {
    double tool_n_per_m = 0.0;
    rendering::Compliance series;
    bool operator==(const Springs&) const = default;
  };

  scene::Scene scene_;
  std::vector<std::unique_ptr<rendering::BuiltScene>>
      built_;  ///< all scenes so far: the renderer refers to the last two
  std::vector<effects::EffectSpec> settled_;  ///< the effects with their present values
  rendering::StiffnessBounds bounds_;
  device_fit::DeviceCompatibility on_device_;
  std::vector<Springs>
      found_;  ///< of this session, in the order in which they were; one of them is in use
  std::size_t in_use_ = 0;
  rendering_node::SampleRenderer renderer_;
};

}  // namespace voxtouch::replay
