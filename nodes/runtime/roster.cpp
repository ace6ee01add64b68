#include "nodes/runtime/roster.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <thread>

#include <fmt/format.h>

#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::runtime {

StatusWriter::StatusWriter(const bus::Participant& participant, std::string node, const std::string& rig)
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

void StatusWriter::publish(const NodeReport& report) {
  std::vector<msg::diagnostic_msgs_KeyValue> values;
  for (const auto& [key, value] : report.values) values.push_back({lend(key), lend(value)});
  std::vector<msg::Figure> figures;
  for (const auto& [name, figure] : report.figures) figures.push_back({lend(name), lend(figure.unit), figure.value});
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
  if (diagnostics_.matched_count() > 0) publish_diagnostics(report, std::move(values));
}

void StatusWriter::publish_diagnostics(const NodeReport& report, std::vector<msg::diagnostic_msgs_KeyValue> values) {
  namespace level = msg::diagnostic_msgs_DiagnosticStatus_constants;
  ++diagnostics_made_;
  std::deque<std::string> texts;  // ROS knows words only; addresses stay
  for (const auto& [name, figure] : report.figures)
    values.push_back({lend(name), lend(texts.emplace_back(fmt::format("{:.9g} {}", figure.value, figure.unit)))});
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

Roster::Roster(const bus::Participant& participant, const std::string& rig)
    : reader_(participant, qos::kNodeStatus, rig, qos::profile(qos::ProfileId::kStatus)) {}

void Roster::update(bool keep_gone) {
  reader_.take_each([this](const msg::NodeStatus& s) {
    NodeReport report{s.node, s.host, s.pid, {}, s.session_id, static_cast<NodeState>(s.state), s.message, {}, {}};
    std::memcpy(report.participant.data(), s.participant, report.participant.size());
    for (std::uint32_t i = 0; i < s.values._length; ++i)
      report.values[s.values._buffer[i].key] = s.values._buffer[i].value;
    for (std::uint32_t i = 0; i < s.figures._length; ++i)
      report.figures[s.figures._buffer[i].name] = {s.figures._buffer[i].value, s.figures._buffer[i].unit};
    reports_[report.participant] = std::move(report);
  });
  if (keep_gone) return;
  const std::vector<bus::Guid> here = reader_.matched();
  std::erase_if(reports_,
                [&](const auto& entry) { return std::find(here.begin(), here.end(), entry.first) == here.end(); });
}

std::vector<NodeReport> Roster::reports() const {
  std::vector<NodeReport> all;
  for (const auto& [guid, report] : reports_) all.push_back(report);
  std::sort(all.begin(), all.end(), [](const NodeReport& a, const NodeReport& b) { return a.node < b.node; });
  return all;
}

std::optional<NodeReport> Roster::find(std::string_view node) const {
  for (const auto& [guid, report] : reports_)
    if (report.node == node) return report;
  return std::nullopt;
}

std::string Roster::name_of(const bus::Guid& guid) const {
  const auto known = reports_.find(guid);
  if (known == reports_.end()) return "a participant that gives no name";
  return known->second.node + " (process " + std::to_string(known->second.pid) + " on " + known->second.host + ")";
}

std::optional<NodeReport> look_for_others(Roster& roster, std::string_view node, std::chrono::milliseconds patience) {
  const std::int64_t until = monotonic_ns() + std::chrono::nanoseconds(patience).count();
  for (; monotonic_ns() < until; std::this_thread::sleep_for(std::chrono::milliseconds(20))) {
    roster.update();
    for (NodeReport& report : roster.reports())
      if (node.empty() || report.node == node) return std::move(report);
  }
  return std::nullopt;
}

std::uint64_t sessions_seen(const Roster& roster) {
  std::uint64_t most = 0;
  for (const NodeReport& report : roster.reports())
    most = std::max(most, as_count(value_of(report.figures, kSessions)));
  return most;
}

bool has_matched(const Roster& roster, const std::vector<bus::Guid>& matched, const std::vector<std::string>& nodes) {
  return std::all_of(nodes.begin(), nodes.end(), [&](const std::string& node) {
    const auto report = roster.find(node);
    return report && std::find(matched.begin(), matched.end(), report->participant) != matched.end();
  });
}

}  // namespace voxtouch::runtime
