#include "nodes/cli/up/rig_claim.hpp"

#include <string.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include "nodes/bus/network.hpp"
#include "nodes/cli/up/command_line.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::cli {
namespace {

bool is_alone(const runtime::NodeOptions& node, const std::vector<int>& inherited) {
  std::vector<int> own = bus::udp_sockets();
  std::erase_if(
      own, [&](int socket) { return std::ranges::find(inherited, socket) != inherited.end(); });
  const char* const uri = std::getenv("CYCLONEDDS_URI");
  return bus::is_alone_in_domain(node.domain, node.network_interface, node.discovery_peers,
                                 uri ? uri : "", own);
}

std::string process_on(const std::string& node, std::uint32_t pid, const std::string& host) {
  return fmt::format("its {} node is process {} on {}", node, pid, host);
}

}  // namespace

RigClaim::RigClaim(const runtime::NodeOptions& options)
    : options_(options),
      inherited_(bus::udp_sockets()),
      participant_(options.participant("up")),
      came_first_(is_alone(options, inherited_)),
      status_(participant_, "up", options.rig),
      claims_(participant_, qos::kRigClaim, options.rig, qos::profile(qos::ProfileId::kStatus)),
      others_(participant_, qos::kRigClaim, options.rig, qos::profile(qos::ProfileId::kStatus)) {}

void RigClaim::announce() {
  write(msg::rig_claim::kStateAnnounced, {});
  runtime::NodeReport report;
  report.state = runtime::NodeState::kStarting;
  report.message = "this ring's `voxtouch up`";
  std::error_code ignored;
  report.values = command_words(own_words(), std::filesystem::current_path(ignored).string());
  status_.publish(report);
  announced_ns_ = runtime::monotonic_ns();
}

void RigClaim::take() {
  runtime::NodeRegistry registry(participant_, options_.rig);
  // The rest of half a second since the announcement, and at least two polls, for claims received
  // meanwhile.
  const std::int64_t left_ms = 500 - (runtime::monotonic_ns() - announced_ns_) / 1'000'000;
  const std::int64_t patience_ms = came_first_ ? 0 : std::max<std::int64_t>(left_ms, 50);
  (void)runtime::look_for(
      registry,
      [this](const runtime::NodeReport& other) {
        listen();
        if (other.node != "up" && !other.final())
          conflict_ = process_on(other.node, other.pid, other.host);
        return !conflict_.empty();
      },
      std::chrono::milliseconds(patience_ms));
  listen();
  if (!conflict_.empty())
    throw std::runtime_error(fmt::format(
        "Rig '{}' is in use on domain {}: {}. Stop that ring, or choose another --rig or --domain",
        options_.rig, options_.domain, conflict_));
  write(msg::rig_claim::kStateActive, {});
}

/// Another `up` that holds the rig, or that is about to and has the smaller GUID.
void RigClaim::listen() {
  others_.take_each([this](const msg::RigClaim& claim, dds_instance_handle_t writer) {
    bus::Guid other{};
    std::memcpy(other.data(), claim.participant, other.size());
    constexpr std::size_t kMaxHost = 256;
    const bool is_own = bus::participant_of_writer(others_.get(), writer) == other && claim.host &&
                        ::strnlen(claim.host, kMaxHost) < kMaxHost;
    if (!is_own || other == participant_.guid())
      return;
    if (claim.state == msg::rig_claim::kStateActive || other < participant_.guid())
      conflict_ = process_on("up", claim.pid, claim.host);
  });
}

void RigClaim::name(const Players& players) {
  if (players != players_)
    write(msg::rig_claim::kStateActive, players);
}

void RigClaim::write(std::uint32_t state, const Players& players) {
  char host[256] = {};
  ::gethostname(host, sizeof host - 1);
  std::vector<msg::RigRole> roles;
  for (const auto& [node, participants] : players)
    for (const bus::Guid& participant : participants) {
      msg::RigRole& role = roles.emplace_back();
      role.node = runtime::lend(node);
      std::memcpy(role.participant, participant.data(), participant.size());
    }
  msg::RigClaim claim{};
  claim.host = host;
  claim.pid = static_cast<std::uint32_t>(::getpid());
  std::memcpy(claim.participant, participant_.guid().data(), participant_.guid().size());
  claim.state = state;
  claim.roles._buffer = roles.data();
  claim.roles._length = claim.roles._maximum = static_cast<std::uint32_t>(roles.size());
  claims_.write(claim);
  players_ = players;
}

}  // namespace voxtouch::cli
