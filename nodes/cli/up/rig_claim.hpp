#pragma once
/// One `voxtouch up` has a rig: its RigClaim says so, and names the participants of the nodes that
/// it started.
#include <map>
#include <set>
#include <string>
#include <vector>

#include "nodes/bus/reader.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/options.hpp"

namespace voxtouch::cli {

using Players = std::map<std::string, std::set<bus::Guid>>;  ///< participants by role

class RigClaim {
 public:
  /// Joins the domain. `options` must outlive it.
  explicit RigClaim(const runtime::NodeOptions& options);

  const bus::Participant& participant() const noexcept { return participant_; }
  /// Others see from now on that this ring is about to start. The time up to `take` counts as time
  /// in which they could answer.
  void announce();
  /// Holds the rig. It is announced before others are looked for, so of two that start at once each
  /// sees the other: the smaller GUID goes on. One that was alone in the domain need not wait:
  /// whoever came later sees it. Throws std::runtime_error if the rig is in use.
  void take();
  /// Only these play a role in this ring. Written on a change.
  void name(const Players& players);

 private:
  void write(std::uint32_t state, const Players& players);
  void listen();

  const runtime::NodeOptions& options_;
  const std::vector<int> inherited_;  ///< UDP sockets from before this process took part in DDS
  bus::Participant participant_;
  const bool came_first_;  ///< no other participant of this machine in the domain, and no other
                           ///< machine can be received
  runtime::StatusWriter status_;
  bus::Writer<msg::RigClaim> claims_;
  bus::Reader<msg::RigClaim> others_;
  std::string conflict_;  ///< another `up` that has the rig
  Players players_;
  std::int64_t announced_ns_ = 0;
};

}  // namespace voxtouch::cli
