#pragma once
/// One run of a ring by `voxtouch up`: start, watch, stop in order, sum up.
#include <chrono>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "nodes/bus/reader.hpp"
#include "nodes/cli/up/launcher.hpp"
#include "nodes/cli/up/summary.hpp"
#include "nodes/runtime/node_registry.hpp"

namespace voxtouch::cli {

struct UpOptions {
  runtime::NodeOptions node;  ///< what all nodes are started with
  LauncherOptions ring;       ///< what each has beside that
  ChosenLimits limits;
  bool no_record = false, no_report = false, json = false, view = false, standby = false;
};

/// Runs the ring once.
class RingRun {
 public:
  /// `options` must outlive it.
  RingRun(const UpOptions& options, const scene::Scene& scene);
  /// Also after an exception: the device goes first.
  ~RingRun();
  RingRun(const RingRun&) = delete;
  RingRun& operator=(const RingRun&) = delete;

  /// Says that this ring is about to start. What is done between this and `go`, such as checks, is
  /// not waited for once more.
  void announce_start();
  /// Returns once every node has ended. Throws std::runtime_error, a sentence, where the rig is in
  /// use or a node cannot be started.
  RunSummary go();

 private:
  // Starting and stopping.
  /// It has said that it is here before it looks, so that of two that are started at once each sees
  /// the other: the one with the smaller GUID goes on, the other says so before any node of its has
  /// joined the rig. One that runs already stays. Where it was alone when it came, whoever has come
  /// since sees it and looks for half a second himself: it need not wait for an answer.
  void require_free_rig();
  void announce(runtime::NodeState state);
  LauncherOptions launcher_options() const;
  /// The device is at zero first; the logger goes last, so that the bag holds how the others ended.
  void stop_all();
  /// Status of a node that was asked to stop. One that hung before is ended after a second, for it
  /// has nothing that anybody would miss; the logger has the end of the bag, so a disk that is
  /// slow, or a machine that lets it wait, gets as long as a node gets that is watched. A node that
  /// takes its time to leave says nothing meanwhile, and hangs not.
  int wait_for_end(RunningNode& child);
  /// A device that is stopped before its duration is over says so by its status; why it was stopped
  /// is known here already.
  bool was_cut_short(const std::string& name, int status);
  void note_end(const std::string& name, int status);
  std::string how_force_went_on() const;

  // Watching.
  /// Returns when the device has finished, a node has died, or Ctrl-C came.
  void watch();
  void listen();
  /// Names who hangs as soon as it is known, and when it is heard again. True once one has been
  /// silent for too long to wait for.
  bool watch_for_hung();
  /// Says at once who took over, and in the end how often.
  void watch_pairs();
  /// What keeps a device that runs from giving force is said when it begins, not only in the end.
  void tell_trouble();
  /// A node that has failed but goes on, to say so, ends the run: without it there is no force.
  bool note_refusals();
  /// After a loss the device's guard holds the last command and fades it; device and coupling
  /// record what they saw of it. Were the device stopped at once, the force would end in a step and
  /// nobody would know of what.
  void let_guard_act();
  /// A run in which a node was lost is not a good one, also where force went on.
  void note_loss(const std::string& name, const std::string& how);
  /// The other one of a rendering or coupling that has a standby; empty where it has none.
  std::string partner_of(const std::string& name) const;
  /// Where one of two is lost and the other one is there, the ring goes on.
  bool goes_on_without(const std::string& name);

  static constexpr unsigned kWatchPeriodUs = 20'000;
  /// Three periods and 20 ms with a device of 1 kHz (devices/force_guard.hpp), and as long again on
  /// a busy machine.
  static constexpr std::chrono::milliseconds kGuardActs{100};
  bool is_child(const runtime::NodeReport& report) const;
  bool is_running(const std::string& name);
  std::vector<std::string> names() const;
  RunningNode* find(const std::string& name);

  const UpOptions& options_;
  const std::vector<int> inherited_;  ///< UDP sockets that were there before this process took part
                                      ///< in DDS: those of whoever started it, say
  bus::Participant participant_;
  const bool came_alone_;  ///< nobody else of this machine was in the domain, and no other
                           ///< machine's can be heard
  runtime::StatusWriter status_;
  runtime::NodeRegistry registry_;
  bus::Reader<msg::ValidationReport>
      verdicts_;  ///< the validator judges for whoever reads; its counts come with its status
  std::filesystem::path faults_;
  LauncherOptions launcher_options_;
  std::vector<std::unique_ptr<RunningNode>> children_;
  std::string last_message_ = "running";  ///< of the device, as it was said
  std::string
      external_topic_;  ///< of the scene's effect `external`, as DDS has it; empty without one
  std::string external_writer_;    ///< whom the effect follows, as it was said
  std::set<std::string> locked_;   ///< locks of the coupling that were told of
  std::set<std::string> hanging_;  ///< members that give no sign of life now
  std::int64_t announced_ns_ = 0;  ///< when it said that it is here
  std::set<std::string> noted_;    ///< members whose end is among the problems
  RunSummary summary_;
};

}  // namespace voxtouch::cli
