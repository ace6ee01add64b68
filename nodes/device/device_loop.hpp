#pragma once
/// The loop of the device node, one cycle per sample: read, publish, wait for the command, guard,
/// write. Real-time safe after construction.
/// A simulated device is paced here, at absolute deadlines. A real device is paced by its own
/// clock, in `read`, and receives its command as soon as it arrives.
/// Bound of each inner loop:
///   `run`: each cycle checks `stop`.
///   `read`: ten periods.
///   `take_commands`: kMaxTakes commands; in real time the history holds one.
///   `wait_in_real_time`: the sample's period.
///   `wait_in_lockstep`: peer_timeout, in steps of 50 ms that check `stop`.
#include <array>
#include <atomic>

#include "core/identification/start_check.hpp"
#include "devices/command_gate.hpp"
#include "devices/driver.hpp"
#include "devices/force_guard.hpp"
#include "nodes/bus/followed_reader.hpp"
#include "nodes/bus/wait_set.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/device/force_loss.hpp"
#include "nodes/faults/fault_latch.hpp"
#include "nodes/faults/fault_recorder.hpp"
#include "nodes/runtime/counters.hpp"
#include "nodes/runtime/heartbeat.hpp"
#include "nodes/runtime/latency.hpp"

namespace voxtouch::device_node {

/// Reason for the end of the loop.
enum class End : std::uint32_t {
  kNone,
  kStopped,
  kFinished,
  kPeersLate,  ///< at the start, without any sample
  kPeerSilent,
  kPeerGone,
  kDeviceGone,
  kDeviceFault,
  kWriteBlocked,
  kRigClaimed
};

enum class DeviceCounter : std::uint8_t {
  kSamples,
  kOverruns,
  kRefused,
  kRefusedLate,
  kClamped,
  kSlewed,
  kFaded,
  kInterruptions,
  kZeroForce,
  kLatchedPoses,
  kDeadlineMisses,
  kMaxForce,
  kForce,
  kRecentForce,
  kFirstAnswered,
  kLongestGap,
  kForceLosses,
  kForceLost,
  kLongestLoss
};
inline constexpr auto kDeviceTable = [] {
  using enum DeviceCounter;
  using enum runtime::Counting;
  return std::to_array<runtime::CounterRow<DeviceCounter>>({
      {kSamples, "samples", "samples"},
      {kOverruns, "overruns", "periods"},
      {kRefused, "refused", "commands", kLast},
      {kRefusedLate, "refused_late", "commands", kLast},
      {kClamped, "clamped", "commands", kLast},
      {kSlewed, "slewed", "samples", kLast},
      {kFaded, "faded", "fades", kLast},
      // Ends of the force of a device that had accepted it: by its failure, a stall of the process
      // or a latched fault. Waiting until the device is ready does not count.
      {kInterruptions, "interruptions", "times"},
      // Samples with zero force for one of these reasons, or while waiting.
      {kZeroForce, "zero_force_samples", "samples"},
      {kLatchedPoses, "latched_poses", "samples"},
      {kDeadlineMisses, "deadline_misses", "deadlines", kLast},  // at the end
      {kMaxForce, "max_force_n", "N", kMaximum},
      {kForce, "force_n", "N", kLast},
      {kRecentForce, "", "N", kMaximum},  // since the monitor last took it
      {kFirstAnswered, "first_answered", "sample number", kFirst},
      {kLongestGap, "longest_gap_ms", "ms", kMaximum},  // gaps that ended the force
      {kForceLosses, "force_losses", "times", kLast},
      {kForceLost, "force_lost_s", "s", kLast},
      {kLongestLoss, "longest_force_loss_s", "s", kLast},
  });
}();

/// State that other threads may read while the loop runs.
struct Progress {
  runtime::Counters<kDeviceTable> counters;
  std::atomic<devices::DeviceError> last_error{
      devices::DeviceError::kTimeout};  ///< of the device's last failure
  std::atomic<bool> has_error{
      false};  ///< the last read or write failed, so the device is at zero force
  runtime::Heartbeat heartbeat;
  std::atomic<std::int64_t> started_ns{0}, ended_ns{0};  ///< monotonic clock
  std::atomic<End> end{End::kNone};
  runtime::LatencyHistogram latency;
  faults::FaultLatch latch;
  /// Of a device with a measured file; the loop's until `start_checked`, then the monitor's.
  identification::StartCheck start_check;
  std::atomic<bool> start_checked{false};
};

/// One sample, for the record of a fault.
struct SampleSeen {
  msg::DeviceState state;
  msg::ForceCommand command;  ///< the command received for it, if `answered`
  msg::ForceCommand given;    ///< written to the device
  bool answered = false;
};
using Faults = faults::FaultRecorder<SampleSeen>;
/// Writes the topics of the ring and `device/given` to `folder`; writes nothing if it is empty.
std::unique_ptr<Faults> make_faults(const std::filesystem::path& folder, const std::string& rig,
                                    double rate_hz);

/// Requests of other threads.
struct Requests {
  std::atomic<bool> peer_gone{false};    ///< a node that the session needs has left
  std::atomic<bool> rig_claimed{false};  ///< another device keeps this rig
  std::atomic<bool> coupling_fault{
      false};  ///< the coupling has recorded a fault, so this node records too
};

/// Detects that this process was suspended for longer than `limit_ns`. Uses the clock of the host:
/// that of a simulated device stops with the process. Real-time safe.
class GapWatch {
 public:
  explicit GapWatch(std::int64_t limit_ns) noexcept : limit_ns_(limit_ns) {}
  /// Time since the last call [ns]; 0 within the limit.
  std::int64_t gap_ns(std::int64_t now_ns) noexcept {
    const std::int64_t gap_ns = last_ns_ ? now_ns - last_ns_ : 0;
    last_ns_ = now_ns;
    return gap_ns > limit_ns_ ? gap_ns : 0;
  }
  /// The next call measures no gap.
  void restart() noexcept { last_ns_ = 0; }

 private:
  std::int64_t last_ns_ = 0, limit_ns_;
};

class DeviceLoop {
 public:
  struct Settings {
    std::uint64_t session_id = 0;
    bool lockstep = false;
    std::int64_t epoch_ns = 0;  ///< Added to the driver's clock: stamps are absolute in real time
                                ///< and start at 0 in lockstep.
    std::uint64_t max_samples = 0;  ///< 0: no end
    std::int64_t peer_timeout_ns = 5'000'000'000;
  };
  DeviceLoop(const Settings& settings, devices::Driver& driver,
             bus::Writer<msg::DeviceState>& states,
             bus::FollowedReader<msg::ForceCommand>& commands, bus::WaitSet& wait_set,
             Progress& progress, Requests& requests, Faults& faults);

  /// Runs until the loop ends; leaves the driver stopped.
  End run(const std::atomic<bool>& stop) noexcept;

 private:
  End end_request(const std::atomic<bool>& stop) const noexcept;
  End cycle(const std::atomic<bool>& stop) noexcept;
  /// Writes the command through the guard to the device, at the device's time of `sample`.
  End write_command(std::optional<devices::GuardInput> command,
                    const devices::DeviceSample& sample) noexcept;
  /// Force of the check at start, to be added to the command [N].
  Vec3 next_tones(const devices::DeviceSample& sample) noexcept;
  void note_tones(const Vec3& given_n) noexcept;
  End on_device_error(devices::DeviceError error) noexcept;
  void stop_force() noexcept;
  bool has_stalled() noexcept;
  void note_loss() noexcept;
  std::uint64_t next_period() noexcept;
  void note_overruns(std::uint64_t periods) noexcept;
  void count_skipped(std::int64_t sample_ns) noexcept;
  bool publish(const devices::DeviceSample& sample, const std::atomic<bool>& stop) noexcept;
  std::optional<devices::GuardInput> wait_in_lockstep(const std::atomic<bool>& stop,
                                                      End& end) noexcept;
  std::optional<devices::GuardInput> wait_in_real_time() noexcept;
  std::optional<devices::GuardInput> take_commands() noexcept;
  void note(const Wrench& force) noexcept;
  void latch_if_clipped(bool clipped) noexcept;
  void record(const Wrench& given, const devices::GuardCounts& before) noexcept;

  Settings settings_;
  devices::Driver& driver_;
  bus::Writer<msg::DeviceState>& states_;
  bus::FollowedReader<msg::ForceCommand>& commands_;
  bus::WaitSet& wait_set_;
  Progress& progress_;
  Requests& requests_;
  Faults& faults_;
  SampleSeen seen_{};  // of this cycle
  devices::ForceGuard guard_;
  devices::CommandGate gate_;
  ForceLoss loss_;
  std::int64_t period_ns_, deadline_ns_ = 0;
  std::uint64_t sequence_ = 0;
  std::int64_t last_sample_ns_ = 0;  // by the device's clock
  std::array<std::int64_t, 256> published_ns_{};
  Pose last_pose_;
  bool accepts_force_ = false;    // the last write was accepted
  double clipped_samples_ = 0.0;  // decaying count, over about one second, of samples whose command
                                  // the guard clipped
  GapWatch gaps_;                 // longer than a command is held and faded
};

}  // namespace voxtouch::device_node
