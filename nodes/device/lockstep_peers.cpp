#include "nodes/device/lockstep_peers.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace voxtouch::device_node {
namespace {

/// Why the run cannot continue without this peer; empty if it can.
std::string loss_of(const bus::Guid& peer, const runtime::NodeRegistry& registry,
                    const std::vector<runtime::Hung>& all_hung) {
  // the monitor also keeps the report of a departed peer
  const runtime::NodeReport* report = registry.report_of(peer);
  const std::string node = report ? report->node : "a node";
  const auto hung = std::ranges::find(all_hung, peer, &runtime::Hung::participant);
  // After some seconds DDS reports a stalled participant as departed.
  const bool gone = !registry.is_here(peer), silent = hung != all_hung.end();
  if (report && report->state == runtime::NodeState::kFailed)
    return node + " has failed";
  if (silent && (gone || hung->for_s * 1e9 >= runtime::kGivenUpNs))
    return fmt::format("{} is silent for {:.1f} s", node, hung->for_s);
  return gone ? node + " has left" : "";
}

}  // namespace

void LockstepPeers::update(const runtime::NodeHost& host, runtime::NodeRegistry& registry,
                           std::uint64_t session, bool with_coupling) {
  missing_ = ready() ? "" : runtime::missing_links(host.options(), registry, host.links());
  if (!host.options().lockstep) {
    if (missing_.empty())
      ready_.store(true, std::memory_order_release);
    return;
  }
  peers_.update(host.options(), registry, host.links(), session);
  for (const std::string& peer : peers_.missing())
    missing_ += (missing_.empty() ? "" : ", ") + peer + " to be ready";
  if (missing_.empty() && peers_.complete() && with_coupling)
    ready_.store(true, std::memory_order_release);
  if (!ready())
    return;
  const std::vector<runtime::Hung> hung = registry.hung();
  for (const bus::Guid& peer : peers_.participants())
    if (lost_.empty())
      lost_ = loss_of(peer, registry, hung);
}

}  // namespace voxtouch::device_node
