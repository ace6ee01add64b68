#include "nodes/view/node_table.hpp"

#include <algorithm>
#include <array>

#include <nlohmann/json.hpp>

#include "nodes/view/rounded.hpp"

namespace voxtouch::view {
namespace {

/// The counted figure of each node.
struct Counted {
  std::string_view node, figure, unit;
};
constexpr std::array<Counted, 5> kCounted = {{{"device", "samples", "samples"},
                                              {"rendering", "samples", "samples"},
                                              {"coupling", "samples", "samples"},
                                              {"validator", "checked", "verdicts"},
                                              {"logger", "written", "messages"}}};

std::size_t order_of(std::string_view node) {
  return static_cast<std::size_t>(std::ranges::find(kCounted, node, &Counted::node) -
                                  kCounted.begin());
}

std::string name_of(runtime::NodeState state) {
  constexpr const char* kNames[] = {"starting", "ready", "running", "stopped", "failed"};
  const auto n = static_cast<std::size_t>(state);
  return n < std::size(kNames) ? kNames[n] : "unknown";
}

constexpr std::int64_t kRateOverNs = 900'000'000;

nlohmann::json or_null(const std::optional<double>& value) {
  return value ? rounded(*value) : nullptr;
}

}  // namespace

nlohmann::ordered_json to_json(const std::vector<NodeRow>& rows) {
  auto all = nlohmann::ordered_json::array();
  for (const NodeRow& row : rows)
    all.push_back({{"node", row.report.node},
                   {"host", row.report.host},
                   {"pid", row.report.pid},
                   {"state", row.state},
                   {"rate_hz", or_null(row.rate_hz)},
                   {"counted", row.counted},
                   {"answered_ratio", or_null(row.answered_ratio)},
                   {"sentence", row.report.message}});
  return all;
}

/// Rates are counts over about a second.
void NodeTable::take(const runtime::NodeReport& report, std::int64_t now_ns) {
  if (report.node == "up")
    return;  // `up` is not a node of the ring
  auto known = entries_.find(report.node);
  if (known == entries_.end() && entries_.size() >= kMaxNodes)
    return;
  const bool is_new =
      known == entries_.end() || known->second.row.report.participant != report.participant;
  if (is_new)
    known = entries_.insert_or_assign(report.node, Entry{}).first;
  Entry& k = known->second;
  k.row.report = report;
  k.row.state = name_of(report.state);
  k.seen_ns = now_ns;
  k.present = true;
  if (const std::size_t n = order_of(report.node); n < kCounted.size()) {
    const double count = runtime::value_of(report.figures, kCounted[n].figure);
    k.row.counted = kCounted[n].unit;
    if (k.counted_ns == 0 || count < k.counted_before || now_ns < k.counted_ns) {
      k.counted_before = count, k.counted_ns = now_ns, k.row.rate_hz.reset();
    } else if (now_ns - k.counted_ns >= kRateOverNs) {
      k.row.rate_hz =
          (count - k.counted_before) / (static_cast<double>(now_ns - k.counted_ns) * 1e-9);
      k.counted_before = count, k.counted_ns = now_ns;
    }
  }
  if (report.node == "device")
    k.row.answered_ratio = runtime::find_value(report.figures, "last_second_answered_ratio");
}

void NodeTable::update(const runtime::NodeRegistry& registry, std::int64_t now_ns) {
  for (auto& [name, known] : entries_)
    known.present = false;
  for (const runtime::NodeReport& report : registry.reports()) {
    const auto known = entries_.find(report.node);
    // Of two nodes with one name, show the running one.
    if (report.final() && known != entries_.end() && known->second.present)
      continue;
    take(report, now_ns);
  }
  for (const runtime::Hung& hung : registry.hung())
    if (const auto known = entries_.find(hung.node);
        known != entries_.end() && known->second.present) {
      known->second.row.state = "hangs";
      known->second.row.report.message = hung.sentence;
    }
  std::erase_if(entries_, [&](const auto& entry) {
    return !entry.second.present &&
           static_cast<double>(now_ns - entry.second.seen_ns) * 1e-9 > kRetentionS;
  });
}

void NodeTable::update(runtime::NodeReport report, std::int64_t now_ns) {
  constexpr std::int64_t kGoneNs = 2'000'000'000;
  for (auto& [name, known] : entries_)
    known.present = now_ns - known.seen_ns < kGoneNs;
  take(report, now_ns);
}

std::vector<NodeRow> NodeTable::rows(std::int64_t now_ns) const {
  std::vector<NodeRow> rows;
  for (const auto& [name, known] : entries_) {
    NodeRow row = known.row;
    const bool runs = known.present && !row.report.final() && row.state != "hangs";
    if (!runs)
      row.rate_hz.reset(), row.answered_ratio.reset();
    if (!known.present && !row.report.final()) {
      row.state = "gone";
      row.report.message =
          "lost without a final status " +
          std::to_string(std::max<std::int64_t>(0, (now_ns - known.seen_ns) / 1'000'000'000)) +
          " s ago";
    }
    rows.push_back(std::move(row));
  }
  std::ranges::stable_sort(rows, {}, [](const NodeRow& row) { return order_of(row.report.node); });
  return rows;
}

}  // namespace voxtouch::view
