#pragma once
/// Who wants something changed while the ring runs comes here: judged, handed to the loop,
/// answered.
#include <atomic>
#include <deque>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "core/fitting/scene_on_device.hpp"
#include "nodes/bus/reader.hpp"
#include "nodes/bus/wait_set.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/rendering/change_line.hpp"
#include "nodes/rendering/effect_services.hpp"
#include "nodes/rendering/kept_change.hpp"
#include "nodes/rendering/rendering_node.hpp"
#include "nodes/runtime/figure.hpp"

namespace voxtouch::rendering_node {

/// A device, as it has described itself for a session.
struct DescribedDevice {
  std::uint64_t session = 0;
  coupling::design::DeviceModel model;
};

/// A thread of ordinary priority that reads `rendering/change` and answers the rendering's
/// services, judges by its own copy of what the effects are set to and by the device that was
/// described, builds scenes, frees them, and publishes the plan. Each change that was made is
/// written on `rendering/made`, whoever asked, so that a bag has it. What comes by a service is
/// written on `rendering/change` as well, for a standby. The loop meets it only at `line` and at
/// `device_is`, and waits for it at neither.
class SceneUpdateServer {
 public:
  /// `first` is the scene that runs, built from `scene`. Both functions are called from the update
  /// server's thread: `swapped` is told of a scene that has taken its place, `begun` of a session
  /// whose plan has been published and on whose device the scene was judged. The line outlives the
  /// update server.
  SceneUpdateServer(
      const bus::Participant& participant, const Options& options, const scene::Scene& scene,
      std::unique_ptr<rendering::BuiltScene> first, ChangeLine& line,
      std::function<void(const scene::Scene&)> swapped,
      std::function<void(std::uint64_t)> begun = [](std::uint64_t) {});
  /// The loop has ended: nobody renders any of the scenes any more.
  ~SceneUpdateServer();
  SceneUpdateServer(const SceneUpdateServer&) = delete;
  SceneUpdateServer& operator=(const SceneUpdateServer&) = delete;

  /// From the loop, where a device describes itself: a session begins, or goes on with another
  /// device. Neither waits nor locks; of two that come at once the later one counts.
  void device_is(std::unique_ptr<DescribedDevice> device) noexcept {
    delete described_.exchange(device.release());
  }
  /// Writes the plan of the session once more, for a node that has missed it. Not in lockstep.
  void remind() noexcept { remind_.store(true, std::memory_order_release); }
  /// Whether plan and answers are written, or another rendering that acts does that. Who begins to
  /// speak writes its plan. Any thread.
  void speak(bool speaks) noexcept { speaks_.store(speaks, std::memory_order_release); }
  /// Who reads the plan.
  const bus::Writer<msg::ScenePlan>& plans() const noexcept { return plans_; }
  /// For the node's report: changes, reloads, warnings, ...
  runtime::Figures figures() const;
  /// Why what runs does not fit the device, so that the coupling commands no force; empty: it fits.
  std::string refusal() const;
  /// Of a virtual tool, under the coupling that is certified now, in W [N/m]. From any thread.
  /// Real-time safe.
  double spring_n_per_m() const noexcept { return spring_n_per_m_.load(std::memory_order_acquire); }

 private:
  struct Request {  ///< what of an EffectChange is needed later
    std::uint64_t id = 0, session = 0, from_sample = 0;
    std::string what;  ///< for the answer: "'viscosity' off"
    std::function<void(bool done, std::uint64_t from_sample, const std::string& sentence)> told =
        {};                  ///< the last word, for who asked by a service
    KeptChange change = {};  ///< for the record
  };
  struct Answered {
    std::uint64_t id = 0, sample = 0;
    std::uint32_t result = 0;
    std::string sentence;
  };
  struct Outstanding {
    Request request;
    Change change;
    std::optional<scene::Scene> scene = {};         ///< of a reload ...
    std::vector<effects::EffectSpec> effects = {};  ///< ... and what its effects begin with
    std::string why_not = {};                       ///< found out after it was given to the loop
  };
  /// What will run when all that is outstanding has been done.
  struct Next {
    const scene::Scene& scene;
    rendering::StiffnessBounds contact_alone;
    std::vector<effects::EffectSpec> effects;
    std::vector<effects::EffectReach> reach;
  };
  struct Built {
    scene::Scene scene;
    std::unique_ptr<rendering::BuiltScene> built;
    std::string refusal;
  };

  void run();
  void cycle();
  ChangeHandler handler();
  void ask_for(std::span<const msg::EffectChange> asked, bool together, const ChangeTold& told);
  void receive(const msg::EffectChange& m, Request request);
  std::string why_not(const msg::EffectChange& m) const;
  void receive_effects(std::span<const msg::EffectChange> all, std::vector<Request> requests);
  std::string give(std::span<const msg::EffectChange> all, std::span<const Request> requests);
  bool pause_before(const Request& request);
  std::string wait_text(const Request& request) const;
  void receive_reload(const msg::EffectChange& m, Request request);
  Built build(double voxel_size_m, const std::string& model) const;
  void look_after_build();
  void handle_report(const ChangeReport& report);
  void applied(Outstanding& done, const ChangeReport& report);
  bool ask(std::vector<Outstanding> asked);
  Next next() const;
  void look_after_device();
  void judge_outstanding();
  void set_plan(const rendering::BuiltScene& built);
  bool sum_up();
  void show(std::uint64_t from_sample, bool another_scene = false);
  void judge_running();
  void republish();
  void publish(std::uint64_t from_sample);
  bool answered_before(std::uint64_t id);
  void send(const Answered& answer);
  void record(const Request& request, const ChangeReport& report);
  void answer(const Request& request, std::uint32_t result, std::uint64_t sample,
              const std::string& sentence);
  void refuse(const Request& request, const std::string& sentence);

  const Options& options_;
  ChangeLine& line_;
  std::function<void(const scene::Scene&)> swapped_;
  bus::Reader<msg::EffectChange> changes_;
  bus::Writer<msg::EffectChange> asked_by_service_;  ///< what `changes_` passes over
  bus::Writer<msg::EffectChanged> answers_;
  bus::Writer<msg::EffectChange> made_;
  bus::Writer<msg::ScenePlan> plans_;
  bus::WaitSet wait_set_;

  scene::Scene scene_;                        ///< as read from the file that runs
  std::vector<effects::EffectSpec> settled_;  ///< what the loop has applied
  std::vector<effects::EffectReach> reach_;   ///< where the effects may be, until they are at rest
  std::optional<fitting::DeviceDemand> fading_;  ///< of the scene that fades out, at most
  fitting::DeviceDemand shown_;                  ///< of all that is rendered now, at most
  fitting::SceneOnDevice on_device_;
  std::vector<std::unique_ptr<rendering::BuiltScene>>
      scenes_;                           ///< rendered, fading or waiting to be
  std::deque<Outstanding> outstanding_;  ///< given to the loop, oldest first
  std::deque<Answered> answered_;  ///< the last ones: a sender whose answer was lost asks again
  std::optional<Request> reload_;  ///< under way, until it is what runs
  std::future<Built> under_way_;
  std::uint64_t ticket_ = 0, epoch_ = 0;
  std::atomic<DescribedDevice*> described_{nullptr};

  rendering::Plan plan_;  ///< with the bounds of the effects as they are now
  double largest_shell_gap_m_ = 0.0;
  std::uint64_t session_ = 0, plan_from_sample_ = 0;
  std::function<void(std::uint64_t)> begun_;
  mutable std::mutex refusal_mutex_;
  std::string refusal_;
  std::atomic<double> spring_n_per_m_{0.0};
  std::atomic<std::size_t> warnings_{0};
  std::atomic<std::uint64_t> done_{0}, refused_{0}, reloads_{0};
  std::atomic<bool> stop_{false}, remind_{false};
  EffectServices services_;
  std::atomic<bool> speaks_;
  bool spoke_;
  std::thread thread_;
};

}  // namespace voxtouch::rendering_node
