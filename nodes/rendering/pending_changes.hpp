#pragma once
/// Changes that the loop has received and not reported yet.
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "nodes/rendering/change_queue.hpp"
#include "nodes/rendering/kept_change.hpp"

namespace voxtouch::rendering_node {

/// The parts of a request that are needed later.
struct ChangeRequest {
  std::uint64_t id = 0, session = 0, from_sample = 0;
  std::string what{};  ///< for the reply: "'viscosity' off"
  /// Sends the final reply to a service client.
  std::function<void(bool done, std::uint64_t from_sample, const std::string& sentence)> reply{};
  KeptChange change{};  ///< for the record
};

struct PendingChange {
  ChangeRequest request;
  Change change{};
  std::optional<scene::Scene> scene{};         ///< of a reload
  std::vector<effects::EffectSpec> effects{};  ///< of a reload: initial effect settings
  std::string refusal{};                       ///< found after the loop had received the change
};

class PendingChanges {
 public:
  const std::deque<PendingChange>& all() const noexcept { return all_; }
  bool contains(std::uint64_t id) const;
  /// The sample that the last change waits for; 0 if no change waits for one.
  std::uint64_t last_sample() const noexcept {
    return all_.empty() ? 0 : all_.back().change.from_sample;
  }
  /// Queues all of them for the same sample. Returns false if the queue has no room.
  bool hand_over(std::vector<PendingChange> changes, ChangeQueue& line);
  /// Makes the loop drop all of them.
  void cancel(const std::string& refusal, ChangeQueue& line);
  /// Removes the oldest change, which the loop has reported.
  PendingChange take();
  void set_epoch(std::uint64_t epoch) noexcept { epoch_ = epoch; }

 private:
  std::deque<PendingChange> all_;
  std::uint64_t ticket_ = 0, epoch_ = 0;
};

}  // namespace voxtouch::rendering_node
