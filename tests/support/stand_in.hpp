#pragma once
/// Replaces a node of the ring: a participant with a status, which the others accept as that node.
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "nodes/runtime/node_registry.hpp"

namespace voxtouch::test {

struct StandIn {
  StandIn(std::uint32_t domain, const std::string& role, const std::string& rig)
      : participant({domain, "lo", role}),
        status(participant, role, rig) {}
  void say(std::uint64_t session, runtime::NodeState state = runtime::NodeState::kRunning,
           const runtime::Figures& figures = {}) {
    runtime::NodeReport report;
    report.session_id = session, report.state = state, report.figures = figures;
    status.publish(report);
  }
  bus::Participant participant;
  runtime::StatusWriter status;
};

/// A `voxtouch up` as far as its nodes see it.
struct StandInUp {
  StandInUp(std::uint32_t domain, const std::string& rig)
      : participant({domain, "lo", "up"}),
        claims(participant, qos::kRigClaim, rig, qos::profile(qos::ProfileId::kStatus)) {}
  void name(const std::vector<std::pair<std::string, bus::Guid>>& players) {
    std::vector<std::pair<std::string, bus::Guid>> kept = players;
    std::vector<msg::RigRole> roles;
    for (auto& [node, guid] : kept) {
      msg::RigRole& role = roles.emplace_back();
      role.node = node.data();
      std::memcpy(role.participant, guid.data(), guid.size());
    }
    char host[] = "host";
    msg::RigClaim claim{};
    claim.host = host, claim.state = msg::rig_claim::kStateActive;
    std::memcpy(claim.participant, participant.guid().data(), participant.guid().size());
    claim.roles._buffer = roles.data();
    claim.roles._length = claim.roles._maximum = static_cast<std::uint32_t>(roles.size());
    claims.write(claim);
  }
  bus::Participant participant;
  bus::Writer<msg::RigClaim> claims;
};

/// A small simulated stylus; its strings have static lifetime.
inline msg::DeviceDescription stylus(std::uint64_t session) {
  static char model[] = "stylus", grip[] = "pen";
  msg::DeviceDescription m{};
  m.session_id = session;
  m.model = model, m.grip = grip;
  m.rate_hz = 1000.0;
  m.max_force_n = 8.5, m.max_force_rate_n_per_s = 1e4;
  m.max_stiffness_n_per_m = 800.0;
  m.mass_min_kg = 0.05, m.mass_max_kg = 0.1;
  m.damping_ns_per_m = 2.0;
  m.position_resolution_m = 3e-5;
  m.delay_s = 1e-3;
  m.force_bandwidth_hz = 1e9;
  m.jitter = 0.2, m.consecutive_losses = 1;
  m.simulated = true;
  return m;
}

}  // namespace voxtouch::test
