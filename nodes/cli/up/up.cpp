#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <optional>
#include <set>
#include <thread>

#include <unistd.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/scene/scene_file.hpp"
#include "devices/settings.hpp"
#include "nodes/bag/files.hpp"
#include "nodes/bus/reader.hpp"
#include "nodes/cli/plot_tool.hpp"
#include "nodes/cli/up/command_line.hpp"
#include "nodes/cli/up/launcher.hpp"
#include "nodes/cli/up/start_warnings.hpp"
#include "nodes/cli/up/summary.hpp"
#include "nodes/cli/up/up_checks.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/faults/fault_bag.hpp"
#include "nodes/faults/force_lock.hpp"
#include "nodes/log/tell.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/scene_argument.hpp"
#include "nodes/runtime/signals.hpp"
#include "nodes/runtime/standby.hpp"

namespace voxtouch::cli {
namespace {

using std::chrono::milliseconds;
constexpr useconds_t kWatchPeriodUs = 20'000;

struct UpOptions {
  runtime::NodeOptions node;  ///< what all nodes are started with
  LauncherOptions ring;       ///< what each has beside that
  ChosenLimits limits;
  bool no_record = false, no_report = false, json = false, view = false, standby = false;
};

/// Of the user and not of the current folder, which may be one that nobody can write to: as the XDG base directories have it.
std::filesystem::path recordings_folder() {
  if (const char* data = std::getenv("XDG_DATA_HOME"); data && *data == '/') return std::filesystem::path(data) / "voxtouch/recordings";
  if (const char* home = std::getenv("HOME"); home && *home == '/') return std::filesystem::path(home) / ".local/share/voxtouch/recordings";
  return std::filesystem::absolute("recordings");
}

std::filesystem::path default_bag(const std::string& scene) {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char stamp[32];
  std::strftime(stamp, sizeof stamp, "%Y%m%d-%H%M%S", &local);
  return recordings_folder() / (scene + "-" + stamp);
}

/// Where device and coupling keep what they saw before a fault; made with the first one.
std::filesystem::path faults_beside(const std::filesystem::path& bag) {
  std::filesystem::path folder = std::filesystem::absolute(bag).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();  // "bags/run/"
  return folder += "_faults";
}

/// Runs the ring once: start, watch, stop in order, sum up.
class Run {
 public:
  Run(const UpOptions& options, const scene::Scene& scene)
      : options_(options), participant_(options.node.participant("up")),
        status_(participant_, "up", options.node.rig), registry_(participant_, options.node.rig),
        verdicts_(participant_, qos::kValidation, options.node.rig, qos::profile(qos::ProfileId::kTap)) {
    summary_.scene = scene.name;
    summary_.device = options.ring.device.device;
    summary_.motion = options.ring.device.motion;
    summary_.mode = options.node.lockstep ? "lockstep" : "real time";
    summary_.seed = options.node.seed;
    summary_.validate_every = static_cast<double>(options.ring.validator.every);
    summary_.limits = options.limits;
    if (!options.no_record)
      summary_.bag = options.ring.logger.bag.empty() ? default_bag(scene.name).string() : options.ring.logger.bag.string();
    if (const effects::EffectSpec* external = effects::external_of(scene.effects)) external_topic_ = qos::dds_name(qos::external_topic(external->text), options.node.rig);
    faults_ = faults_beside(summary_.bag.empty() ? default_bag(scene.name) : std::filesystem::path(summary_.bag));
  }

  /// Also after an exception: the device goes first.
  ~Run() {
    while (!children_.empty()) children_.pop_back();
  }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  RunSummary go() {
    require_free_rig();
    launcher_options_ = launcher_options();
    if (!runtime::stop_requested().load()) children_ = launch(launcher_options_);
    watch();
    stop_all();
    judge(summary_);
    watch_pairs();  // what was said last
    for (const auto& [name, times] : summary_.takeovers)
      summary_.notes.push_back(fmt::format("{} took over {} time{}, the last time at sample {:.0f}; {}", name, times, times == 1 ? "" : "s",
                                           number(summary_.reports, name, "took_over_at"), how_force_went_on()));
    for (std::string& sentence : faults::told_in(faults_)) summary_.notes.push_back(std::move(sentence));
    return std::move(summary_);
  }

 private:
  /// Says that it is here before it looks, so that of two that are started at once each sees the other: the one with the smaller GUID
  /// goes on, the other says so before it has started anything. One that runs already stays.
  void require_free_rig() {
    const auto in_the_way = [this](const runtime::NodeReport& other) {
      if (other.participant == participant_.guid()) return false;
      if (other.state == runtime::NodeState::kStopped || other.state == runtime::NodeState::kFailed) return false;
      return other.node != "up" || other.state == runtime::NodeState::kRunning || other.participant < participant_.guid();
    };
    announce(runtime::NodeState::kStarting);
    if (const auto other = runtime::look_for(registry_, in_the_way, milliseconds(500)))
      throw std::runtime_error(
          fmt::format("rig '{}' is in use on domain {}: its {} node runs as process {} on {}. Stop that ring, or "
                      "choose another --rig or --domain",
                      options_.node.rig, options_.node.domain, other->node, other->pid, other->host));
    announce(runtime::NodeState::kRunning);
  }

  void announce(runtime::NodeState state) {
    runtime::NodeReport report;
    report.state = state;
    report.message = "this ring's `voxtouch up`";
    std::error_code ignored;
    report.values = command_words(own_words(), std::filesystem::current_path(ignored).string());
    status_.publish(report);
  }

  LauncherOptions launcher_options() const {
    runtime::NodeOptions node = options_.node;
    if (node.lockstep) node.peers = {"rendering", "coupling", "validator"};
    if (node.lockstep && !options_.no_record) node.peers.push_back("logger");
    LauncherOptions ring = options_.ring;
    for (runtime::NodeOptions* one : std::initializer_list<runtime::NodeOptions*>{&ring.device, &ring.rendering, &ring.coupling, &ring.logger,
                                                                                  &ring.validator})
      *one = node;
    ring.logger.bag = summary_.bag;
    ring.device.fault_records = ring.coupling.fault_records = faults_;
    ring.rendering.standby.takes = ring.coupling.standby.takes = options_.standby ? runtime::TakesStandby::kAny : runtime::TakesStandby::kNever;
    if (options_.standby) {
      ring.rendering_standby = ring.rendering, ring.rendering_standby->standby.is_standby = true;
      ring.coupling_standby = ring.coupling, ring.coupling_standby->standby.is_standby = true;
    }
    ring.record = !options_.no_record;
    if (!external_topic_.empty() && !node.lockstep) ring.logger.topics.push_back(external_topic_);
    return ring;
  }

  void listen() {
    registry_.update([this](const runtime::NodeReport& report) { return is_child(report); });
    verdicts_.take_each([](const msg::ValidationReport&) {});
    for (const runtime::NodeReport& report : registry_.reports())
      if (is_child(report)) summary_.reports[report.node] = report;
  }

  bool is_child(const runtime::NodeReport& report) const {
    return std::any_of(children_.begin(), children_.end(),
                       [&](const auto& m) { return m->name() == report.node && m->pid() == report.pid; });
  }

  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& child : children_) all.push_back(child->name());
    return all;
  }

  RunningNode* find(const std::string& name) {
    for (const auto& child : children_)
      if (child->name() == name) return child.get();
    return nullptr;
  }

  /// Returns when the device has finished, a node has died, or Ctrl-C came.
  void watch() {
    std::int64_t next_line = runtime::monotonic_ns();
    while (!runtime::stop_requested().load()) {
      listen();
      if (runtime::monotonic_ns() >= next_line) {
        log::tell("{}\n", status_line(summary_.reports, names()));
        tell_trouble();
        next_line += 1'000'000'000;
      }
      bool over = watch_for_hung();
      watch_pairs();
      for (const auto& child : children_)
        if (const auto status = child->ended()) {
          if (goes_on_without(child->name())) {
            note_loss(child->name(), fmt::format("{} was ended by {}", child->name(),
                                                 *status > 128 ? fmt::format("signal {}", *status - 128) : fmt::format("itself, with status {}", *status)));
            continue;
          }
          if (child->name() != "device" || *status != 0) note_end(child->name(), *status);
          over = true;
        }
      if (over || note_refusals()) return;
      usleep(kWatchPeriodUs);  // ended at once by a signal: Ctrl-C, or that a node has died
    }
    log::tell("stopping\n");
    if (const double duration_s = options_.ring.device.duration_s; duration_s > 0)
      summary_.problems.push_back(fmt::format("the run was stopped before its {} s were over", duration_s));
  }

  /// Names who hangs as soon as it is known, and when it is heard again. True once one has been silent for too long to wait for.
  bool watch_for_hung() {
    for (const auto& [name, report] : summary_.reports) {
      if (report.final() || !is_running(name)) continue;
      double& longest_s = summary_.silence_s[name];
      longest_s = std::max(longest_s, registry_.silent_s(report));
    }
    std::set<std::string> still;
    for (const runtime::Hung& hung : registry_.hung()) {
      const auto ours = summary_.reports.find(hung.node);
      if (ours == summary_.reports.end() || ours->second.participant != hung.participant || !is_running(hung.node)) continue;
      still.insert(hung.node);
      if (hanging_.insert(hung.node).second) log::tell("  {}\n", hung.sentence);
      if (hung.for_s * 1e9 < static_cast<double>(runtime::kGivenUpNs)) continue;
      if (goes_on_without(hung.node)) {
        note_loss(hung.node, fmt::format("{} has given no sign of life for {} s", hung.node, runtime::kGivenUpNs / 1'000'000'000));
        continue;
      }
      summary_.problems.push_back(fmt::format("{} has given no sign of life for {} s: the run ends without it", hung.node,
                                              runtime::kGivenUpNs / 1'000'000'000));
      return true;
    }
    std::erase_if(hanging_, [&](const std::string& name) {
      if (still.contains(name)) return false;
      log::tell("  {} is heard again\n", name);
      return true;
    });
    return false;
  }

  /// The other one of a rendering or coupling that has a standby; empty where it has none.
  std::string partner_of(const std::string& name) const {
    if (!options_.standby) return {};
    for (const char* role : {"rendering", "coupling"}) {
      if (name == role) return runtime::standby_of(role);
      if (name == runtime::standby_of(role)) return role;
    }
    return {};
  }

  /// Where one of two is lost and the other one is there, the ring goes on.
  bool goes_on_without(const std::string& name) {
    const std::string partner = partner_of(name);
    if (partner.empty() || !is_running(partner)) return false;
    const auto report = summary_.reports.find(partner);
    return report != summary_.reports.end() && !report->second.final() && report->second.session_id != 0;
  }

  /// A run in which a node was lost is not a good one, also where force went on.
  void note_loss(const std::string& name, const std::string& how) {
    if (!noted_.insert(name).second) return;
    const bool acts = word(summary_.reports, partner_of(name), runtime::kDuty) == runtime::kActs;
    const std::string sentence = fmt::format("{}; {} {}", how, partner_of(name),
                                             acts || name == runtime::standby_of(partner_of(name)) ? "goes on" : "stood by, and takes over");
    log::tell("  {}\n", sentence);
    summary_.problems.push_back(sentence);
  }

  std::string how_force_went_on() const {
    const double faded = number(summary_.reports, "device", "faded");
    return fmt::format("the guard began {:.0f} fade{} in this run, and a takeover takes one of a twentieth of the force", faded, faded == 1 ? "" : "s");
  }

  /// Says at once who took over, and in the end how often.
  void watch_pairs() {
    for (const char* role : {"rendering", "coupling"})
      for (const std::string& name : {std::string(role), runtime::standby_of(role)}) {
        const auto count = runtime::as_count(number(summary_.reports, name, "took_over"));
        if (const auto known = summary_.takeovers.find(name); count == 0 || (known != summary_.takeovers.end() && count <= known->second)) continue;
        summary_.takeovers[name] = count;
        log::tell("  {} took over at sample {:.0f}\n", name, number(summary_.reports, name, "took_over_at"));
      }
  }

  bool is_running(const std::string& name) {
    RunningNode* child = find(name);
    return child && !child->ended();
  }

  /// What keeps a device that runs from giving force is said when it begins, not only in the end.
  void tell_trouble() {
    if (const auto coupling = summary_.reports.find("coupling"); coupling != summary_.reports.end() && coupling->second.values.contains(faults::ForceLock::kNumber)) {
      if (locked_.insert(coupling->second.values.at(faults::ForceLock::kNumber)).second) log::tell("  coupling: {}\n", coupling->second.message);
    }
    if (const std::string writer = word(summary_.reports, "rendering", "external_writer"); writer != external_writer_) {
      log::tell("  rendering: the outside wrench on {} {}\n", word(summary_.reports, "rendering", "external_topic"),
                writer.empty() ? "comes from nobody any more" : "comes from " + writer);
      external_writer_ = writer;
    }
    const auto report = summary_.reports.find("device");
    if (report == summary_.reports.end() || report->second.state != runtime::NodeState::kRunning) return;
    const std::string& message = report->second.message;
    if (message == last_message_ || !hanging_.empty()) return;  // who hangs has been named
    if (message != "running") log::tell("  device: {}\n", message);
    last_message_ = message;
  }

  /// A node that has failed but goes on, to say so, ends the run: without it there is no force.
  bool note_refusals() {
    bool any = false;
    for (const auto& [name, report] : summary_.reports)
      if (report.state == runtime::NodeState::kFailed && name != "device" && noted_.insert(name).second) {
        summary_.problems.push_back(name + ": " + report.message);
        any = true;
      }
    return any;
  }

  /// The device is at zero first; the logger goes last, so that the bag holds how the others ended.
  void stop_all() {
    for (const char* name : {"device", "rendering_standby", "coupling_standby", "rendering", "coupling", "validator", "logger"}) {
      RunningNode* child = find(name);
      if (!child) continue;
      child->request_stop();
      const int status = wait_for_end(*child);
      listen();
      if (status != 0 && !was_cut_short(name, status)) note_end(name, status);
    }
  }

  /// Status of a node that was asked to stop. One that hung before is ended after a second, for it has nothing that anybody would miss; the
  /// logger has the end of the bag, so a disk that is slow, or a machine that lets it wait, gets as long as a node gets that is watched. A node
  /// that takes its time to leave says nothing meanwhile, and hangs not.
  int wait_for_end(RunningNode& child) {
    const bool logger = child.name() == "logger", hung = hanging_.contains(child.name());
    const auto seconds_since = [begun = std::chrono::steady_clock::now()] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count(); };
    bool told = false;
    while (!child.ended() && seconds_since() < (logger ? 20.0 : 8.0)) {
      listen();
      const auto report = summary_.reports.find(child.name());
      const double silent_s = report == summary_.reports.end() ? 0.0 : registry_.silent_s(report->second);
      if (hung && (logger ? silent_s > 1e-9 * runtime::kGivenUpNs : seconds_since() > 1.0)) break;
      if (logger && !told && seconds_since() > 1.0) {
        log::tell("  the logger is writing what it still has into the bag\n");
        told = true;
      }
      usleep(kWatchPeriodUs);
    }
    return child.join(milliseconds(0));
  }

  /// A device that is stopped before its duration is over says so by its status; why it was stopped is known here already.
  bool was_cut_short(const std::string& name, int status) {
    return name == "device" && status == 1 && options_.ring.device.duration_s > 0 &&
           summary_.reports[name].state != runtime::NodeState::kFailed;
  }

  void note_end(const std::string& name, int status) {
    if (!noted_.insert(name).second) return;
    if (std::string sentence = summary_.reports[name].message;
        summary_.reports[name].state == runtime::NodeState::kFailed)
      summary_.problems.push_back(name + ": " + sentence);
    else if (status > 128 && name == "device")
      summary_.problems.push_back(fmt::format(
          "device was ended by signal {} and could not command zero force any more: a real device has only its "
          "own watchdog then; see that it is at rest before the next start",
          status - 128));
    else if (status > 128)
      summary_.problems.push_back(
          fmt::format("{} was ended by signal {}; the device went to zero force", name, status - 128));
    else if (status != 0)
      summary_.problems.push_back(fmt::format("{} ended with status {}; its message stands above", name, status));
    else
      summary_.problems.push_back(fmt::format("{} ended before the device did", name));
  }

  const UpOptions& options_;
  bus::Participant participant_;
  runtime::StatusWriter status_;
  runtime::NodeRegistry registry_;
  bus::Reader<msg::ValidationReport> verdicts_;  ///< the validator judges for whoever reads; its counts come with its status
  std::filesystem::path faults_;
  LauncherOptions launcher_options_;
  std::vector<std::unique_ptr<RunningNode>> children_;
  std::string last_message_ = "running";  ///< of the device, as it was said
  std::string external_topic_;            ///< of the scene's effect `external`, as DDS has it; empty without one
  std::string external_writer_;           ///< whom the effect follows, as it was said
  std::set<std::string> locked_;          ///< locks of the coupling that were told of
  std::set<std::string> hanging_;         ///< members that give no sign of life now
  std::set<std::string> noted_;  ///< members whose end is among the problems
  RunSummary summary_;
};

/// Of every process that is to come: half a ring under DDS Security would find out one by one.
void require_all_keys(const UpOptions& options) {
  if (!options.node.security.empty() && options.ring.one_process)
    throw std::runtime_error("--security gives each node its own rights, and DDS (Cyclone DDS 0.10) knows one certificate a process: start without --one-process");
  for (const std::string& role : security::roles())
    if ((role != "logger" || !options.no_record) && (role != security::kTool || options.view)) options.node.require_keys(role);
}

/// What takes over is another process, by the clock.
void require_room_for_standby(const UpOptions& options) {
  if (!options.standby) return;
  (void)runtime::in_mode({.is_standby = true}, options.node.lockstep);
  if (options.ring.one_process) throw std::runtime_error("--standby starts a second rendering and coupling to go on where the first is lost. Start without --one-process");
}

RunSummary run_up(const UpOptions& options) {
  require_room_for_standby(options);
  require_all_keys(options);
  runtime::catch_signals();
  signal(SIGCHLD, [](int) {});  // is not to be ignored by `usleep`
  const scene::Scene scene = scene::load_scene(options.node.scene);
  std::unique_ptr<RunningNode> page;  // first: what takes long to build can be looked at meanwhile
  if (options.view) page = start_page(options.node, options.ring.rendering.cache);
  const device_node::Options& device = options.ring.device;
  std::vector<std::string> warnings = scene.warnings;
  const std::vector<std::string> notes = check_before_start(
      scene, {device.device, devices::parse_settings(device.settings), device.motion, options.no_record ? "" : options.ring.logger.bag, device.network_delay_ms,
              options.node.lockstep, options.ring.rendering.cache},
      warnings);
  std::ranges::copy(warnings_of_machine(options.node.scheduling()), std::back_inserter(warnings));
  for (const std::string& line : few_warnings(warnings, options.node.scene.string())) log::tell("{}\n", line);
  for (const std::string& note : notes) log::tell("note: {}\n", note);
  return Run(options, scene).go();
}

std::string json_of(const RunSummary& summary) {
  return to_json(summary).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";  // paths need not be UTF-8
}

/// A bag alone does not tell whether its run was a good one: this file beside it does, with each limit and what was met.
void keep_verdict(const RunSummary& summary) {
  if (!std::filesystem::exists(summary.bag)) return;
  const auto kept = bag::write_atomically(std::filesystem::path(summary.bag) / "voxtouch_run.json", json_of(summary), bag::Flush::kNo);
  if (!kept) log::tell("note: the verdict on this run does not stand beside its bag: {}\n", kept.error().sentence);
}

/// Beside the bag, and no part of the run: where it cannot be drawn a sentence says so, and a long one goes on by itself.
void report_on(const RunSummary& summary) {
  constexpr std::chrono::seconds kPatience{4};
  if (number(summary.reports, "device", "samples") == 0 || !std::filesystem::exists(summary.bag)) return;
  const std::filesystem::path page = std::filesystem::path(summary.bag) / "report.html";
  try {
    if (write_report({.bag = summary.bag, .page = page}, kPatience))
      log::tell("report: {}\n", page.string());
    else
      log::tell("report: {} is still being drawn, and will be there when it is whole\n", page.string());
  } catch (const std::exception& error) {
    log::tell("note: no report is drawn: {} `voxtouch report {}` draws it later\n", error.what(), summary.bag);
  }
}

int up(const UpOptions& options) {
  const RunSummary summary = run_up(options);
  log::print_result("{}", options.json ? json_of(summary) : to_text(summary));
  if (!options.no_record) keep_verdict(summary);
  if (!options.no_record && !options.no_report) {
    log::finish_results();  // nobody waits for the summary while a page is drawn
    report_on(summary);
  }
  return summary.problems.empty() ? 0 : 1;
}

}  // namespace

void add_up(CLI::App& app, Action& action) {
  auto options = std::make_shared<UpOptions>();
  CLI::App* verb = app.add_subcommand(
      "up",
      "Start the whole ring (device, rendering, coupling, logger, validator), watch it, stop it on Ctrl-C, sum it up");
  verb->add_option("SCENE", options->node.scene,
                   fmt::format("Scene file (YAML), or the name of one that comes with voxtouch: {}", fmt::join(runtime::shipped_scenes(), ", ")))
      ->required()
      ->transform(runtime::scene_argument());
  runtime::add_node_options(*verb, options->node, false);
  verb->remove_option(verb->get_option("--peers"));
  device_node::add_device_options(*verb, options->ring.device);
  verb->add_option("--record", options->ring.logger.bag,
                   "Folder for the bag; it must not exist (default: " +
                       (recordings_folder() / "<scene>-<time>").string() + ")");
  logger::add_format_options(*verb, options->ring.logger.format);
  verb->add_option("--topic", options->ring.logger.topics, "Record this DDS topic as well (its type has to be compiled in), such as rt/tf")
      ->check(runtime::check_topic);
  verb->add_option("--validate-every", options->ring.validator.every, "The validator checks every n-th sample")
      ->capture_default_str()
      ->check(runtime::require_count);
  const auto choose_limits = [options](const std::vector<std::string>& texts) {
    for (const std::string& text : texts)
      if (const std::string wrong = choose_limit(text, options->limits); !wrong.empty()) throw CLI::ValidationError("--limit", wrong);
  };
  verb->add_option_function<std::vector<std::string>>("--limit", choose_limits,
                                                      "NAME=VALUE: a run is a good one, and the exit status 0, only within limits; this sets one of "
                                                      "them (0 or inf lifts it), and may be given more than once. Defaults: " +
                                                          describe_limits())
      ->allow_extra_args(false);
  verb->add_flag("--no-record", options->no_record, "No logger, no bag");
  verb->add_flag("--no-report", options->no_report, "No report.html beside the bag: see voxtouch report --help");
  verb->add_flag("--one-process", options->ring.one_process, "All nodes in this process; still over DDS");
  verb->add_flag("--standby", options->standby, "A second rendering and a second coupling stand by, and take over where the first leaves samples without an answer");
  scene_build::add_cache_options(*verb, options->ring.rendering.cache);
  verb->add_flag("--view", options->view, "Serves a page that shows the ring, and tells its address: see voxtouch view --help");
  verb->add_flag("--json", options->json, "Summary as one JSON object on stdout; all else goes to stderr");
  verb->callback([options, &action] { action = [options] { return up(*options); }; });
}

}  // namespace voxtouch::cli
