#pragma once
/// One cycle a sample: read, publish, wait for the command, guard, write. Real-time safe after
/// construction. A simulated device is paced here, at absolute deadlines; a real one paces by its
/// own clock, in `read`, and gets its command as soon as it is there. Commands are those of the one
/// writer that the reader follows; the housekeeping decides whose it is, and the reader itself
/// where that one has a standby, which takes over when it has left out samples.
///
/// What bounds each loop. `run`: it is the session, each cycle looks at `stop`. `read`: ten
/// periods. `take_commands`: kMaxTakes commands, of which the history in real time holds one.
/// `wait_in_real_time`: the sample's own period. `wait_in_lockstep`: peer_timeout, in steps of 50
/// ms that look at `stop`. No lock is taken.
#include <array>
#include <atomic>

#include "devices/command_gate.hpp"
#include "devices/driver.hpp"
#include "devices/force_guard.hpp"
#include "nodes/bus/wait_set.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/faults/fault_recorder.hpp"
#include "nodes/faults/force_lock.hpp"
#include "nodes/runtime/heartbeat.hpp"
#include "nodes/runtime/latency.hpp"
#include "nodes/runtime/pair_reader.hpp"

namespace voxtouch::device_node {

/// Why the loop ended.
enum class End : std::uint32_t {
  kNone,
  kStopped,
  kFinished,
  kPeerSilent,
  kPeerGone,
  kDeviceGone,
  kDeviceFault,
  kWriteBlocked,
  kRigClaimed
};

/// What other threads may read while the loop runs.
struct Progress {
  std::atomic<std::uint64_t> samples{0}, overruns{0}, refused{0}, refused_late{0}, clamped{0},
      faded{0};
  /// Times that a device which had taken force gave no samples or took none any more, without
  /// ending the session. However long it lasts it is one; waiting at the start, until the device is
  /// ready, is none.
  std::atomic<std::uint64_t> interruptions{0};
  std::atomic<std::uint64_t> zero_force_samples{
      0};  ///< reads and writes that failed, of interruptions and of waiting: zero force each
  std::atomic<devices::DeviceError> last_error{
      devices::DeviceError::kTimeout};  ///< means something where zero_force_samples is not 0
  std::atomic<std::uint64_t> untrusted_poses{0};  ///< samples whose pose was not to be trusted
  std::atomic<bool> in_trouble{
      false};  ///< the last read or write failed: the device is at zero force
  std::atomic<std::uint64_t> deadline_misses{
      0};  ///< set at the end: a reader goes on counting once nobody writes any more
  std::atomic<double> max_force_n{0.0}, force_n{0.0};
  std::atomic<double> recent_max_force_n{0.0};  ///< since whoever shows it last took it out
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  std::atomic<std::uint64_t> first_answered{
      kNone};  ///< number of the first sample that was answered
  std::atomic<std::int64_t> longest_gap_ns{
      0};  ///< between two cycles, of those that let the force go
  runtime::Heartbeat heartbeat;
  std::atomic<std::int64_t> started_ns{0}, ended_ns{0};  ///< monotonic
  std::atomic<End> end{End::kNone};
  runtime::LatencyHistogram latency;
  faults::ForceLock lock;
};

/// What the loop saw and did in one sample, for the record of a fault.
struct SampleSeen {
  msg::DeviceState state;
  msg::ForceCommand command;  ///< the one that came for it, if `answered`
  msg::ForceCommand given;    ///< with the wrench that the device was given
  bool answered = false;
};
using Faults = faults::FaultRecorder<SampleSeen>;
/// Writes to FOLDER (none: records nothing); the topics are those of the ring, and `device/given`
/// beside them.
std::unique_ptr<Faults> make_faults(const std::filesystem::path& folder, const std::string& rig,
                                    double rate_hz);

/// Asked by other threads of the loop.
struct Requests {
  std::atomic<bool> peer_gone{false};    ///< lockstep: a node that takes part has gone
  std::atomic<bool> rig_claimed{false};  ///< another device of this rig was there first
  std::atomic<bool> coupling_fault{
      false};  ///< the coupling has kept what it saw: so does this node
};

class DeviceLoop {
 public:
  struct Settings {
    std::uint64_t session_id = 0;
    bool lockstep = false;
    std::int64_t epoch_ns =
        0;  ///< added to the driver's clock: stamps are absolute in real time, from 0 in lockstep
    std::uint64_t max_samples = 0;  ///< 0: no end
    std::int64_t peer_timeout_ns = 5'000'000'000;
  };
  DeviceLoop(const Settings& settings, devices::Driver& driver,
             bus::Writer<msg::DeviceState>& states,
             runtime::PairReader<msg::ForceCommand>& commands, bus::WaitSet& wait_set,
             Progress& progress, Requests& requests, Faults& faults);

  /// Runs to the end; leaves the driver stopped.
  End run(const std::atomic<bool>& stop) noexcept;

 private:
  End asked_to_end(const std::atomic<bool>& stop) const noexcept;
  End cycle(const std::atomic<bool>& stop) noexcept;
  /// Through the guard to the device, at the device's time `sample_ns`.
  End give(const std::optional<devices::GuardInput>& command, std::int64_t sample_ns) noexcept;
  End on_device_error(devices::DeviceError error) noexcept;
  void let_go() noexcept;
  bool stood_still() noexcept;
  void next_period() noexcept;
  void count_skipped(std::int64_t sample_ns) noexcept;
  bool publish(const devices::DeviceSample& sample, const std::atomic<bool>& stop) noexcept;
  std::optional<devices::GuardInput> wait_in_lockstep(const std::atomic<bool>& stop,
                                                      End& end) noexcept;
  std::optional<devices::GuardInput> wait_in_real_time() noexcept;
  std::optional<devices::GuardInput> take_commands() noexcept;
  void note(const Wrench& force) noexcept;
  void lock_where_cut(bool cut) noexcept;
  void record(const Wrench& given, const devices::GuardCounts& before) noexcept;

  Settings settings_;
  devices::Driver& driver_;
  bus::Writer<msg::DeviceState>& states_;
  runtime::PairReader<msg::ForceCommand>& commands_;
  bus::WaitSet& wait_set_;
  Progress& progress_;
  Requests& requests_;
  Faults& faults_;
  SampleSeen seen_{};  // of this cycle
  devices::ForceGuard guard_;
  devices::CommandGate gate_;
  std::int64_t period_ns_, deadline_ns_ = 0;
  std::uint64_t sequence_ = 0;
  std::int64_t last_sample_ns_ = 0;  // the device's clock
  std::array<std::int64_t, 256> published_ns_{};
  Pose last_pose_;
  bool accepts_force_ = false;  // the last write was accepted
  double cut_samples_ = 0.0;    // of about the last second, in which the guard cut a command
  std::int64_t last_cycle_ns_ = 0, longest_gap_ns_;
};

}  // namespace voxtouch::device_node
