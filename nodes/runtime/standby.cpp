#include "nodes/runtime/standby.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace voxtouch::runtime {
namespace {

std::string word(const NodeReport& report, const std::string& key) {
  const auto found = report.values.find(key);
  return found == report.values.end() ? std::string() : found->second;
}

std::optional<bus::Guid> from_hex(std::string_view text) {
  bus::Guid guid{};
  if (text.size() != 2 * guid.size())
    return std::nullopt;
  const auto digit = [](char c) {
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
  };
  for (std::size_t i = 0; i < guid.size(); ++i) {
    const int high = digit(text[2 * i]), low = digit(text[2 * i + 1]);
    if (high < 0 || low < 0)
      return std::nullopt;
    guid[i] = static_cast<typename bus::Guid::value_type>(16 * high + low);
  }
  return guid;
}

}  // namespace

bool plays(const NodeReport& report, std::string_view role) {
  return report.node == role || report.node == standby_of(role);
}

bool takes_part(const NodeReport& report) {
  return report.session_id != 0 &&
         (report.state == NodeState::kStarting || report.state == NodeState::kReady ||
          report.state == NodeState::kRunning);
}

bool says_that_it_acts(const NodeReport& report, std::string_view role) {
  const std::string duty = word(report, kDuty);
  return report.node == role ? duty != kStandsBy : report.node == standby_of(role) && duty == kActs;
}

bool says_that_it_acts_in_a_pair(const NodeReport& report, std::string_view role) {
  return plays(report, role) && word(report, kDuty) == kActs;
}

std::string to_hex(const bus::Guid& guid) { return fmt::format("{:02x}", fmt::join(guid, "")); }

NamedStandby named_standby(const NodeReport& report) {
  const std::string text = word(report, kStandby);
  if (text == kNoStandby)
    return {true, std::nullopt};
  const std::optional<bus::Guid> participant = from_hex(text);
  return {participant.has_value(), participant};
}

std::string SameIn::difference(const NodeReport& a, const NodeReport& b) const {
  for (const std::string& name : words)
    if (word(a, name) != word(b, name))
      return name;
  for (const std::string& name : figures)
    if (find_value(a.figures, name) != find_value(b.figures, name))
      return name;
  return {};
}

std::optional<bus::Guid> who_acts(const std::vector<NodeReport>& reports, std::string_view role,
                                  const bus::Guid& own) {
  std::optional<bus::Guid> found;
  for (const NodeReport& report : reports) {
    if (report.participant == own || !takes_part(report) || !says_that_it_acts(report, role))
      continue;
    if (found)
      return std::nullopt;
    found = report.participant;
  }
  return found;
}

std::vector<bus::Guid> who_could_stand_by(const std::vector<NodeReport>& reports,
                                          std::string_view role, const NodeReport& own_report,
                                          const bus::Guid& own, const SameIn& same) {
  std::vector<bus::Guid> found;
  for (const NodeReport& report : reports) {
    if (report.participant == own || !plays(report, role) || says_that_it_acts(report, role))
      continue;
    const bool is_ready = report.state == NodeState::kReady || report.state == NodeState::kRunning;
    if (is_ready && report.session_id != 0 && report.session_id == own_report.session_id &&
        same.difference(own_report, report).empty())
      found.push_back(report.participant);
  }
  return found;
}

}  // namespace voxtouch::runtime
