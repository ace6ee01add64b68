#include "nodes/runtime/participation.hpp"

#include <algorithm>

#include "nodes/runtime/clock.hpp"

namespace voxtouch::runtime {

std::vector<std::string> taking_part(const NodeOptions& options, std::vector<std::string> nodes) {
  std::erase_if(
      nodes, [&](const std::string& node) { return node != "device" && !options.has_peer(node); });
  return nodes;
}

std::string missing_links(const NodeOptions& options, const NodeRegistry& registry,
                          const std::vector<Link>& links, bool with_device) {
  std::string missing;
  for (const Link& link : links) {
    const std::vector<bus::Guid> matched = link.matched();
    for (const std::string& node : taking_part(options, link.nodes))
      if ((with_device || node != "device") && !has_matched(registry, matched, {node}))
        missing += (missing.empty() ? "" : ", ") + node + " on " + link.what;
  }
  return missing;
}

namespace {

bool is_among(const std::vector<std::string>& nodes, const std::string& node) {
  return std::find(nodes.begin(), nodes.end(), node) != nodes.end();
}

}  // namespace

void PeerSet::update(const NodeOptions& options, const NodeRegistry& registry,
                     const std::vector<Link>& links, std::uint64_t session) {
  if (session != session_)
    complete_ = false, participants_.clear(), session_ = session;
  if (!options.lockstep || session == 0 || complete_)
    return;
  participants_.clear();
  missing_ = taking_part(options, nodes_);
  for (const NodeReport& report : registry.reports()) {
    const bool is_ready = report.state == NodeState::kReady || report.state == NodeState::kRunning;
    if (!is_ready || report.session_id != session ||
        !is_among(taking_part(options, nodes_), report.node))
      continue;
    const bool is_linked = std::all_of(links.begin(), links.end(), [&](const Link& link) {
      const std::vector<bus::Guid> matched =
          is_among(link.nodes, report.node) ? link.matched() : std::vector{report.participant};
      return std::find(matched.begin(), matched.end(), report.participant) != matched.end();
    });
    if (!is_linked)
      continue;
    participants_.insert(report.participant);
    std::erase(missing_, report.node);
  }
  complete_ = missing_.empty();
}

bool RepublishTimer::is_due(const NodeRegistry& registry, std::uint64_t session,
                            const qos::Topic& topic) {
  const std::vector<std::string> readers =
      qos::names_of(static_cast<qos::Nodes>(topic.readers & ~qos::kLogger));
  const std::vector<NodeReport> reports = registry.reports();
  const bool waits = std::any_of(reports.begin(), reports.end(), [&](const NodeReport& report) {
    return report.session_id != session &&
           std::find(readers.begin(), readers.end(), report.node) != readers.end();
  });
  const std::int64_t now = monotonic_ns();
  if (waits && answered_ns_ != 0 && now - answered_ns_ < 1'000'000'000)
    return false;
  const bool due = waits && answered_ns_ != 0;
  answered_ns_ = now;
  return due;
}

std::string Session::report_to(NodeReport& report, const NodeOptions& options,
                               const NodeRegistry& registry, const std::vector<Link>& links,
                               std::string_view first, bool busy) {
  const std::uint64_t id = id_.load(std::memory_order_acquire);
  std::string missing(id == 0 ? first : "");
  if (id != 0 && options.lockstep)
    missing = missing_links(options, registry, links);
  const bool ready = missing.empty(),
             ready_for_device = id == 0 && missing_links(options, registry, links, false).empty();
  lockstep_peers_.update(options, registry, links, id);
  report.lockstep_peers = lockstep_peers_.participants();
  report.session_id = ready ? id : 0;
  report.state = stopped() ? NodeState::kStopped
                 : !ready  ? (ready_for_device ? NodeState::kReady : NodeState::kStarting)
                 : busy    ? NodeState::kRunning
                           : NodeState::kReady;
  report.figures[kSessions] = {count_.load(std::memory_order_relaxed), "sessions"};
  return missing;
}

}  // namespace voxtouch::runtime
