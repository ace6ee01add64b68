#pragma once
/// Handles run-time change requests: validate, queue for the loop, reply.
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

/// A device description for one session.
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

/// Runs in a thread of ordinary priority. The loop shares only `line`, `set_device` and the
/// publisher with it, and blocks on none of them.
class SceneUpdateServer {
 public:
  /// `first` is the running scene, built from `scene`. Both callbacks run in the server's thread.
  /// `swapped` is called when another scene has replaced it. `begun` is called when the plan of a
  /// session is published and the scene is validated for its device. The line must outlive the
  /// server.
  SceneUpdateServer(
      const bus::Participant& participant, const Options& options, const scene::Scene& scene,
      std::unique_ptr<rendering::BuiltScene> first, ChangeQueue& line,
      std::function<void(const scene::Scene&)> swapped,
      std::function<void(std::uint64_t)> begun = [](std::uint64_t) {});
  /// The loop must have ended; the scenes are freed.
  ~SceneUpdateServer();
  SceneUpdateServer(const SceneUpdateServer&) = delete;
  SceneUpdateServer& operator=(const SceneUpdateServer&) = delete;

  /// Called by the loop when a device describes itself: a session begins or continues with another
  /// device. Neither blocks nor locks. If two come at once, the later one is used.
  void set_device(std::unique_ptr<DescribedDevice> device) noexcept {
    delete described_.exchange(device.release());
  }
  /// Publishes the plan of the session again, for a node that has missed it. Not in lockstep.
  void republish() noexcept { republish_.store(true, std::memory_order_release); }
  const PlanPublisher& published() const noexcept { return publisher_; }
  runtime::Figures figures() const;
  /// See ChangeInbox::requests.
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

  ChangeQueue& change_queue_;
  std::function<void(const scene::Scene&)> swapped_;
  std::function<void(std::uint64_t)> begun_;
  ChangeValidator validator_;
  PlanPublisher publisher_;
  SceneReloader reloader_;
  PendingChanges pending_;
  ChangeInbox inbox_;
  runtime::Counters<kChangeTable> counters_;
  std::atomic<DescribedDevice*> described_{nullptr};
  std::atomic<bool> republish_{false};
  std::jthread thread_;
};

}  // namespace voxtouch::rendering_node
