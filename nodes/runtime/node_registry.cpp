#include "nodes/runtime/node_registry.hpp"

#include <string.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "nodes/bus/exchange.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::runtime {

StatusWriter::StatusWriter(const bus::Participant& participant, std::string node,
                           const std::string& rig)
    : writer_(participant, qos::kNodeStatus, rig, qos::profile(qos::ProfileId::kStatus)),
      diagnostics_(participant, qos::kDiagnostics, rig, qos::profile(qos::kDiagnostics.profile)),
      full_name_(rig + "/" + node) {
  char host[256] = {};
  gethostname(host, sizeof host - 1);
  own_.node = std::move(node);
  own_.host = host;
  own_.pid = static_cast<std::uint32_t>(getpid());
  own_.participant = participant.guid();
}

namespace {

/// Truncates a report to the limits that a registry enforces.
NodeReport cut(NodeReport report) {
  constexpr std::size_t kMaxText = NodeRegistry::kMaxTextBytes;
  if (report.message.size() > kMaxText)
    report.message.resize(kMaxText);
  for (auto& [key, value] : report.values)
    if (value.size() > kMaxText)
      value.resize(kMaxText);
  return report;
}

}  // namespace

void StatusWriter::publish(const NodeReport& whole, bool set_publishing) {
  const NodeReport report = cut(whole);
  std::vector<msg::diagnostic_msgs_KeyValue> values;
  for (const auto& [key, value] : report.values)
    values.push_back({lend(key), lend(value)});
  std::vector<msg::Figure> figures;
  for (const auto& [name, figure] : report.figures)
    figures.push_back({lend(name), lend(figure.unit), figure.value});
  msg::NodeStatus sample{};
  sample.node = lend(own_.node);
  sample.host = lend(own_.host);
  sample.pid = own_.pid;
  std::memcpy(sample.participant, own_.participant.data(), own_.participant.size());
  sample.session_id = report.session_id;
  sample.state = static_cast<std::uint32_t>(report.state);
  sample.message = lend(report.message);
  sample.values._buffer = values.data();
  sample.values._length = sample.values._maximum = static_cast<std::uint32_t>(values.size());
  sample.figures._buffer = figures.data();
  sample.figures._length = sample.figures._maximum = static_cast<std::uint32_t>(figures.size());
  writer_.write(sample);
  if (set_publishing && diagnostics_.matched_count() > 0)
    publish_diagnostics(report, std::move(values));
}

void StatusWriter::publish_diagnostics(const NodeReport& report,
                                       std::vector<msg::diagnostic_msgs_KeyValue> values) {
  namespace level = msg::diagnostic_msgs_DiagnosticStatus_constants;
  ++diagnostics_made_;
  std::deque<std::string> texts;  // ROS supports only text; the addresses of the texts do not
                                  // change
  for (const auto& [name, figure] : report.figures)
    values.push_back({lend(name), lend(texts.emplace_back(
                                      fmt::format("{:.9g} {}", figure.value, figure.unit)))});
  msg::diagnostic_msgs_DiagnosticStatus status{};
  status.level = report.state == NodeState::kFailed     ? level::kError
                 : report.state == NodeState::kStarting ? level::kWarn
                                                        : level::kOk;
  status.name = lend(full_name_);
  status.message = lend(report.message);
  status.hardware_id = lend(own_.host);
  status.values._buffer = values.data();
  status.values._length = status.values._maximum = static_cast<std::uint32_t>(values.size());
  const std::int64_t now = realtime_ns();
  msg::diagnostic_msgs_DiagnosticArray array{};
  array.header.stamp = {static_cast<std::int32_t>(now / 1'000'000'000),
                        static_cast<std::uint32_t>(now % 1'000'000'000)};
  array.header.frame_id = const_cast<char*>("");
  array.status._buffer = &status;
  array.status._length = array.status._maximum = 1;
  diagnostics_.write(array);
}

void StatusWriter::flush() noexcept { writer_.wait_for_acknowledgments(DDS_SECS(1)); }

NodeRegistry::NodeRegistry(const bus::Participant& participant, const std::string& rig,
                           const bus::Guid& up)
    : senders_(std::make_unique<bus::Following>(bus::Following::WhileUnbound::kTakeAll)),
      reader_(participant, qos::kNodeStatus, rig, qos::profile(qos::ProfileId::kStatus),
              senders_.get()),
      graph_(participant.graph()),
      roles_(up == bus::Guid{} ? nullptr : std::make_unique<RigRoles>(participant, rig, up)) {}

/// A departed writer stays listed while its last samples may still be queued.
void NodeRegistry::update_participants() {
  const std::vector<dds_instance_handle_t> handles = reader_.writer_handles();
  here_.clear();
  for (const dds_instance_handle_t handle : handles) {
    auto known = writers_.find(handle);
    if (known == writers_.end())
      known = writers_.emplace(handle, bus::participant_of_writer(reader_.get(), handle)).first;
    here_.insert(known->second);
  }
}

/// Far more than a node sends, over several polls. After a pause of this process a single poll may
/// find many statuses.
void NodeRegistry::refuse_floods() {
  constexpr int kMany = 32;
  for (const auto& [writer, count] : taken_)
    if (const auto before = taken_before_.find(writer);
        count >= kMany && before != taken_before_.end() && before->second >= kMany)
      senders_->refuse(writer);
  taken_before_ = std::exchange(taken_, {});
}

bool NodeRegistry::fits(const msg::NodeStatus& s) {
  const auto too_long = [](const char* text, std::size_t most = kMaxTextBytes) {
    return !text || ::strnlen(text, most + 1) > most;
  };
  constexpr std::size_t kMaxNameBytes = 256;
  if (too_long(s.node, kMaxNameBytes) || too_long(s.host, kMaxNameBytes) || too_long(s.message))
    return false;
  if (s.values._length > kMaxValues || s.figures._length > kMaxValues)
    return false;
  const bool figures_fit = std::none_of(
      s.figures._buffer, s.figures._buffer + s.figures._length, [&](const auto& figure) {
        return too_long(figure.name, kMaxNameBytes) || too_long(figure.unit, kMaxNameBytes);
      });
  return figures_fit && std::none_of(s.values._buffer, s.values._buffer + s.values._length,
                                     [&](const auto& value) {
                                       return too_long(value.key, kMaxNameBytes) ||
                                              too_long(value.value);
                                     });
}

/// Accepts a status only from the participant that it names, and only if that participant is listed
/// or there is room.
bool NodeRegistry::is_its_own(const msg::NodeStatus& s, dds_instance_handle_t writer) const {
  const auto sender = writers_.find(writer);
  if (sender == writers_.end() ||
      std::memcmp(s.participant, sender->second.data(), sender->second.size()) != 0)
    return false;
  return reports_.contains(sender->second) || reports_.size() < kMaxNodes;
}

NodeReport to_report(const msg::NodeStatus& s) {
  NodeReport report{s.node,    s.host, s.pid, {}, s.session_id, static_cast<NodeState>(s.state),
                    s.message, {},     {},    0};
  std::memcpy(report.participant.data(), s.participant, report.participant.size());
  for (std::uint32_t i = 0; i < s.values._length; ++i)
    report.values[s.values._buffer[i].key] = s.values._buffer[i].value;
  for (std::uint32_t i = 0; i < s.figures._length; ++i)
    report.figures[s.figures._buffer[i].name] = {s.figures._buffer[i].value,
                                                 s.figures._buffer[i].unit};
  return report;
}

void NodeRegistry::take(const msg::NodeStatus& status) {
  NodeReport report = to_report(status);
  report.received_ns = clock_.now_ns();
  reports_[report.participant] = std::move(report);
}

void NodeRegistry::update(const std::function<bool(const NodeReport&)>& keep) {
  constexpr int kMaxTakes = 256;
  clock_.poll(monotonic_ns());
  update_participants();
  if (roles_)
    roles_->update();
  reader_.take_each(
      [this](const msg::NodeStatus& status, dds_instance_handle_t writer) {
        ++taken_[writer];
        const bool fitting = fits(status);
        if (!fitting)
          senders_->refuse(writer);
        if (fitting && is_its_own(status, writer))
          return take(status);
        ++refused_;
        constexpr std::size_t kMaxNamed = 16;
        if (const auto of = writers_.find(writer);
            of != writers_.end() && refused_participants_.size() < kMaxNamed)
          refused_participants_.insert(of->second);
      },
      kMaxTakes);
  refuse_floods();
  if (graph_)
    graph_->take_names();
  remember_vanished();
  std::erase_if(reports_, [&](const auto& entry) {
    return !is_here(entry.first) && !(keep && keep(entry.second));
  });
  std::erase_if(writers_, [&](const auto& entry) { return !is_here(entry.second); });
}

void NodeRegistry::remember_vanished() {
  constexpr std::size_t kMaxVanished = 16;  // any participant can choose its name
  constexpr double kRememberedS = 10.0;
  for (const auto& [guid, report] : reports_)
    if (!is_here(guid) && !report.final() && vanished_.size() < kMaxVanished)
      vanished_[report.node] = report;
  std::erase_if(vanished_, [&](const auto& entry) {
    const bool again = std::any_of(reports_.begin(), reports_.end(), [&](const auto& known) {
      return known.second.node == entry.first && is_here(known.first);
    });
    return again || silent_s(entry.second) > kRememberedS;
  });
}

std::vector<NodeReport> NodeRegistry::reports() const {
  std::vector<NodeReport> all;
  for (const auto& [guid, report] : reports_)
    all.push_back(report);
  std::sort(all.begin(), all.end(),
            [](const NodeReport& a, const NodeReport& b) { return a.node < b.node; });
  return all;
}

std::optional<NodeReport> NodeRegistry::find(std::string_view node) const {
  for (const auto& [guid, report] : reports_)
    if (report.node == node)
      return report;
  return std::nullopt;
}

std::vector<Hung> NodeRegistry::hung() const {
  constexpr double kHungS = static_cast<double>(kHungNs) * 1e-9;
  std::vector<Hung> all;
  std::vector<NodeReport> requested = reports();
  for (const auto& [name, report] : vanished_)
    if (!reports_.contains(report.participant))
      requested.push_back(report);  // `update` may have kept it
  for (const NodeReport& report : requested) {
    if (report.final() || report.node == "up")
      continue;  // `up` has no loop and publishes its presence once
    const double silent = silent_s(report), stalled = value_of(report.figures, kStalledFor);
    if (silent > kHungS) {
      const std::string lost = bus::lost_address();
      all.push_back({report.node, report.participant, silent,
                     lost.empty()
                         ? fmt::format("{} hangs: no status received for {} s", report.node, kHungS)
                         : fmt::format("no status received from {}: {}", report.node, lost)});
    } else if (stalled > kHungS) {
      const auto what = report.values.find(kStalled);
      all.push_back({report.node, report.participant, stalled,
                     fmt::format("{} hangs: {} is stalled for {} s", report.node,
                                 what == report.values.end() ? "its loop" : what->second, kHungS)});
    }
  }
  return all;
}

const NodeReport* NodeRegistry::report_of(const bus::Guid& participant) const {
  const auto known = reports_.find(participant);
  return known == reports_.end() ? nullptr : &known->second;
}

std::string NodeRegistry::known_name_of(const bus::Guid& guid) const {
  if (const NodeReport* report = report_of(guid))
    return fmt::format("{} (process {} on {})", report->node, report->pid, report->host);
  const std::string name = graph_ ? graph_->name_of(guid) : "";
  return name.empty() ? "" : fmt::format("ROS 2's {}", name);
}

std::string NodeRegistry::name_of(const bus::Guid& guid) const {
  const std::string known = known_name_of(guid);
  return known.empty() ? fmt::format("an unnamed participant ({})", to_text(guid)) : known;
}

std::optional<NodeReport> look_for(NodeRegistry& registry,
                                   const std::function<bool(const NodeReport&)>& requested,
                                   std::chrono::milliseconds patience) {
  const std::int64_t until = monotonic_ns() + std::chrono::nanoseconds(patience).count();
  for (; monotonic_ns() < until; std::this_thread::sleep_for(std::chrono::milliseconds(20))) {
    registry.update();
    for (NodeReport& report : registry.reports())
      if (requested(report))
        return std::move(report);
  }
  return std::nullopt;
}

std::uint64_t sessions_seen(const NodeRegistry& registry) {
  std::uint64_t most = 0;
  for (const NodeReport& report : registry.reports())
    most = std::max(most, as_count(value_of(report.figures, kSessions)));
  return most;
}

bool has_matched(const NodeRegistry& registry, const std::vector<bus::Guid>& matched,
                 const std::vector<std::string>& nodes) {
  const std::vector<NodeReport> reports = registry.reports();
  return std::all_of(nodes.begin(), nodes.end(), [&](const std::string& node) {
    return std::any_of(reports.begin(), reports.end(), [&](const NodeReport& report) {
      return report.node == node &&
             std::find(matched.begin(), matched.end(), report.participant) != matched.end();
    });
  });
}

}  // namespace voxtouch::runtime
