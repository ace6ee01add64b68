#include "nodes/cli/up/ring_run.hpp"

#include <unistd.h>

#include <chrono>
#include <thread>

#include <fmt/format.h>

#include "nodes/bag/bag_reader.hpp"
#include "nodes/cli/up/run_files.hpp"
#include "nodes/cli/up/up_checks.hpp"
#include "nodes/console/log.hpp"
#include "nodes/faults/fault_bag.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/signals.hpp"
#include "nodes/view/view.hpp"

namespace voxtouch::cli {
namespace {

constexpr unsigned kWatchPeriodUs = 20'000, kStartPeriodUs = 2'000;
/// After a loss the device's guard holds and fades the last command, and device and coupling record
/// it: three periods and 20 ms at 1 kHz (devices/force_guard.hpp), and as long again on a busy
/// machine.
constexpr std::chrono::milliseconds kGuardActs{100};

RunSummary begin_summary(const UpOptions& options, const scene::Scene& scene,
                         const std::filesystem::path& default_bag) {
  RunSummary run;
  run.scene = scene.name, run.device = options.ring.device.device,
  run.motion = options.ring.device.motion;
  run.mode = options.node.lockstep ? "lockstep" : "real time";
  run.seed = options.node.seed;
  run.validate_every = static_cast<double>(options.ring.validator.every);
  run.limits = options.limits;
  if (!options.no_record)
    run.bag = (default_bag.empty() ? options.ring.logger.bag : default_bag).string();
  return run;
}

}  // namespace

RingRun::RingRun(const UpOptions& options, const scene::Scene& scene, StartReport start)
    : options_(options),
      default_bag_(options.no_record || options.ring.logger.bag.empty()
                       ? make_default_bag(scene.name, options.node)
                       : std::filesystem::path()),
      summary_(begin_summary(options, scene, default_bag_.folder())),
      claim_(options.node),
      monitor_(claim_.participant(), options.node.rig, options.node.ros, std::move(start)),
      faults_(fault_folder_of(summary_.bag.empty() ? default_bag_.folder()
                                                   : std::filesystem::path(summary_.bag))),
      nodes_(launcher_options(scene), scene, options.restarts) {
  claim_.announce();
}

LauncherOptions RingRun::launcher_options(const scene::Scene& scene) const {
  runtime::NodeOptions node = options_.node;
  node.peers = {"rendering", "coupling"};
  if (node.lockstep)
    node.peers.push_back("validator");  // in real time it only listens, and no node waits for it
  if (!options_.no_record)
    node.peers.push_back("logger");
  node.rig_is_checked = true;
  node.up = claim_.participant().guid();
  LauncherOptions ring = options_.ring;
  for (runtime::NodeOptions* one : std::initializer_list<runtime::NodeOptions*>{
           &ring.device, &ring.rendering, &ring.coupling, &ring.logger, &ring.validator})
    *one = node;
  ring.logger.bag = summary_.bag;
  ring.logger.bag_is_made = !default_bag_.folder().empty();
  ring.device.fault_records = ring.coupling.fault_records = faults_;
  ring.record = !options_.no_record;
  if (const effects::EffectSpec* external = effects::external_of(scene.effects);
      external && !node.lockstep)
    ring.logger.topics.push_back(qos::dds_name(qos::external_topic(external->text), node.rig));
  return ring;
}

RunSummary RingRun::go() {
  claim_.take();
  if (!runtime::stop_requested().load())
    nodes_.start();
  watch();
  nodes_.stop(monitor_, options_.ring.device.duration_s > 0);
  monitor_.report_to(summary_);
  nodes_.report_to(summary_);
  if (!refusal_.empty()) {
    remove_bag();
    throw std::runtime_error(refusal_);
  }
  summary_.fault_records = faults::fault_records_in(faults_);
  if (!summary_.bag.empty()) {
    auto bag = bag::BagReader::open(summary_.bag);
    summary_.recorded =
        bag ? BagState{bag->message_count(), bag->losses()} : BagState{0, {bag.error().sentence}};
  }
  summary_.verdict = judge(summary_);
  return std::move(summary_);
}

void RingRun::watch() {
  std::int64_t next_line = runtime::monotonic_ns();
  while (!runtime::stop_requested().load() && !page_has_chosen_) {
    poll();
    if (runtime::monotonic_ns() >= next_line) {
      monitor_.print(nodes_);
      next_line += 1'000'000'000;
    }
    start_device();
    const std::optional<std::string> lost = monitor_.watch(nodes_);
    if (lost)
      summary_.events.push_back({RunFact::kNodeSilent, *lost, 1e-9 * runtime::kGivenUpNs});
    bool over = lost || !nodes_.poll(monitor_);
    for (const std::string& node : nodes_.take_restarting())
      monitor_.forget(node);
    if (!over)
      over = !nodes_.restart(monitor_);
    if (over) {
      // Were the device stopped at once, the force would end in a step without a reason.
      if (nodes_.is_running("device"))
        std::this_thread::sleep_for(kGuardActs);
      return;
    }
    const bool starts = !nodes_.device_is_started() || !monitor_.players().contains("device");
    ::usleep(starts
                 ? kStartPeriodUs
                 : kWatchPeriodUs);  // ended at once by a signal: Ctrl-C, or that a node has died
  }
  console::log("stopping\n");
  if (const double duration_s = options_.ring.device.duration_s; duration_s > 0)
    summary_.events.push_back({RunFact::kCutShort, "", duration_s});
}

void RingRun::poll() {
  monitor_.poll(nodes_);
  claim_.name(monitor_.players());
  if (const std::optional<int> status = page_ ? page_->ended() : std::nullopt) {
    page_ = nullptr;
    page_has_chosen_ = *status == view::kChosenStatus;
    if (page_has_chosen_)
      return;
    console::log("warning: the page ended by {}; `voxtouch view` serves it again\n",
                 how_ended(*status));
    summary_.events.push_back({RunFact::kPageEnded, "view", 0.0, 0.0, how_ended(*status)});
  }
  if (refusal_.empty())
    refusal_ = refused_at_start();  // the last status of a stopped node does not state it
}

void RingRun::start_device() {
  if (nodes_.device_is_started() || !monitor_.is_ready("rendering") ||
      !monitor_.is_ready("coupling"))
    return;
  if (options_.no_record || monitor_.is_ready("logger"))
    nodes_.start_device();
}

std::string RingRun::refused_at_start() const {
  const Reports& reports = monitor_.reports();
  if (number(reports, "coupling", "samples") > 0)
    return {};
  for (const char* name : {"coupling", "rendering"}) {
    const auto report = reports.find(name);
    if (report == reports.end() || report->second.state != runtime::NodeState::kFailed)
      continue;
    if (const std::string why = word(reports, name, runtime::kRefusal); !why.empty())
      return does_not_go_with(options_.node.scene, summary_.device, why);
    if (!StartReport::scene_is_built(reports))
      return report->second.message;
  }
  return {};
}

void RingRun::remove_bag() const {
  const auto logger = summary_.reports.find("logger");
  if (summary_.bag.empty() || logger == summary_.reports.end() ||
      logger->second.state == runtime::NodeState::kFailed)
    return;
  std::error_code ignored;
  std::filesystem::remove_all(summary_.bag, ignored);
}

}  // namespace voxtouch::cli
