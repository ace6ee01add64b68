#pragma once
/// Only one `voxtouch up` runs in a rig. Its RigClaim announces this and lists the participants of
/// its nodes.
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
  /// Claims the rig. The claim is announced before the search for others, so two that start at once
  /// find each other: the smaller GUID continues. A participant alone in the domain need not wait:
  /// a later one finds its claim. Throws std::runtime_error if the rig is in use.
  void take();
  /// Only these play a role in this ring. Written on a change.
  void name(const Players& players);

 private:
  void write(std::uint32_t state, const Players& players);
  void listen();

  const runtime::NodeOptions& options_;
  const std::vector<int> inherited_;  ///< UDP sockets opened before this process joined DDS
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
