#pragma once
/// Changes while the ring runs: validated, given to the loop, answered.
#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <thread>

#include "nodes/rendering/change_inbox.hpp"
#include "nodes/rendering/plan_publisher.hpp"
#include "nodes/rendering/rendering_node.hpp"
#include "nodes/rendering/scene_reloader.hpp"
#include "nodes/runtime/counters.hpp"

namespace voxtouch::rendering_node {

/// A device, as it has described itself for a session.
struct DescribedDevice {
  std::uint64_t session = 0;
  coupling::design::DeviceModel model;
};

enum class ChangeCounter : std::uint8_t { kWarnings, kChanges, kReloads };
inline constexpr auto kChangeTable = [] {
  using enum ChangeCounter;
  using enum runtime::Counting;
  return std::to_array<runtime::CounterRow<ChangeCounter>>({
      {kWarnings, "warnings", "warnings", kLast},
      {kChanges, "changes", "changes"},
      {kReloads, "reloads", "reloads"},
  });
}();

/// A thread of ordinary priority. The loop meets it only at `line`, `set_device` and the publisher,
/// and waits for it at neither.
class SceneUpdateServer {
 public:
  /// `first` is the scene that runs, built from `scene`. Both functions are called from the
  /// server's thread: `swapped` where another scene has taken its place, `begun` where a session's
  /// plan has been published and the scene judged on its device. The line outlives the server.
  SceneUpdateServer(
      const bus::Participant& participant, const Options& options, const scene::Scene& scene,
      std::unique_ptr<rendering::BuiltScene> first, ChangeQueue& line,
      std::function<void(const scene::Scene&)> swapped,
      std::function<void(std::uint64_t)> begun = [](std::uint64_t) {});
  /// The loop has ended: none of the scenes is rendered any more.
  ~SceneUpdateServer();
  SceneUpdateServer(const SceneUpdateServer&) = delete;
  SceneUpdateServer& operator=(const SceneUpdateServer&) = delete;

  /// From the loop, where a device describes itself: a session begins, or goes on with another
  /// device. Neither waits nor locks; of two that come at once the later one counts.
  void device_is(std::unique_ptr<DescribedDevice> device) noexcept {
    delete described_.exchange(device.release());
  }
  /// Publishes the plan of the session once more, for a node that has missed it. Not in lockstep.
  void remind() noexcept { remind_.store(true, std::memory_order_release); }
  const PlanPublisher& published() const noexcept { return publisher_; }
  runtime::Figures figures() const;
  /// As ChangeInbox.
  std::map<bus::Guid, std::uint64_t> requests() const { return inbox_.requests(); }

 private:
  void cycle();
  void follow_device();
  void receive(std::span<const msg::EffectChange> changes, bool together,
               std::vector<ChangeRequest> requests);
  std::string check(std::span<const msg::EffectChange> changes, bool together) const;
  void receive_effects(std::span<const msg::EffectChange> changes,
                       std::vector<ChangeRequest> requests);
  void receive_reload(const msg::EffectChange& m, ChangeRequest request);
  bool pause_before(std::uint64_t sample);
  std::string wait_text(const ChangeRequest& request) const;
  void finish_reload();
  void handle_report(const ChangeReport& report);
  void applied(PendingChange& done, const ChangeReport& report);
  void show(std::uint64_t from_sample, bool another_scene = false);
  void judge_running();

  ChangeQueue& line_;
  std::function<void(const scene::Scene&)> swapped_;
  std::function<void(std::uint64_t)> begun_;
  ChangeValidator validator_;
  PlanPublisher publisher_;
  SceneReloader reloader_;
  PendingChanges pending_;
  ChangeInbox inbox_;
  runtime::Counters<kChangeTable> counters_;
  std::atomic<DescribedDevice*> described_{nullptr};
  std::atomic<bool> remind_{false};
  std::jthread thread_;
};

}  // namespace voxtouch::rendering_node
