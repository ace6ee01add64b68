#pragma once
/// What the page shows in addition to the picture: plan, design, device, effects and what became of
/// changes. Messages in, JSON out. One thread.
#include <cstdint>
#include <deque>
#include <map>
#include <string>

#include <nlohmann/json.hpp>

#include "core/scene/scene.hpp"
#include "nodes/runtime/change_asker.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::view {

class Facts {
 public:
  /// What the ring says of itself; the newest of each is kept.
  void take(const msg::ScenePlan& plan);
  void take(const msg::CouplingDesign& design);
  void take(const msg::DeviceDescription& device);
  /// A change that was asked for; it holds once its answer says so.
  void take(const msg::EffectChange& change);
  void take(const msg::EffectChanged& answer);
  /// The effects as this scene's file says.
  void scene_is(const scene::Scene& scene);
  /// A recorded run is shown from another place on: the effects are as the file says again, and
  /// nothing was asked.
  void restart() { effects_ = first_effects_, unanswered_.clear(), answers_.clear(); }

  /// Of the plan that runs; empty where none is known.
  const std::string& scene_hash() const noexcept { return scene_hash_; }
  /// {plan, design, device, effects, answers}
  nlohmann::json to_json() const;

 private:
  void apply(const runtime::ChangeRequest& change);

  nlohmann::json plan_, design_, device_, effects_ = nlohmann::json::array(),
                                          first_effects_ = effects_;
  std::string scene_hash_;
  std::map<std::uint64_t, runtime::ChangeRequest> unanswered_;
  std::deque<nlohmann::json> answers_;  ///< the last ones
};

/// The design in one line for people.
std::string design_sentence(const msg::CouplingDesign& design);

}  // namespace voxtouch::view
