#include "nodes/device/device_node.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <random>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "core/scene/scene_file.hpp"
#include "core/types/fnv.hpp"
#include "core/types/number.hpp"
#include "devices/registry.hpp"
#include "devices/settings.hpp"
#include "nodes/device/described_device.hpp"
#include "nodes/device/device_loop.hpp"
#include "nodes/device/joint_outputs.hpp"
#include "nodes/device/last_second.hpp"
#include "nodes/device/recording.hpp"
#include "nodes/log/tell.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/device_message.hpp"
#include "nodes/runtime/held_start.hpp"
#include "nodes/runtime/housekeeping.hpp"
#include "nodes/runtime/participation.hpp"
#include "nodes/runtime/recorder_gate.hpp"
#include "nodes/runtime/role_binding.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::device_node {
namespace {

using runtime::NodeState;

/// New at each start. In lockstep the same for the same run, since recordings must not differ by a
/// bit, but for a device that is started anew among nodes that keep running: `sessions` is how many
/// these have seen.
std::uint64_t make_session_id(const Options& options, const scene::Scene& scene,
                              std::uint64_t sessions) {
  if (!options.lockstep) {
    std::random_device
        random;  // no clock: two hosts' need not agree, and one host's may be set back
    std::uint64_t id = 0;
    while (id == 0)
      id = (static_cast<std::uint64_t>(random()) << 32U) | random();
    return id;
  }
  std::string anew = sessions ? fmt::format("/{}", sessions) : "";
  for (const std::string& setting : options.settings)
    anew += "/" + setting;
  Fnv1a hash;
  hash.add(fmt::format("{}/{}/{}/{}/{}{}", scene.hash, options.device, options.motion,
                       to_text(options.hand), options.seed, anew));
  return hash.value();
}

/// What the device says of its trouble, or else the kind of it.
std::string trouble_of(const devices::Driver& driver, devices::DeviceError error) {
  const std::string text = driver.trouble();
  return text.empty()
             ? fmt::format("the last call of its driver ended as '{}'", devices::name_of(error))
             : text;
}

std::string sentence(End end, const devices::Driver& driver) {
  const std::string trouble = driver.trouble();
  switch (end) {
    case End::kNone:
      return "running";
    case End::kStopped:
      return "stopped on request; the device is at zero force";
    case End::kFinished:
      return "finished; the device is at zero force";
    case End::kPeerSilent:
      return "no command came for 5 s: is the coupling node alive? The device is at zero force";
    case End::kPeerGone:
      return "a node that takes part has gone";
    case End::kDeviceGone:
      return fmt::format("{} does not answer any more, zero force was its last command: {}",
                         driver.description().model,
                         trouble.empty() ? "check its cable and power" : trouble);
    case End::kDeviceFault:
      return fmt::format(
          "{} reported a fault and needs a person; it was told to give zero force{}{}",
          driver.description().model, trouble.empty() ? "" : ": ", trouble);
    case End::kRigClaimed:
      return "another device runs in this rig and stays; this one is at zero force. Choose another "
             "--rig or "
             "--domain";
    case End::kWriteBlocked:
      return "a sample could not be handed to DDS; the device is at zero force";
  }
  return "unknown";
}

/// Refuses to be the second device of a rig: two would fight over the same namespace. Looks for 400
/// ms, or as long as it is held: whoever lets it begin has looked himself. Returns how many
/// sessions the other nodes have seen; nothing where it is to leave without having begun.
std::optional<std::uint64_t> require_free_rig(const bus::Participant& participant,
                                              const Options& options,
                                              const std::atomic<bool>& stop) {
  runtime::NodeRegistry registry(participant, options.rig);
  const std::int64_t until = runtime::monotonic_ns() + (runtime::was_held() ? 0 : 400'000'000);
  for (;; std::this_thread::sleep_for(std::chrono::milliseconds(10))) {
    const runtime::Word word = runtime::word_of_starter();
    if (stop.load() || word == runtime::Word::kLeave)
      return std::nullopt;
    const bool looked = runtime::monotonic_ns() >= until;
    registry.update();  // after the clock: what is seen is not older
    if (word == runtime::Word::kNone)
      continue;  // whoever holds it looks too, and says it better
    for (const runtime::NodeReport& other : registry.reports())
      if (other.node == "device" && !other.final())
        throw std::runtime_error(
            fmt::format("a device already runs in rig '{}' on domain {} (process {} on {}). Stop "
                        "it, or choose another "
                        "--rig or --domain",
                        options.rig, options.domain, other.pid, other.host));
    if (looked)
      return runtime::sessions_seen(registry);
  }
}

/// All of the node: endpoints, driver, loop; the housekeeping thread looks in from beside.
class DeviceNode {
 public:
  /// `sessions`: how many the other nodes of the rig have seen.
  DeviceNode(const Options& options, const scene::Scene& scene, bus::Participant participant,
             std::uint64_t sessions, const std::atomic<bool>& stop)
      : options_(options),
        scene_(scene),
        participant_(std::move(participant)),
        session_(make_session_id(options, scene, sessions)),
        driver_(open_driver(scene, stop)) {
    if (const arm::ArmDescription* const arm = driver_->arm_description()) {
      joints_.emplace(participant_, options.rig, *arm, options.mode());
      driver_ = std::make_unique<ShownDriver>(std::move(driver_), *joints_);
    }
    states_ = {participant_, qos::kDeviceState, options.rig,
               qos::profile_in(qos::kDeviceState, options.mode())};
    descriptions_ = {participant_, qos::kDeviceDescription, options.rig,
                     qos::profile_in(qos::kDeviceDescription, options.mode())};
    commands_.emplace(participant_, qos::kForceCommand, options.rig,
                      qos::profile_in(qos::kForceCommand, options.mode()));
    wait_set_.emplace(participant_);
    commands_->attach_to(*wait_set_);
    links_ = {runtime::link_of_writer(qos::kDeviceState, states_),
              runtime::link_of_writer(qos::kDeviceDescription, descriptions_),
              runtime::link_of_reader(qos::kForceCommand, *commands_)};
    coupling_.emplace("coupling", std::vector<bus::Following*>{}, &*commands_);
    keeper_.emplace(participant_, options.rig);
    faults_ = make_faults(options.fault_records, options.rig, driver_->description().rate_hz);
    describe();
  }

  int run(const std::atomic<bool>& stop) {
    DeviceLoop loop(settings(), *driver_, states_, *commands_, *wait_set_, progress_, requests_,
                    *faults_);
    End end = End::kNone;
    {
      runtime::Housekeeping housekeeping(
          participant_, "device", options_,
          [this](runtime::NodeRegistry& registry, runtime::NodeReport& report) {
            look(registry, report);
          },
          {{"its loop", [this] { return progress_.heartbeat.sign(); }}});
      end = wait_for_peers(stop);
      runtime::enter_loop(options_.realtime);
      if (end == End::kNone)
        end = loop.run(stop);
      progress_.end.store(end, std::memory_order_release);
      if (options_.lockstep)
        states_.wait_for_acknowledgments(DDS_SECS(5));
    }
    const bool good = end == End::kFinished || (end == End::kStopped && options_.duration_s == 0.0);
    if (!good && end != End::kStopped)
      log::tell("error: device: {}\n", end_sentence(end));
    return good ? 0 : 1;
  }

 private:
  std::unique_ptr<devices::Driver> open_driver(const scene::Scene& scene,
                                               const std::atomic<bool>& stop) const {
    const Motion motion =
        motion_in_device(choose_motion(scene, options_.motion), scene.device.pose_WD,
                         scene.device.pose_PT, scene.device.position_scale);
    devices::DeviceOptions device;
    device.seed = options_.seed;
    device.motion = motion;
    device.described = description_of(options_.device);
    device.lockstep = options_.lockstep;
    device.settings = devices::parse_settings(options_.settings);
    device.recorded = recorded_hand(options_.device, device.settings);
    device.hand = choose_hand(options_.device, options_.hand, device);
    device.cancelled = &stop;
    try {
      if (options_.lockstep && !devices::has_simulated_hand(options_.device) && !device.recorded)
        throw devices::DeviceOpenError(options_.device +
                                       " lives in real time: --lockstep needs a simulated device");
      std::unique_ptr<devices::Driver> driver = devices::open_device(options_.device, device);
      if (options_.lockstep && !driver->simulated())
        throw devices::DeviceOpenError(driver->description().model +
                                       " did not take up virtual time, which --lockstep needs");
      return driver;
    } catch (const std::exception& error) {
      report_failure(error.what());
      throw;
    }
  }

  void describe() {
    DeviceDescription device = driver_->description();
    device.simulated = driver_->simulated();
    device.network_delay_s = 1e-3 * options_.network_delay_ms;
    msg::DeviceDescription message = runtime::to_msg(device);
    message.session_id = session_, message.lockstep = options_.lockstep;
    descriptions_.write(message);
  }

  /// To whoever listens, such as `up`: a node that cannot start says why in its status too.
  void report_failure(const std::string& message) const {
    runtime::NodeOptions silent = options_;
    silent.announce = false;  // the error itself is printed
    const runtime::Housekeeping housekeeping(
        participant_, "device", silent, [&](runtime::NodeRegistry&, runtime::NodeReport& report) {
          report.state = NodeState::kFailed;
          report.message = message;
        });
    std::this_thread::sleep_for(
        std::chrono::milliseconds(200));  // they have to find this writer first
  }

  DeviceLoop::Settings settings() const {
    DeviceLoop::Settings s;
    s.session_id = session_;
    s.lockstep = options_.lockstep;
    s.epoch_ns = options_.lockstep ? 0 : runtime::realtime_ns();
    s.max_samples = static_cast<std::uint64_t>(
        std::ceil(options_.duration_s * driver_->description().rate_hz - 1e-6));  // 0 only for 0
    if (const std::uint64_t recorded = driver_->recorded_samples(); recorded > 0)
      s.max_samples = s.max_samples ? std::min(s.max_samples, recorded) : recorded;
    return s;
  }

  /// Lockstep: sample 0 waits until everybody who takes part has answered ready for this session.
  /// In real time it waits for the recorder; a device that paces itself waits for nobody.
  End wait_for_peers(const std::atomic<bool>& stop) {
    const std::int64_t give_up = runtime::monotonic_ns() + 60'000'000'000;
    while (options_.lockstep ? !peers_ready_.load(std::memory_order_acquire)
                             : driver_->simulated() && !recorder_.open()) {
      progress_.heartbeat.beat();
      if (stop.load())
        return End::kStopped;
      if (requests_.rig_claimed.load())
        return End::kRigClaimed;
      if (runtime::monotonic_ns() > give_up) {
        peers_late_ = true;
        return End::kPeerSilent;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return End::kNone;
  }

  std::string end_sentence(End end) const {
    if (end == End::kPeerGone)
      return gone_ + "; the device is at zero force";
    return peers_late_
               ? "not every node that takes part was ready within 60 s; missing: " + waiting_for_
               : sentence(end, *driver_);
  }

  void look(runtime::NodeRegistry& registry, runtime::NodeReport& report) {
    const End end = progress_.end.load(std::memory_order_acquire);
    coupling_->update(registry, session_);
    if (const runtime::NodeReport* coupling =
            coupling_->participant() ? registry.report_of(*coupling_->participant()) : nullptr)
      if (faults_of_coupling_.see(*coupling))
        requests_.coupling_fault.store(true);
    keeper_->listen(session_, progress_.lock);
    watch_peers(registry);
    watch_rig(registry);
    recorder_.look(registry, states_);
    if (!recorder_.open())
      waiting_for_ = "the logger";
    if (!options_.lockstep && reminder_.is_due(registry, session_, qos::kDeviceDescription))
      describe();
    const std::string foreign = coupling_->trouble(registry);
    report.session_id = session_;
    report.partners = partners_.participants();
    const bool running = progress_.started_ns.load() != 0;
    report.state = end == End::kNone ? (running ? NodeState::kRunning : NodeState::kReady)
                   : end == End::kStopped || end == End::kFinished ? NodeState::kStopped
                                                                   : NodeState::kFailed;
    if (end == End::kNone && progress_.in_trouble.load())
      trouble_ = trouble_of(*driver_, progress_.last_error.load());
    if (const std::int64_t gap_ns = progress_.longest_gap_ns.load(); gap_ns > reported_gap_ns_) {
      reported_gap_ns_ = gap_ns;
      trouble_ = fmt::format("its process was kept from running for {:.0f} ms",
                             static_cast<double>(gap_ns) * 1e-6);
    }
    look_for_late_commands();
    report.message =
        end != End::kNone ? end_sentence(end)
        : progress_.in_trouble.load()
            ? fmt::format("{} is at zero force: {}", driver_->description().model, trouble_)
        : !late_.empty()   ? late_
        : !rival_.empty()  ? "another device runs in this rig, one of the two goes: " + rival_
        : !foreign.empty() ? foreign
        : running          ? "running" + network_
                           : "waiting for " + waiting_for_;
    fill(report);
    coupling_->report_to(report, registry);
    progress_.lock.report_to(report, end == End::kNone);
  }

  /// Where more than half of a second's commands were over when they came, no force is felt and the
  /// reason is the network.
  void look_for_late_commands() {
    const std::uint64_t refused = progress_.refused_late.load(), samples = progress_.samples.load();
    if (samples - samples_at_look_ < static_cast<std::uint64_t>(driver_->description().rate_hz))
      return;
    const bool late = 2 * (refused - refused_at_look_) > samples - samples_at_look_;
    samples_at_look_ = samples, refused_at_look_ = refused;
    const double met_ms = 1e-3 * progress_.latency.quantile_us(0.5);
    if (options_.network_delay_ms > 0.0 && !options_.lockstep &&
        std::abs(met_ms - told_ms_) > 0.2 * told_ms_) {  // a sentence that stands for a while
      told_ms_ = met_ms;
      network_ = fmt::format(
          "; the coupling is designed for {:.4g} ms of network, commands come after {:.1f} ms, 99 "
          "of 100 within {:.0f} ms",
          options_.network_delay_ms, met_ms, std::ceil(1e-3 * progress_.latency.quantile_us(0.99)));
    }
    late_ = !late ? ""
                  : fmt::format(
                        "commands come {:.1f} ms after the samples that they answer, too late for "
                        "any force: the coupling was designed for {:.4g} ms of "
                        "network. A shorter way, or --network-delay {:.0f} and less stiffness",
                        met_ms, options_.network_delay_ms,
                        std::ceil(1e-3 * progress_.latency.quantile_us(0.9)));
  }

  void watch_peers(runtime::NodeRegistry& registry) {
    if (!options_.lockstep)
      return;
    partners_.update(options_, registry, links_, session_);
    waiting_for_ = runtime::missing_links(options_, registry, links_);
    for (const std::string& peer : partners_.missing())
      waiting_for_ += (waiting_for_.empty() ? "" : ", ") + peer + " to be ready";
    if (waiting_for_.empty() && partners_.complete() && coupling_->bound())
      peers_ready_.store(true, std::memory_order_release);
    if (!peers_ready_.load())
      return;
    const std::vector<runtime::Hung> all_hung = registry.hung();
    for (const bus::Guid& partner : partners_.participants()) {
      const runtime::NodeReport* report =
          registry.report_of(partner);  // kept by the housekeeping, also of one that has gone
      const std::string node = report ? report->node : "a node";
      const auto hung = std::find_if(all_hung.begin(), all_hung.end(), [&](const runtime::Hung& h) {
        return h.participant == partner;
      });
      // DDS takes one that stands still for gone after some seconds.
      const bool gone = !registry.is_here(partner), silent = hung != all_hung.end();
      if (report && report->state == NodeState::kFailed)
        lose(node + " takes part and has failed");
      else if (silent && (gone || hung->for_s * 1e9 >= runtime::kGivenUpNs))
        lose(fmt::format("{} has given no sign of life for {:.1f} s", node, hung->for_s));
      else if (gone)
        lose(node + " takes part and has gone");
    }
  }

  /// Lockstep: the run cannot go on without it.
  void lose(std::string sentence) {
    if (gone_.empty())
      gone_ = std::move(sentence);
    requests_.peer_gone.store(true);
  }

  /// Two devices of one rig: after a network split, or after a start at the same time, when neither
  /// sees the other. Each says, once, how many of its samples had been answered when it first saw
  /// the other: the one with more, whose ring is with it, stays; of equal ones that with the
  /// smaller GUID. Neither number changes any more, so both decide alike, and no clock takes part.
  void watch_rig(const runtime::NodeRegistry& registry) {
    rival_.clear();
    for (const runtime::NodeReport& other : registry.reports()) {
      if (other.node != "device" || other.participant == participant_.guid() ||
          other.state == NodeState::kStopped || other.state == NodeState::kFailed)
        continue;
      rival_ = registry.name_of(other.participant);
      if (!claim_)
        claim_ = progress_.latency.count();
      const auto theirs = other.figures.find(kClaim);
      if (theirs == other.figures.end())
        continue;  // it has not seen this one yet
      const std::uint64_t count = runtime::as_count(theirs->second.value);
      if (count != *claim_ ? count > *claim_ : other.participant < participant_.guid())
        requests_.rig_claimed.store(true);
    }
    if (rival_.empty())
      claim_.reset();
  }

  void fill(runtime::NodeReport& report) {
    report.values = {{"scene", scene_.name},
                     {"scene_hash", scene_.hash},
                     {"device", driver_->description().model},
                     {"recorded", driver_->recorded_samples()
                                      ? options_.device.substr(devices::kRecordedPrefix.size())
                                      : ""},
                     {"trouble", trouble_}};
    const bool timed =
        !options_.lockstep;  // a run in lockstep must not differ from the next by what a clock says
    const std::int64_t started = progress_.started_ns.load(), ended = progress_.ended_ns.load();
    const double elapsed_s =
        started ? static_cast<double>((ended ? ended : runtime::monotonic_ns()) - started) * 1e-9
                : 0.0;
    const std::uint64_t samples = progress_.samples.load();
    const double own_rate_hz = driver_->description().rate_hz;
    const auto latency_us = [&](double us) {
      return runtime::Figure(timed ? std::round(us) : 0.0, "us");
    };
    last_second_.look(runtime::monotonic_ns(), samples, progress_.latency.count(),
                      progress_.recent_max_force_n.exchange(0.0));
    report.figures = {
        {"samples", {samples, "samples"}},
        {"nominal_rate_hz", {own_rate_hz, "Hz"}},
        {"last_second_max_force_n", {last_second_.largest_force_n(), "N"}},
        {"last_second_answered_share", {last_second_.answered_share(), "1"}},
        {"longest_gap_ms", {static_cast<double>(progress_.longest_gap_ns.load()) * 1e-6, "ms"}},
        {"rate_hz",
         {timed && elapsed_s > 0 ? static_cast<double>(samples) / elapsed_s : own_rate_hz, "Hz"}},
        {"latency_p50_us", latency_us(progress_.latency.quantile_us(0.5))},
        {"latency_p99_us", latency_us(progress_.latency.quantile_us(0.99))},
        {"latency_max_us", latency_us(progress_.latency.max_us())},
        {"answered", {progress_.latency.count(), "samples"}},
        {"overruns", {progress_.overruns.load(), "periods"}},
        {"deadline_misses",
         {ended ? progress_.deadline_misses.load() : commands_->deadlines_missed(), "deadlines"}},
        {"max_force_n", {progress_.max_force_n.load(), "N"}},
        {"force_n", {progress_.force_n.load(), "N"}},
        {"refused", {progress_.refused.load() + coupling_->refused(), "commands"}},
        {"refused_late", {progress_.refused_late.load(), "commands"}},
        {"clamped", {progress_.clamped.load(), "commands"}},
        {"interruptions", {progress_.interruptions.load(), "times"}},
        {"zero_force_samples", {progress_.zero_force_samples.load(), "samples"}},
        {"held_poses", {progress_.untrusted_poses.load(), "samples"}},
        {"faded", {progress_.faded.load(), "samples"}},
        {"foreign_commands", {coupling_->refused(), "commands"}}};
    if (const std::uint64_t first = progress_.first_answered.load(); first != Progress::kNone)
      report.figures["first_answered"] = {first, "sample number"};
    faults_->report_to(report);
    if (claim_)
      report.figures[kClaim] = {*claim_, "samples"};
  }

  static constexpr char kClaim[] = "answered_before_rival";
  const Options& options_;
  const scene::Scene& scene_;
  bus::Participant participant_;
  std::uint64_t session_;
  std::unique_ptr<Faults>
      faults_;  ///< before the driver, which closes first: a disk that hangs must not keep it open
  std::optional<JointOutputs> joints_;  ///< of an arm; the driver tells it
  std::unique_ptr<devices::Driver> driver_;
  bus::Writer<msg::DeviceState> states_;
  bus::Writer<msg::DeviceDescription> descriptions_;
  std::optional<runtime::PairReader<msg::ForceCommand>> commands_;
  std::optional<runtime::RoleBinding> coupling_;
  runtime::Reminder reminder_;
  std::optional<bus::WaitSet> wait_set_;
  std::vector<runtime::Link> links_;
  runtime::RecorderGate recorder_{options_};
  runtime::Partners partners_{{"rendering", "coupling", "logger", "validator"}};
  Progress progress_;
  Requests requests_;
  std::atomic<bool> peers_ready_{false};
  std::atomic<bool> peers_late_{false};
  faults::OthersFaults faults_of_coupling_;
  std::optional<faults::LockKeeper> keeper_;
  std::optional<std::uint64_t> claim_;
  std::string rival_, waiting_for_;
  std::string gone_;  ///< lockstep: who was lost, and how
  LastSecond last_second_;
  std::int64_t reported_gap_ns_ = 0;
  std::uint64_t samples_at_look_ = 0, refused_at_look_ = 0;
  std::string late_;      ///< what is said where commands come too late
  std::string network_;   ///< what the coupling was designed for and what is met, where a network's
                          ///< delay was told
  double told_ms_ = 0.0;  ///< that is met, in it
  std::string trouble_;   ///< what last kept the device from giving force
};

/// What is wrong with a duration as typed [s]; empty if nothing: 0 to 1e8 (three years), for
/// samples are counted in whole numbers.
std::string check_duration(const std::string& text) {
  const double seconds = parse_finite(text).value_or(-1.0);
  if (seconds == 0.0 || (seconds >= 1e-6 && seconds <= 1e8))
    return {};
  return "'" + text.substr(0, 64) + "' is no duration: 0 (no end), or seconds from 1e-6 to 1e8";
}

}  // namespace

void add_device_options(CLI::App& app, Options& options) {
  app.add_option(
         "--device", options.device,
         fmt::format("{}; sim:FILE, or sim: and one of {}: as a file describes it; replay:BAG: the "
                     "hand of a recording,\nwhich no force moves",
                     fmt::join(devices::device_names(), ", "), fmt::join(shipped_devices(), ", ")))
      ->capture_default_str();
  app.add_option(
         "--device-option", options.settings,
         "KEY=VALUE of this device (deploy/devices/*.md list them); may be given more than once")
      ->allow_extra_args(false);
  faults::add_option(app, options.fault_records);
  app.add_option("--network-delay", options.network_delay_ms,
                 "Milliseconds that the network between device and coupling takes, there and back: "
                 "the coupling is designed for them, which costs\n"
                 "stiffness. Default 0: one host, or a switch")
      ->check(CLI::Range(0.0, 100.0));
  app.add_option("--motion", options.motion,
                 "What the simulated hand does: a motion of the scene (hit, slide, circle, free)");
  app.add_option("--duration", options.duration_s, "Seconds of device time; 0 = until stopped")
      ->capture_default_str()
      ->check(check_duration);
  add_hand_options(app, options.hand);
}

Motion choose_motion(const scene::Scene& scene, const std::string& name) {
  if (scene.motions.empty() && !name.empty())
    throw std::runtime_error(
        fmt::format("{}: the scene has no motions, so there is no '{}'; add it under `motions:`",
                    scene.file.string(), name));
  if (scene.motions.empty()) {
    Motion rest;
    rest.path = {Vec3::Zero()};
    return rest;
  }
  if (name.empty()) {
    Motion rest = scene.motions.begin()->second;
    rest.path.resize(1);
    rest.repeat_from.reset();
    rest.circle_centre.reset();
    rest.turn = {};
    return rest;
  }
  const auto found = scene.motions.find(name);
  if (found != scene.motions.end())
    return found->second;
  std::string known;
  for (const auto& [key, motion] : scene.motions)
    known += (known.empty() ? "" : ", ") + key;
  throw std::runtime_error(fmt::format("{}: there is no motion '{}'; this scene has {}",
                                       scene.file.string(), name, known));
}

int run(const Options& options, const std::atomic<bool>& stop) {
  const scene::Scene scene = scene::load_scene(options.scene);
  bus::Participant participant(options.participant("device"));
  const std::optional<std::uint64_t> sessions = require_free_rig(participant, options, stop);
  if (!sessions)
    return 0;
  DeviceNode node(options, scene, std::move(participant), *sessions, stop);
  return node.run(stop);
}

}  // namespace voxtouch::device_node
