#include "nodes/device/device_loop.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/realtime.hpp"

namespace voxtouch::device_node {
namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;
constexpr std::int64_t kPollNs = 50'000'000;

const char* reason_of(devices::DeviceError error) noexcept {
  switch (error) {
    case devices::DeviceError::kTimeout:
      return "the device sent no sample in time";
    case devices::DeviceError::kDisconnected:
      return "the device disconnected";
    case devices::DeviceError::kNotFinite:
    case devices::DeviceError::kLimit:
      return "the driver refused a command";
    case devices::DeviceError::kProtocol:
      return "the device violated its protocol";
    case devices::DeviceError::kRecoverable:
      return "the device dropped its force";
    case devices::DeviceError::kFault:
      return "the device stopped with a fault";
  }
  return "the device failed";
}

}  // namespace

DeviceLoop::DeviceLoop(const Settings& settings, devices::Driver& driver,
                       bus::Writer<msg::DeviceState>& states,
                       bus::FollowedReader<msg::ForceCommand>& commands, bus::WaitSet& wait_set,
                       Progress& progress, Requests& requests, Faults& faults)
    : settings_(settings),
      driver_(driver),
      states_(states),
      commands_(commands),
      wait_set_(wait_set),
      progress_(progress),
      requests_(requests),
      faults_(faults),
      guard_(devices::guard_config(driver.description())),
      gate_(settings.session_id),
      period_ns_(std::llround(1e9 / driver.description().rate_hz)),
      gaps_(std::llround(1e9 * (guard_.config().hold_periods * guard_.config().period_s +
                                guard_.config().fade_s))) {}

End DeviceLoop::run(const std::atomic<bool>& stop) noexcept {
  runtime::flush_denormals();
  auto& counters = progress_.counters;
  deadline_ns_ = runtime::monotonic_ns();
  progress_.started_ns.store(deadline_ns_, kRelaxed);
  End end = End::kNone;
  while (end == End::kNone)
    end = cycle(stop);
  guard_.stop();
  driver_.stop();
  counters.note(DeviceCounter::kDeadlineMisses, static_cast<double>(commands_.deadlines_missed()));
  counters.note(DeviceCounter::kForce, 0.0);
  progress_.ended_ns.store(runtime::monotonic_ns(), kRelaxed);
  progress_.end.store(end, std::memory_order_release);
  return end;
}

End DeviceLoop::end_request(const std::atomic<bool>& stop) const noexcept {
  if (stop.load(kRelaxed))
    return End::kStopped;
  if (settings_.max_samples && sequence_ == settings_.max_samples)
    return End::kFinished;
  if (requests_.rig_claimed.load(kRelaxed))
    return End::kRigClaimed;
  if (requests_.peer_gone.load(kRelaxed))
    return End::kPeerGone;
  return End::kNone;
}

End DeviceLoop::cycle(const std::atomic<bool>& stop) noexcept {
  progress_.heartbeat.beat();
  note_loss();
  if (const End requested = end_request(stop); requested != End::kNone)
    return requested;

  const auto sample = driver_.read(std::chrono::microseconds(10 * period_ns_ / 1000));
  if (!sample) {
    note_overruns(next_period());
    runtime::sleep_until(deadline_ns_);  // keeps the loop from spinning if the device fails
                                         // immediately
    return on_device_error(sample.error());
  }
  if (!driver_.simulated()) {
    count_skipped(sample->time_ns);
    deadline_ns_ =
        runtime::monotonic_ns() - period_ns_ / 4;  // the command is due 3/4 of a period after the
                                                   // read, ahead of the device's next sample
  }
  if (!publish(*sample, stop))
    return stop.load(kRelaxed)                  ? End::kStopped
           : requests_.peer_gone.load(kRelaxed) ? End::kPeerGone
                                                : End::kWriteBlocked;

  End end = End::kNone;
  const auto command = settings_.lockstep ? wait_in_lockstep(stop, end) : wait_in_real_time();
  if (end != End::kNone)
    return end;

  ++sequence_;
  progress_.counters.note(DeviceCounter::kSamples);
  if (has_stalled()) {
    faults_.keep("a stall of the device process");
    stop_force();
    return End::kNone;
  }
  if (progress_.latch.take_reset())
    guard_.restart();
  if (progress_.latch.latched()) {
    stop_force();
    return End::kNone;
  }
  return write_command(command, *sample);
}

End DeviceLoop::write_command(std::optional<devices::GuardInput> command,
                              const devices::DeviceSample& sample) noexcept {
  const devices::GuardCounts before = guard_.counts();
  const Vec3 tones = next_tones(sample);
  if (command && command->wrench.finite())
    command->wrench.force += tones;
  const Wrench force = guard_.pass(command, sample.time_ns + settings_.epoch_ns);
  note_tones(force.force);
  record(force, before);
  const auto written = driver_.write(force);
  note(written ? force : Wrench{});
  progress_.has_error.store(!written, kRelaxed);
  if (written)
    accepts_force_ = true;
  return written ? End::kNone : on_device_error(written.error());
}

Vec3 DeviceLoop::next_tones(const devices::DeviceSample& sample) noexcept {
  identification::StartCheck& check = progress_.start_check;
  if (!check.started() || check.finished())
    return Vec3::Zero();
  if (!sample.pose_valid) {
    check.restart();
    return Vec3::Zero();
  }
  const Vec3 tones = check.force(1e-9 * static_cast<double>(sample.time_ns), sample.pose.position);
  if (check.finished())
    progress_.start_checked.store(true, std::memory_order_release);
  return tones;
}

/// Passes the force of the device [N] to the start check, which restarts if the guard gives none.
void DeviceLoop::note_tones(const Vec3& given_n) noexcept {
  identification::StartCheck& check = progress_.start_check;
  if (guard_.fraction() > 0.0)
    check.applied(given_n);
  else
    check.restart();
}

/// Ends the loop if the device has disconnected or requires the operator. After any other error the
/// force is zero and then ramps in again.
End DeviceLoop::on_device_error(devices::DeviceError error) noexcept {
  progress_.last_error.store(error, kRelaxed);
  if (accepts_force_)
    faults_.keep(reason_of(error));
  if (error == devices::DeviceError::kDisconnected)
    return End::kDeviceGone;
  if (error == devices::DeviceError::kFault)
    return End::kDeviceFault;
  // The guard passes no such command, so guard or driver is faulty.
  if (error == devices::DeviceError::kNotFinite || error == devices::DeviceError::kLimit)
    progress_.latch.latch("the driver refused a command that the force guard accepted");
  stop_force();
  progress_.has_error.store(true, kRelaxed);
  gaps_.restart();  // at zero force a gap is harmless
  return End::kNone;
}

void DeviceLoop::stop_force() noexcept {
  driver_.stop();
  guard_.restart();
  progress_.start_check.restart();
  progress_.counters.note(DeviceCounter::kForce, 0.0);
  progress_.counters.note(DeviceCounter::kZeroForce);
  if (std::exchange(accepts_force_, false))
    progress_.counters.note(DeviceCounter::kInterruptions);
}

void DeviceLoop::note_loss() noexcept {
  auto& counters = progress_.counters;
  const std::int64_t now_ns = settings_.lockstep ? static_cast<std::int64_t>(sequence_) * period_ns_
                                                 : runtime::monotonic_ns();
  loss_.note(now_ns, guard_.fraction(), counters[DeviceCounter::kForce]);
  counters.note(DeviceCounter::kForceLosses, static_cast<double>(loss_.count()));
  counters.note(DeviceCounter::kForceLost, static_cast<double>(loss_.total_ns()) * 1e-9);
  counters.note(DeviceCounter::kLongestLoss, static_cast<double>(loss_.longest_ns()) * 1e-9);
}

/// Whether this process was suspended for longer than hold and fade. The caller then stops the
/// force, since the clock of a simulated device stops with the process.
bool DeviceLoop::has_stalled() noexcept {
  if (settings_.lockstep)
    return false;
  const std::int64_t gap_ns = gaps_.gap_ns(runtime::monotonic_ns());
  progress_.counters.note(DeviceCounter::kLongestGap, static_cast<double>(gap_ns) * 1e-6);
  return gap_ns > 0;
}

bool DeviceLoop::publish(const devices::DeviceSample& sample,
                         const std::atomic<bool>& stop) noexcept {
  msg::DeviceState state{};
  state.session_id = settings_.session_id;
  state.sequence_number = sequence_;
  state.sample_time_ns = sample.time_ns + settings_.epoch_ns;
  const bool trusted = sample.pose_valid && sample.pose.finite();
  if (trusted)
    last_pose_ = sample.pose;
  else
    progress_.counters.note(DeviceCounter::kLatchedPoses);
  state.pose = runtime::to_msg(last_pose_);
  state.twist = runtime::to_msg(sample.twist);
  state.buttons = sample.buttons;
  state.flags = (driver_.simulated() ? msg::device_state::kFlagSimulated : 0U) |
                (settings_.lockstep ? msg::device_state::kFlagLockstep : 0U) |
                (progress_.latch.latched() ? msg::device_state::kFlagFaultLatched : 0U) |
                (guard_.fraction() > 0 ? msg::device_state::kFlagForceOn : 0U) |
                (trusted ? 0U : msg::device_state::kFlagPoseLatched);
  seen_.state = state, seen_.answered = false;
  published_ns_[sequence_ % published_ns_.size()] = runtime::monotonic_ns();
  if (!settings_.lockstep)
    return states_.write(state), true;  // best effort: a full socket loses a sample and does not
                                        // end the loop
  return states_.write_until(state, [&] {
    progress_.heartbeat.beat();
    return stop.load(kRelaxed) || requests_.peer_gone.load(kRelaxed);
  });
}

std::optional<devices::GuardInput> DeviceLoop::take_commands() noexcept {
  std::optional<devices::GuardInput> newest;
  msg::ForceCommand command;
  dds_instance_handle_t writer = 0;
  for (int i = 0; i < commands_.kMaxTakes && commands_.take(command, &writer); ++i) {
    // The gate keeps its writer only while the reader follows it.
    if (gate_.writer() && *gate_.writer() != commands_.writer())
      gate_.release_writer();
    const devices::GateVerdict verdict =
        gate_.accept(writer, command.session_id, command.sequence_number, sequence_);
    guard_.count(verdict);
    if (verdict != devices::GateVerdict::kAccepted)
      continue;
    progress_.counters.note(DeviceCounter::kFirstAnswered,
                            static_cast<double>(command.sequence_number));
    if (sequence_ - command.sequence_number < published_ns_.size())
      progress_.latency.record(runtime::monotonic_ns() -
                               published_ns_[command.sequence_number % published_ns_.size()]);
    seen_.command = command, seen_.answered = true;
    newest = devices::GuardInput{runtime::from_msg(command.wrench), command.valid_until_ns};
  }
  return newest;
}

std::optional<devices::GuardInput> DeviceLoop::wait_in_lockstep(const std::atomic<bool>& stop,
                                                                End& end) noexcept {
  const std::int64_t give_up_ns = runtime::monotonic_ns() + settings_.peer_timeout_ns;
  for (;;) {
    wait_set_.wait(kPollNs);
    progress_.heartbeat.beat();
    const auto command = take_commands();
    if (command && gate_.last_sequence() == sequence_)
      return command;
    if (stop.load(kRelaxed))
      end = End::kStopped;
    if (requests_.peer_gone.load(kRelaxed))
      end = End::kPeerGone;
    if (runtime::monotonic_ns() > give_up_ns)
      end = End::kPeerSilent;
    if (end != End::kNone)
      return std::nullopt;
  }
}

std::optional<devices::GuardInput> DeviceLoop::wait_in_real_time() noexcept {
  std::optional<devices::GuardInput> newest;
  const auto skipped = next_period();
  if (driver_.simulated())
    note_overruns(skipped);  // those of a real device are counted by its time stamps
  for (std::int64_t left; (left = deadline_ns_ - runtime::monotonic_ns()) > 0;) {
    if (gate_.last_sequence() == sequence_)
      break;  // the sample is answered
    if (!wait_set_.wait(left))
      break;
    if (const auto command = take_commands())
      newest = command;
  }
  if (driver_.simulated())
    runtime::sleep_until(deadline_ns_);
  return newest;
}

/// Counts samples that were not read, from the time stamps of a real device.
void DeviceLoop::count_skipped(std::int64_t sample_ns) noexcept {
  const std::int64_t last = std::exchange(last_sample_ns_, sample_ns);
  if (sequence_ == 0 || !accepts_force_)
    return;  // a device that does not accept force yet may pause
  const std::int64_t periods = (sample_ns - last + period_ns_ / 2) / period_ns_;
  if (periods > 1)
    note_overruns(static_cast<std::uint64_t>(periods - 1));
}

void DeviceLoop::note_overruns(std::uint64_t periods) noexcept {
  progress_.counters.note(DeviceCounter::kOverruns, static_cast<double>(periods));
}

/// Returns the number of periods that have passed meanwhile.
std::uint64_t DeviceLoop::next_period() noexcept {
  const auto next = runtime::next_deadline(deadline_ns_, runtime::monotonic_ns(), period_ns_);
  deadline_ns_ = next.at_ns;
  return next.skipped;
}

/// Stores this sample, and records a fault if the guard refused, clipped or faded commands. Errors
/// of the device are recorded in `on_device_error`.
void DeviceLoop::record(const Wrench& given, const devices::GuardCounts& before) noexcept {
  seen_.given = msg::ForceCommand{};
  seen_.given.session_id = settings_.session_id;
  seen_.given.sequence_number = seen_.state.sequence_number;
  seen_.given.sample_time_ns = seen_.state.sample_time_ns;
  seen_.given.wrench = runtime::to_msg(given);
  faults_.push(seen_);
  const devices::GuardCounts& now = guard_.counts();
  if (now.refused_not_finite != before.refused_not_finite)
    faults_.keep("a command with NaN or infinity");
  const bool clipped =
      now.clamped_force != before.clamped_force || now.clamped_torque != before.clamped_torque;
  if (clipped)
    faults_.keep("a command above the device's limit");
  latch_if_clipped(clipped);
  if (now.faded != before.faded)
    faults_.keep("a loss of commands, the force faded");
  if (requests_.coupling_fault.exchange(false, kRelaxed))
    faults_.keep_for_reported("a fault reported by the coupling");
}

/// Sets the fault latch if over 10 % of the commands of about one second are clipped: the device
/// then displays its limit instead of the contact force. Single ones are only counted.
void DeviceLoop::latch_if_clipped(bool clipped) noexcept {
  const double second = 1e9 / static_cast<double>(period_ns_);
  clipped_samples_ += (clipped ? 1.0 : 0.0) - clipped_samples_ / second;
  if (clipped_samples_ < 0.1 * second)
    return;
  clipped_samples_ = 0.0;
  progress_.latch.latch("more than 10 % of the commands of a second were above the device's limit");
}

void DeviceLoop::note(const Wrench& force) noexcept {
  using enum DeviceCounter;
  const auto note = [this](DeviceCounter counter, auto value) {
    progress_.counters.note(counter, static_cast<double>(value));
  };
  for (const DeviceCounter counter : {kForce, kRecentForce, kMaxForce})
    note(counter, force.force.norm());
  const devices::GuardCounts& counts = guard_.counts();
  note(kRefused, counts.refused());
  note(kRefusedLate, counts.refused_stale);
  note(kClamped, counts.clamped());
  note(kSlewed, counts.clamped_slew);
  note(kFaded, counts.faded);
}

std::unique_ptr<Faults> make_faults(const std::filesystem::path& folder, const std::string& rig,
                                    double rate_hz) {
  const std::string ns = "/" + rig + "/";
  auto faults = std::make_unique<Faults>(
      folder, faults::FaultContext{"device", rig, {}},
      std::vector{faults::topic_of<msg::DeviceState>(ns + "device/state"),
                  faults::topic_of<msg::ForceCommand>(ns + "coupling/command"),
                  faults::topic_of<msg::ForceCommand>(ns + "device/given")},
      [](const std::vector<SampleSeen>& rows) {
        std::vector<faults::FaultMessage> messages;
        for (const SampleSeen& row : rows) {
          const std::int64_t time_ns = row.state.sample_time_ns;
          messages.push_back(faults::message_of(0, time_ns, row.state));
          if (row.answered)
            messages.push_back(faults::message_of(1, time_ns, row.command));
          messages.push_back(faults::message_of(2, time_ns, row.given));
        }
        return messages;
      });
  faults->reserve(rate_hz);
  return faults;
}

}  // namespace voxtouch::device_node
