#include "nodes/device/device_node.hpp"

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
#include "nodes/console/log.hpp"
#include "nodes/device/described_device.hpp"
#include "nodes/device/device_monitor.hpp"
#include "nodes/device/joint_outputs.hpp"
#include "nodes/device/led_driver.hpp"
#include "nodes/runtime/device_message.hpp"

namespace voxtouch::device_node {
namespace {

/// Returns a new session id at each start. In lockstep it is a function of the run, because
/// recordings must be bit-identical. It then includes `sessions`, the number of sessions that the
/// other nodes have observed. A device that is restarted among running nodes thus gets a new id.
std::uint64_t make_session_id(const Options& options, const scene::Scene& scene,
                              std::uint64_t sessions) {
  if (!options.lockstep) {
    // Not from a clock: clocks of two hosts may differ, and a clock may be set back.
    std::random_device random;
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

/// Refuses to become the second device of a rig, since both would use the same topics. Listens for
/// 400 ms, or polls once if the starting program has checked the rig. Returns the number of
/// sessions that the other nodes have observed; nothing if a stop was requested.
std::optional<std::uint64_t> require_free_rig(const bus::Participant& participant,
                                              const Options& options,
                                              const std::atomic<bool>& stop) {
  runtime::NodeRegistry registry(participant, options.rig);
  const std::int64_t until = runtime::monotonic_ns() + (options.rig_is_checked ? 0 : 400'000'000);
  for (;; std::this_thread::sleep_for(std::chrono::milliseconds(10))) {
    if (stop.load())
      return std::nullopt;
    // Read the clock before the reports, so that the last look is after `until`.
    const bool looked = runtime::monotonic_ns() >= until;
    registry.update();
    for (const runtime::NodeReport& other : registry.reports())
      if (other.node == "device" && !other.final())
        throw std::runtime_error(
            fmt::format("A device already runs in rig '{}' on domain {} (process {} on {}). Stop "
                        "it, or choose another --rig or --domain",
                        options.rig, options.domain, other.pid, other.host));
    if (looked)
      return runtime::sessions_seen(registry);
  }
}

/// Opens a driver for these options. Throws if the device does not open.
std::unique_ptr<devices::Driver> open_driver(const Options& options, const scene::Scene& scene,
                                             const std::atomic<bool>& stop) {
  check_hand_from(options.device, options.hand, options.lockstep);
  devices::DeviceOptions device;
  device.seed = options.seed;
  device.motion = motion_in_device(choose_motion(scene, options.motion), scene.device.pose_WD,
                                   scene.device.pose_PT, scene.device.position_scale);
  device.is_led = options.hand.from_page;
  if (device.is_led)
    device.motion->press.clear();  // no button is pressed meanwhile
  device.described = description_of(options.device);
  device.lockstep = options.lockstep;
  device.settings = devices::parse_settings(options.settings);
  device.hand = choose_hand(options.device, options.hand, device);
  device.cancelled = &stop;
  if (options.lockstep && !devices::has_simulated_hand(options.device))
    throw devices::DeviceOpenError(options.device +
                                   " runs in real time: --lockstep needs a simulated device");
  std::unique_ptr<devices::Driver> driver = devices::open_device(options.device, device);
  if (options.lockstep && !driver->simulated())
    throw devices::DeviceOpenError(driver->description().model +
                                   " does not support virtual time, which --lockstep needs");
  return driver;
}

/// Also publishes the joints of an arm.
std::unique_ptr<devices::Driver> with_joints(std::unique_ptr<devices::Driver> driver,
                                             const runtime::NodeHost& host) {
  const arm::ArmDescription* const arm = driver->arm_description();
  if (!arm)
    return driver;
  return std::make_unique<JointPublishingDriver>(std::move(driver), host.participant(),
                                                 host.options().rig, *arm, host.options().mode());
}

/// The description for the design: the driver's figures, or those of a measured file. Throws if the
/// file belongs to another device.
DeviceDescription describe_driver(const Options& options, const devices::Driver& driver) {
  DeviceDescription device = driver.description();
  device.simulated = driver.simulated();
  device.network_delay_s = 1e-3 * options.network_delay_ms;
  if (options.device_file.empty())
    return device;
  const scene::DeviceFile file = scene::load_device_file(options.device_file);
  require_same_device(options.device_file, file, device, driver.serial());
  return scene::measured_device(file, device);
}

class DeviceNode {
 public:
  /// `sessions`: number of sessions that the other nodes of the rig have observed.
  DeviceNode(const Options& options, const scene::Scene& scene, bus::Participant participant,
             std::uint64_t sessions, const std::atomic<bool>& stop)
      : options_(options),
        scene_(scene),
        session_(make_session_id(options, scene, sessions)),
        host_("device", options, std::move(participant)),
        driver_(with_page(with_joints(open(stop), host_))),
        description_(describe_opened()),
        states_(host_.writer<msg::DeviceState>(qos::kDeviceState)),
        descriptions_(host_.writer<msg::DeviceDescription>(qos::kDeviceDescription)),
        commands_(host_.reader<bus::FollowedReader<msg::ForceCommand>>(qos::kForceCommand)) {
    host_.link_writer(qos::kDeviceState, states_);
    host_.link_writer(qos::kDeviceDescription, descriptions_);
    host_.link_reader(qos::kForceCommand, commands_);
    faults_ = make_faults(options.fault_records, options.rig, driver_->description().rate_hz);
    if (!options.device_file.empty())
      progress_.start_check.start(description_);
    monitor_.emplace(host_, *driver_, commands_, progress_, requests_, *faults_,
                     options.network_delay_ms);
    describe();
  }

  int run(const std::atomic<bool>& stop) {
    DeviceLoop loop(settings(), *driver_, states_, commands_, host_.wait_set(), progress_,
                    requests_, *faults_);
    End end = End::kNone;
    const auto report = [this](runtime::NodeRegistry& registry, runtime::NodeReport& status,
                               runtime::StatusText& text) {
      if (host_.must_repeat(registry, session_, qos::kDeviceDescription))
        describe();
      status.values = {{"scene", scene_.name}, {"scene_hash", scene_.hash}};
      monitor_->report_to(session_, registry, status, text);
      if (led_)
        led_->report_to(registry, status, text);
    };
    const auto cycles = [&] {
      end = wait_for_peers(stop);
      if (end == End::kNone)
        end = loop.run(stop);
      progress_.end.store(end, std::memory_order_release);
      if (options_.lockstep)
        states_.wait_for_acknowledgments(DDS_SECS(5));
    };
    host_.monitored(stop, report, cycles,
                    {{"its loop", [this] { return progress_.heartbeat.sign(); }}});
    const bool good = end == End::kFinished || (end == End::kStopped && options_.duration_s == 0.0);
    if (!good && end != End::kStopped)
      console::log("error: device: {}\n", monitor_->sentence(end));
    return good ? 0 : 1;
  }

 private:
  /// Lets a page lead the simulated operator, if selected.
  std::unique_ptr<devices::Driver> with_page(std::unique_ptr<devices::Driver> driver) {
    if (!options_.hand.from_page)
      return driver;
    auto led = std::make_unique<LedDriver>(std::move(driver), host_, session_);
    led_ = led.get();
    return led;
  }

  std::unique_ptr<devices::Driver> open(const std::atomic<bool>& stop) const {
    try {
      return open_driver(options_, scene_, stop);
    } catch (const std::exception& error) {
      host_.report_failure(error.what());
      throw;
    }
  }

  DeviceDescription describe_opened() const {
    try {
      return describe_driver(options_, *driver_);
    } catch (const std::exception& error) {
      host_.report_failure(error.what());
      throw;
    }
  }

  void describe() {
    msg::DeviceDescription message = runtime::to_msg(description_);
    message.session_id = session_, message.lockstep = options_.lockstep;
    descriptions_.write(message);
  }

  DeviceLoop::Settings settings() const {
    DeviceLoop::Settings s;
    s.session_id = session_;
    s.lockstep = options_.lockstep;
    s.epoch_ns = options_.lockstep ? 0 : runtime::realtime_ns();
    // 0 only for a duration of 0.
    s.max_samples = static_cast<std::uint64_t>(
        std::ceil(options_.duration_s * driver_->description().rate_hz - 1e-6));
    return s;
  }

  /// In lockstep, sample 0 waits until every participating node is ready for this session. In real
  /// time, a simulated device waits for a limited time until they have matched, so that sample 0 is
  /// recorded. A late node then misses samples in the bag; no force is affected.
  End wait_for_peers(const std::atomic<bool>& stop) {
    const std::int64_t begin = runtime::monotonic_ns(), give_up = begin + 60'000'000'000;
    while (!monitor_->peers().ready()) {
      if (!options_.lockstep &&
          (!driver_->simulated() || runtime::monotonic_ns() - begin > 5'000'000'000))
        break;
      progress_.heartbeat.beat();
      if (stop.load())
        return End::kStopped;
      if (requests_.rig_claimed.load())
        return End::kRigClaimed;
      if (runtime::monotonic_ns() > give_up)
        return End::kPeersLate;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return End::kNone;
  }

  const Options& options_;
  const scene::Scene& scene_;
  const std::uint64_t session_;
  runtime::NodeHost host_;
  /// Declared first, so that the driver closes first: a blocked disk must not keep it open.
  std::unique_ptr<Faults> faults_;
  LedDriver* led_ = nullptr;  ///< the driver, if a page leads the simulated operator
  std::unique_ptr<devices::Driver> driver_;
  const DeviceDescription description_;  ///< that the ring is designed for
  bus::Writer<msg::DeviceState> states_;
  bus::Writer<msg::DeviceDescription> descriptions_;
  bus::FollowedReader<msg::ForceCommand> commands_;
  Progress progress_;
  Requests requests_;
  std::optional<DeviceMonitor> monitor_;
};

/// Checks a duration as typed [s]: 0 to 1e8 (three years), because samples are counted as integers.
/// Returns the fault, or an empty text.
std::string check_duration(const std::string& text) {
  const double seconds = parse_finite(text).value_or(-1.0);
  if (seconds == 0.0 || (seconds >= 1e-6 && seconds <= 1e8))
    return {};
  return "'" + text.substr(0, 64) + "' is not a duration: 0 (unlimited), or 1e-6 to 1e8 seconds";
}

}  // namespace

void add_device_options(CLI::App& app, Options& options) {
  app.add_option(
         "--device", options.device,
         fmt::format("{}; sim:FILE simulates a device file, or sim: and a shipped one: {}",
                     fmt::join(devices::device_names(), ", "), fmt::join(shipped_devices(), ", ")))
      ->capture_default_str();
  app.add_option("--device-option", options.settings,
                 "KEY=VALUE of this device (see deploy/devices/*.md); repeatable")
      ->allow_extra_args(false);
  app.add_option(
         "--device-file", options.device_file,
         "Measured figures of this device, written by `voxtouch identify --out FILE`. The\n"
         "coupling is designed for them. A check in the first second with force compares delay,\n"
         "encoder step and mass with the device. It cannot separate a heavier tool from a hand")
      ->check(CLI::ExistingFile);
  faults::add_option(app, options.fault_records);
  app.add_option("--network-delay", options.network_delay_ms,
                 "Round-trip network delay between device and coupling [ms]. The coupling is "
                 "designed for it, with less\n"
                 "stiffness. Default 0: one host, or a switch")
      ->check(CLI::Range(0.0, 100.0));
  app.add_option("--motion", options.motion,
                 "Motion of the simulated hand: one of the scene's (hit, slide, circle, free)");
  app.add_option("--duration", options.duration_s, "Duration in device time [s]; 0: until stopped")
      ->capture_default_str()
      ->check(check_duration);
  add_hand_options(app, options.hand);
}

Motion choose_motion(const scene::Scene& scene, const std::string& name) {
  if (scene.motions.empty() && !name.empty())
    throw std::runtime_error(fmt::format(
        "{}: the scene has no motion '{}'. Add it under `motions:`", scene.file.string(), name));
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
  throw std::runtime_error(fmt::format("{}: unknown motion '{}'. Motions of this scene: {}",
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
