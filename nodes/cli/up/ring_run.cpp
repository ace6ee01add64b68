#include "nodes/cli/up/ring_run.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include <fmt/format.h>

#include "nodes/bus/network.hpp"
#include "nodes/cli/up/command_line.hpp"
#include "nodes/cli/up/run_files.hpp"
#include "nodes/cli/up/up_checks.hpp"
#include "nodes/faults/fault_bag.hpp"
#include "nodes/log/tell.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/signals.hpp"

namespace voxtouch::cli {
namespace {

bool is_alone(const runtime::NodeOptions& node, const std::vector<int>& inherited) {
  std::vector<int> own = bus::udp_sockets();
  std::erase_if(
      own, [&](int socket) { return std::ranges::find(inherited, socket) != inherited.end(); });
  const char* const uri = std::getenv("CYCLONEDDS_URI");
  return bus::is_alone_in_domain(node.domain, node.network_interface, node.discovery_peers,
                                 uri ? uri : "", own);
}

}  // namespace

RingRun::RingRun(const UpOptions& options, const scene::Scene& scene)
    : options_(options),
      inherited_(bus::udp_sockets()),
      participant_(options.node.participant("up")),
      came_alone_(is_alone(options.node, inherited_)),
      status_(participant_, "up", options.node.rig),
      registry_(participant_, options.node.rig),
      verdicts_(participant_, qos::kValidation, options.node.rig,
                qos::profile(qos::ProfileId::kTap)) {
  summary_.scene = scene.name;
  summary_.device = options.ring.device.device;
  summary_.motion = options.ring.device.motion;
  summary_.mode = options.node.lockstep ? "lockstep" : "real time";
  summary_.seed = options.node.seed;
  summary_.validate_every = static_cast<double>(options.ring.validator.every);
  summary_.limits = options.limits;
  if (!options.no_record)
    summary_.bag = options.ring.logger.bag.empty() ? default_bag(scene.name).string()
                                                   : options.ring.logger.bag.string();
  if (const effects::EffectSpec* external = effects::external_of(scene.effects))
    external_topic_ = qos::dds_name(qos::external_topic(external->text), options.node.rig);
  faults_ = faults_beside(summary_.bag.empty() ? default_bag(scene.name)
                                               : std::filesystem::path(summary_.bag));
}

RingRun::~RingRun() {
  while (!children_.empty())
    children_.pop_back();
}

RunSummary RingRun::go() {
  launcher_options_ = launcher_options();
  const bool held = !launcher_options_.one_process;  // processes get ready while this one looks
  if (held && !runtime::stop_requested().load())
    children_ = launch(launcher_options_);
  require_free_rig();
  if (!held && !runtime::stop_requested().load())
    children_ = launch(launcher_options_);
  for (const auto& child : children_)
    child->let_begin();
  watch();
  stop_all();
  judge(summary_);
  watch_pairs();  // what was said last
  for (const auto& [name, times] : summary_.takeovers)
    summary_.notes.push_back(
        fmt::format("{} took over {} time{}, the last time at sample {:.0f}; {}", name, times,
                    times == 1 ? "" : "s", number(summary_.reports, name, "took_over_at"),
                    how_force_went_on()));
  for (std::string& sentence : faults::told_in(faults_))
    summary_.notes.push_back(std::move(sentence));
  return std::move(summary_);
}

void RingRun::require_free_rig() {
  const auto in_the_way = [this](const runtime::NodeReport& other) {
    if (other.participant == participant_.guid())
      return false;
    if (other.state == runtime::NodeState::kStopped || other.state == runtime::NodeState::kFailed)
      return false;
    return other.node != "up" || other.state == runtime::NodeState::kRunning ||
           other.participant < participant_.guid();
  };
  // Of half a second since it was announced; at least as long as it takes to look twice, for what
  // came meanwhile lies here.
  const std::int64_t left_ms = 500 - (runtime::monotonic_ns() - announced_ns_) / 1'000'000;
  const std::int64_t patience_ms = came_alone_ ? 1 : std::max<std::int64_t>(left_ms, 50);
  if (const auto other =
          runtime::look_for(registry_, in_the_way, std::chrono::milliseconds(patience_ms)))
    throw std::runtime_error(fmt::format(
        "rig '{}' is in use on domain {}: its {} node runs as process {} on {}. Stop that ring, or "
        "choose another --rig or --domain",
        options_.node.rig, options_.node.domain, other->node, other->pid, other->host));
  announce(runtime::NodeState::kRunning);
}

void RingRun::announce_start() {
  announce(runtime::NodeState::kStarting);
  announced_ns_ = runtime::monotonic_ns();
}

void RingRun::announce(runtime::NodeState state) {
  runtime::NodeReport report;
  report.state = state;
  report.message = "this ring's `voxtouch up`";
  std::error_code ignored;
  report.values = command_words(own_words(), std::filesystem::current_path(ignored).string());
  status_.publish(report);
}

LauncherOptions RingRun::launcher_options() const {
  runtime::NodeOptions node = options_.node;
  if (node.lockstep)
    node.peers = {"rendering", "coupling", "validator"};
  if (node.lockstep && !options_.no_record)
    node.peers.push_back("logger");
  LauncherOptions ring = options_.ring;
  for (runtime::NodeOptions* one : std::initializer_list<runtime::NodeOptions*>{
           &ring.device, &ring.rendering, &ring.coupling, &ring.logger, &ring.validator})
    *one = node;
  ring.logger.bag = summary_.bag;
  ring.device.fault_records = ring.coupling.fault_records = faults_;
  ring.rendering.standby.takes = ring.coupling.standby.takes =
      options_.standby ? runtime::TakesStandby::kAny : runtime::TakesStandby::kNever;
  if (options_.standby) {
    ring.rendering_standby = ring.rendering, ring.rendering_standby->standby.is_standby = true;
    ring.coupling_standby = ring.coupling, ring.coupling_standby->standby.is_standby = true;
  }
  ring.record = !options_.no_record;
  if (!external_topic_.empty() && !node.lockstep)
    ring.logger.topics.push_back(external_topic_);
  return ring;
}

void RingRun::stop_all() {
  for (const char* name : {"device", "rendering_standby", "coupling_standby", "rendering",
                           "coupling", "validator", "logger"}) {
    RunningNode* child = find(name);
    if (!child)
      continue;
    child->request_stop();
    const int status = wait_for_end(*child);
    listen();
    if (status != 0 && !was_cut_short(name, status))
      note_end(name, status);
  }
}

int RingRun::wait_for_end(RunningNode& child) {
  const bool logger = child.name() == "logger", hung = hanging_.contains(child.name());
  const auto seconds_since = [begun = std::chrono::steady_clock::now()] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  };
  bool told = false;
  while (!child.ended() && seconds_since() < (logger ? 20.0 : 8.0)) {
    listen();
    const auto report = summary_.reports.find(child.name());
    const double silent_s =
        report == summary_.reports.end() ? 0.0 : registry_.silent_s(report->second);
    if (hung && (logger ? silent_s > 1e-9 * runtime::kGivenUpNs : seconds_since() > 1.0))
      break;
    if (logger && !told && seconds_since() > 1.0) {
      log::tell("  the logger is writing what it still has into the bag\n");
      told = true;
    }
    usleep(kWatchPeriodUs);
  }
  return child.join(std::chrono::milliseconds(0));
}

bool RingRun::was_cut_short(const std::string& name, int status) {
  return name == "device" && status == 1 && options_.ring.device.duration_s > 0 &&
         summary_.reports[name].state != runtime::NodeState::kFailed;
}

void RingRun::note_end(const std::string& name, int status) {
  if (!noted_.insert(name).second)
    return;
  if (std::string sentence = summary_.reports[name].message;
      summary_.reports[name].state == runtime::NodeState::kFailed)
    summary_.problems.push_back(name + ": " + sentence);
  else if (status > 128 && name == "device")
    summary_.problems.push_back(
        fmt::format("device was ended by signal {} and could not command zero force any more: a "
                    "real device has only its "
                    "own watchdog then; see that it is at rest before the next start",
                    status - 128));
  else if (status > 128)
    summary_.problems.push_back(fmt::format(
        "{} was ended by signal {}; the device went to zero force", name, status - 128));
  else if (status != 0)
    summary_.problems.push_back(
        fmt::format("{} ended with status {}; its message stands above", name, status));
  else
    summary_.problems.push_back(fmt::format("{} ended before the device did", name));
}

std::string RingRun::how_force_went_on() const {
  const double faded = number(summary_.reports, "device", "faded");
  return fmt::format(
      "the guard began {:.0f} fade{} in this run, and a takeover takes one of a twentieth of the "
      "force",
      faded, faded == 1 ? "" : "s");
}

}  // namespace voxtouch::cli
