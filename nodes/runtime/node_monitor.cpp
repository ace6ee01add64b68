#include "nodes/runtime/node_monitor.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include <fmt/format.h>

#include "nodes/bus/exchange.hpp"
#include "nodes/console/log.hpp"
#include "nodes/runtime/clock.hpp"

namespace voxtouch::runtime {
namespace {

/// Together with the 20 ms polling period this gives at least ten statuses a second.
constexpr std::int64_t kStatusPeriodNs = 75'000'000;
/// During this time after the start a node polls four times as often. Nodes of a ring that start
/// together wait for each other in turn.
constexpr std::int64_t kStartNs = 1'000'000'000;

/// Options that the node was started with, sorted by name.
std::vector<RosParameter> settings_of(const NodeOptions& options) {
  std::vector<RosParameter> all;
  if (!options.scene.empty())
    all.push_back({.name = "scene_file",
                   .value = options.scene.string(),
                   .meaning = "Scene file.",
                   .read_only = true});
  all.push_back({.name = "seed",
                 .value = static_cast<std::int64_t>(options.seed),
                 .meaning = "Random seed.",
                 .read_only = true});
  return all;
}

}  // namespace

NodeMonitor::NodeMonitor(const bus::Participant& participant, std::string node,
                         const NodeOptions& options,
                         std::function<void(NodeRegistry&, NodeReport&)> poll,
                         std::vector<Watched> watched)
    : options_(options),
      node_(node),
      writer_(participant, std::move(node), options.rig),
      registry_(participant, options.rig, options.up),
      ros_log_(participant, node_, options.rig),
      poll_(std::move(poll)),
      stalls_(std::move(watched)),
      own_(participant.guid()),
      rate_line_(node_, options.announce && !console::stderr_is_journal()) {
  if (node_ != "rendering")
    parameters_.emplace(participant, options.rig, node_, options.lockstep,
                        ParameterHandler{[this] { return settings_of(options_); }, nullptr},
                        requests_);
  cycle();
  thread_ = std::thread([this, begun_ns = monotonic_ns()] {
    ordinary_priority();
    while (!stop_.load(std::memory_order_acquire)) {
      cycle_or_skip();
      std::this_thread::sleep_for(
          std::chrono::milliseconds(monotonic_ns() - begun_ns < kStartNs ? 5 : 20));
    }
  });
}

NodeMonitor::~NodeMonitor() {
  stop_.store(true, std::memory_order_release);
  thread_.join();
  last_publish_ns_ = 0;
  cycle_or_skip();
  writer_.flush();
}

void NodeMonitor::cycle_or_skip() noexcept {
  try {
    cycle();
  } catch (const std::exception&) {
    // For example out of memory: one report is lost. An exception that leaves this thread would end
    // the process and the device.
  }
}

/// Nodes on several hosts each read their own copy of the scene. Different copies would render one
/// scene and shape the force for another.
void NodeMonitor::compare_scenes(NodeReport& report) const {
  const auto own = report.values.find("scene_hash");
  if (own == report.values.end())
    return;
  for (const NodeReport& other : registry_.reports()) {
    const auto its = other.values.find("scene_hash");
    if (its == other.values.end() || its->second == own->second)
      continue;
    const auto name = other.values.find("scene");
    report.message = fmt::format(
        "warning: this node runs scene '{}' ({}), but {} on {} runs '{}' ({}): start both with the "
        "same file",
        report.values["scene"], own->second, other.node, other.host,
        name == other.values.end() ? "?" : name->second, its->second);
    return;
  }
}

void OwnStalls::poll(NodeReport& report) {
  clock_.poll(monotonic_ns());
  double longest_s = 0.0;
  for (Watched& watched : watched_) {
    const double stalled_s =
        static_cast<double>(watched.watch.stalled_ns(watched.sign(), clock_)) * 1e-9;
    if (report.final() || stalled_s <= longest_s)
      continue;
    longest_s = stalled_s;
    report.values[kStalled] = watched.what;
  }
  longest_s_ = std::max(longest_s_, longest_s);
  const bool hangs = longest_s > static_cast<double>(kHungNs) * 1e-9;
  if (!hangs)
    report.values.erase(kStalled);
  report.figures[kStalledFor] = {hangs ? longest_s : 0.0, "s"};
  report.figures[kLongestStall] = {longest_s_, "s"};
  if (hangs)
    report.message +=
        fmt::format("; {} is stalled for {} s", report.values[kStalled], 1e-9 * kHungNs);
}

void NodeMonitor::watch_reception(NodeReport& report) {
  constexpr std::int64_t kSilenceNs = 3'000'000'000, kEachNs = 1'000'000'000;
  const std::vector<NodeReport> reports = registry_.reports();
  has_received_ = has_received_ || std::ranges::any_of(reports, [this](const NodeReport& other) {
                    return other.participant != own_;
                  });
  const bool had_fault = !reception_fault_.empty();
  if (const std::int64_t now = monotonic_ns(); now - reception_checked_ns_ >= kEachNs) {
    reception_checked_ns_ = now;
    const char* const uri = std::getenv("CYCLONEDDS_URI");
    const bool receives_nothing =
        !options_.peers.empty() && !has_received_ && stalls_.watched_ns() >= kSilenceNs;
    if (const std::string lost = bus::lost_address(); !lost.empty())
      reception_fault_ = lost + ": nodes may not receive each other; restart the ring";
    else if (receives_nothing && !had_fault)
      reception_fault_ = fmt::format(
          "nothing received from other nodes for {} s: {}", kSilenceNs / 1'000'000'000,
          bus::reception_fault(options_.network_interface, options_.domain, uri ? uri : ""));
    else if (!receives_nothing)
      reception_fault_.clear();
  }
  if (reception_fault_.empty())
    return;
  if (!had_fault)
    console::log("warning: {}: {}\n", node_, reception_fault_);
  report.message += "; " + reception_fault_;
}

void NodeMonitor::watch_others(NodeReport& report) {
  had_session_ = had_session_ || report.session_id != 0;
  for (const Hung& hung : registry_.hung()) {
    if (hung.participant == own_)
      continue;
    report.message += "; " + hung.sentence;
    // Unauthorised participants are reported by the name that they give, but no node waits for
    // them.
    const bool is_waited_for = lockstep_peers_.contains(hung.participant) && hung.node != node_;
    const bool too_long = hung.for_s * 1e9 >= static_cast<double>(kGivenUpNs);
    if (is_waited_for && had_session_ && too_long && !report.final() && lost_.empty())
      lost_ =
          fmt::format("{} is silent for {} s: the lockstep run ends", hung.node, 1e-9 * kGivenUpNs);
  }
  if (lost_.empty())
    return;
  report.state = NodeState::kFailed;
  report.message = lost_;
  peer_lost_.store(true, std::memory_order_relaxed);
}

/// Publishes changes, and repeats the last message for new readers.
void NodeMonitor::set_publishing(const NodeReport& report) {
  if (parameters_)
    parameters_->serve();
  if (ros_log_.reader_came() || report.message != last_.message)
    ros_log_.write(report.state, report.message);
}

void NodeMonitor::cycle() {
  registry_.update(
      [this](const NodeReport& report) { return lockstep_peers_.contains(report.participant); });
  NodeReport report = last_;
  poll_(registry_, report);
  lockstep_peers_ = report.lockstep_peers;
  report.figures["refused_statuses"] = {registry_.refused(), "statuses"};
  for (std::size_t i = 0; i < options_.warnings.size(); ++i)
    report.values["warning_" + std::to_string(i + 1)] = options_.warnings[i];
  compare_scenes(report);
  if (const std::uint64_t lost = console::texts_lost())
    report.figures["lost_texts"] = {lost, "texts"};
  stalls_.poll(report);
  watch_reception(report);
  watch_others(report);
  set_publishing(report);
  const bool announce = options_.announce && report.message != last_.message;
  const std::int64_t now = monotonic_ns();
  const bool changed = report.state != last_.state || report.session_id != last_.session_id ||
                       report.message != last_.message;
  if (!changed && last_publish_ns_ != 0 && now - last_publish_ns_ < kStatusPeriodNs)
    return;
  const bool diagnose = changed || now - last_ros_ns_ >= 1'000'000'000;
  if (diagnose)
    last_ros_ns_ = now;
  writer_.publish(report, diagnose);
  last_ = std::move(report);
  if (announce)
    console::log("{}: {}\n", node_,
                 last_.message);  // after the report itself, which is for the other nodes
  if (last_.state == NodeState::kRunning)
    rate_line_.print(now, last_.figures);
  last_publish_ns_ = now;
}

}  // namespace voxtouch::runtime
