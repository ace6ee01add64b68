#pragma once
/// Changes that the loop has been given and has not reported yet.
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "nodes/rendering/change_queue.hpp"
#include "nodes/rendering/kept_change.hpp"

namespace voxtouch::rendering_node {

/// What of a request is needed later.
struct ChangeRequest {
  std::uint64_t id = 0, session = 0, from_sample = 0;
  std::string what{};  ///< for the answer: "'viscosity' off"
  /// Gives a service's client the final answer.
  std::function<void(bool done, std::uint64_t from_sample, const std::string& sentence)> reply{};
  KeptChange change{};  ///< for the record
};

struct PendingChange {
  ChangeRequest request;
  Change change{};
  std::optional<scene::Scene> scene{};         ///< of a reload ...
  std::vector<effects::EffectSpec> effects{};  ///< ... and what its effects begin with
  std::string refusal{};                       ///< found after the loop had been given it
};

class PendingChanges {
 public:
  const std::deque<PendingChange>& all() const noexcept { return all_; }
  bool contains(std::uint64_t id) const;
  /// The sample that the last one waits for; 0: none waits for one.
  std::uint64_t last_sample() const noexcept {
    return all_.empty() ? 0 : all_.back().change.from_sample;
  }
  /// All of them in the same sample. False where the loop's queue has no room.
  bool hand_over(std::vector<PendingChange> changes, ChangeQueue& line);
  /// The loop drops all of them.
  void cancel(const std::string& refusal, ChangeQueue& line);
  /// The oldest, which the loop has reported.
  PendingChange take();
  void set_epoch(std::uint64_t epoch) noexcept { epoch_ = epoch; }

 private:
  std::deque<PendingChange> all_;
  std::uint64_t ticket_ = 0, epoch_ = 0;
};

}  // namespace voxtouch::rendering_node
