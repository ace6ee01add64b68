#pragma once
/// Status of the device node, and the state of other nodes that its loop needs.
#include <optional>

#include "nodes/device/device_loop.hpp"
#include "nodes/device/last_second.hpp"
#include "nodes/device/lockstep_peers.hpp"
#include "nodes/device/rig_claim.hpp"
#include "nodes/runtime/role_binding.hpp"

namespace voxtouch::device_node {

/// Texts on late commands and the network delay, from the last second.
class LateCommands {
 public:
  /// `designed_ms`: network delay that the coupling is designed for.
  LateCommands(double designed_ms, bool lockstep)
      : designed_ms_(designed_ms),
        lockstep_(lockstep) {}
  void poll(const Progress& progress, double rate_hz);
  /// Why no force is displayed, if more than half of a second's commands were late; else empty.
  const std::string& reason() const noexcept { return reason_; }
  /// The measured delay, if the coupling is designed for one; begins with "; ".
  const std::string& network() const noexcept { return network_; }

 private:
  const double designed_ms_;
  const bool lockstep_;
  double samples_ = 0.0, late_ = 0.0;  ///< at the last poll
  double met_ms_ = 0.0;                ///< value in `network_`
  std::string reason_, network_;
};

/// Used by the monitor thread, except `peers().ready`, and `sentence` once that thread has ended.
class DeviceMonitor {
 public:
  DeviceMonitor(runtime::NodeHost& host, const devices::Driver& driver,
                const bus::FollowedReader<msg::ForceCommand>& commands, Progress& progress,
                Requests& requests, const Faults& faults, double network_delay_ms);
  const LockstepPeers& peers() const noexcept { return peers_; }

  void report_to(std::uint64_t session, runtime::NodeRegistry& registry,
                 runtime::NodeReport& report, runtime::StatusText& status);
  /// Why the loop ended, as a sentence.
  std::string sentence(End end) const;

 private:
  void watch(std::uint64_t session, runtime::NodeRegistry& registry);
  void note_error(End end);
  std::string find_late_peer(const runtime::NodeRegistry& registry) const;
  void fill(runtime::NodeReport& report);
  void judge_start(runtime::NodeReport& report, runtime::StatusText& status);

  runtime::NodeHost& host_;
  const devices::Driver& driver_;
  const bus::FollowedReader<msg::ForceCommand>& commands_;
  Progress& progress_;
  Requests& requests_;
  const Faults& faults_;
  runtime::RoleBinding coupling_;
  faults::ReportedFaults coupling_faults_;
  faults::ResetReceiver reset_receiver_;
  LockstepPeers peers_;
  RigClaim rig_;
  LateCommands late_;
  LastSecond last_second_;
  std::string late_peer_;   ///< lockstep: the node that the device waits for, and why
  std::string diagnostic_;  ///< last reason why the device displayed no force
  double reported_gap_ms_ = 0.0;
  std::optional<identification::StartFindings> start_;  ///< of the check at start, once it is over
};

}  // namespace voxtouch::device_node
