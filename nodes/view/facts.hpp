#pragma once
/// Slowly changing data of the page: plan, design, device, effects, results of changes. Messages
/// in, JSON out. One thread.
#include <cstdint>
#include <deque>
#include <map>
#include <string>

#include <nlohmann/json.hpp>

#include "core/scene/scene.hpp"
#include "nodes/runtime/change_client.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::view {

class Facts {
 public:
  /// Keeps the newest message of each type.
  void take(const msg::ScenePlan& plan);
  void take(const msg::CouplingDesign& design);
  void take(const msg::DeviceDescription& device);
  /// A requested change; it is applied when its answer arrives.
  void take(const msg::EffectChange& change);
  void take(const msg::EffectChanged& answer);
  /// Takes the effects of the scene file.
  void set_scene(const scene::Scene& scene);
  /// Resets the effects to the scene file and clears all changes, for a jump in a recording.
  void restart() { effects_ = first_effects_, unanswered_.clear(), answers_.clear(); }

  /// Of the running plan; empty if unknown.
  const std::string& scene_hash() const noexcept { return scene_hash_; }
  /// {plan, design, device, effects, answers}
  nlohmann::json to_json() const;

 private:
  void apply(const runtime::ChangeRequest& change);

  nlohmann::json plan_, design_, device_, effects_ = nlohmann::json::array(),
                                          first_effects_ = effects_;
  bool has_virtual_tool_ = false;
  std::string scene_hash_;
  std::map<std::uint64_t, runtime::ChangeRequest> unanswered_;
  std::deque<nlohmann::json> answers_;  ///< the last ones
};

/// The design in one line.
std::string design_sentence(const msg::CouplingDesign& design);

}  // namespace voxtouch::view
