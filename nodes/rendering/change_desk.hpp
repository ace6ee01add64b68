#pragma once
/// Who wants something changed while the ring runs comes here: judged, handed to the loop, answered.
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

#include "nodes/bus/reader.hpp"
#include "nodes/bus/wait_set.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/rendering/change_line.hpp"
#include "nodes/rendering/rendering_node.hpp"
#include "nodes/runtime/figure.hpp"

namespace voxtouch::rendering {

/// A thread of ordinary priority that reads `rendering/change`, judges by its own copy of what the effects are set to, builds
/// scenes, frees them, and publishes the plan. The loop meets it only at `line` and, when a session begins, at `begin_session`.
class ChangeDesk {
 public:
  /// `first` is the scene that runs, built from `scene`. `swapped` is told of a scene that has taken its place, from the desk's
  /// thread. The line outlives the desk.
  ChangeDesk(const bus::Participant& participant, const Options& options, const Scene& scene,
             std::unique_ptr<BuiltScene> first, ChangeLine& line, std::function<void(const Scene&)> swapped);
  /// The loop has ended: nobody renders any of the scenes any more.
  ~ChangeDesk();
  ChangeDesk(const ChangeDesk&) = delete;
  ChangeDesk& operator=(const ChangeDesk&) = delete;

  /// From the loop: publishes the plan for a session.
  void begin_session(std::uint64_t session);
  /// Writes the plan of the session once more, for a node that has missed it. Not for the loop.
  void remind();
  /// Who reads the plan.
  std::vector<bus::Guid> plan_readers() const { return plans_.matched(); }
  /// For the node's report: changes, reloads, warnings, ...
  runtime::Figures figures() const;

 private:
  struct Request {  ///< what of an EffectChange is needed later
    std::uint64_t id = 0, session = 0, from_sample = 0;
    std::string what;  ///< for the answer: "'viscosity' off"
  };
  struct Answered {
    std::uint64_t id = 0, sample = 0;
    std::uint32_t result = 0;
    std::string sentence;
  };
  struct Outstanding {
    Request request;
    Change change;
    std::optional<Scene> scene;  ///< of a reload
  };
  struct Built {
    Scene scene;
    std::unique_ptr<BuiltScene> built;
    std::string refusal;
  };

  void run();
  void turn();
  void receive(const msg::EffectChange& m);
  std::string why_not(const msg::EffectChange& m) const;
  void receive_effect(const msg::EffectChange& m, Request request);
  void receive_reload(const msg::EffectChange& m, Request request);
  Built build(double voxel_size_m, const std::string& model) const;
  void look_after_build();
  void take_report(const ChangeReport& report);
  void applied(Outstanding& done, std::uint64_t sample);
  bool ask(Outstanding&& asked);
  std::uint64_t session() const;
  void set_plan(const BuiltScene& built);
  void sum_bounds();
  void republish(std::uint64_t from_sample);
  bool answered_before(std::uint64_t id);
  void send(const Answered& answer);
  void answer(const Request& request, std::uint32_t result, std::uint64_t sample, const std::string& sentence);
  void refuse(const Request& request, const std::string& sentence);

  const Options& options_;
  ChangeLine& line_;
  std::function<void(const Scene&)> swapped_;
  bus::Reader<msg::EffectChange> changes_;
  bus::Writer<msg::EffectChanged> answers_;
  bus::Writer<msg::ScenePlan> plans_;
  bus::WaitSet wait_set_;

  Scene scene_;                                      ///< as read from the file that runs
  std::vector<EffectSpec> settled_;                  ///< what the loop has applied
  std::vector<EffectSpec> planned_;                  ///< with what is outstanding as well
  std::vector<std::unique_ptr<BuiltScene>> scenes_;  ///< rendered, fading or waiting to be
  std::deque<Outstanding> outstanding_;              ///< given to the loop, oldest first
  std::deque<Answered> answered_;                    ///< the last ones: a sender whose answer was lost asks again
  std::optional<Request> reload_;                    ///< under way, until the scene it replaces has been freed
  std::future<Built> under_way_;
  std::uint64_t ticket_ = 0, epoch_ = 0;

  mutable std::mutex plan_mutex_;                            ///< of scene_ too; the loop takes it only where a session begins
  Plan plan_;                                                ///< with the bounds of the effects as they are now
  double largest_shell_gap_m_ = 0.0;
  std::uint64_t session_ = 0, plan_from_sample_ = 0;
  std::atomic<std::uint64_t> done_{0}, refused_{0}, reloads_{0};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace voxtouch::rendering
