#pragma once
/// The nodes of a rig as a table: state, rate and last message, also of hung and lost nodes.
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "nodes/runtime/node_registry.hpp"

namespace voxtouch::view {

struct NodeRow {
  runtime::NodeReport report;
  std::string state;                     ///< starting, ready, running, stopped, failed, hangs, gone
  std::optional<double> rate_hz;         ///< rate of `counted`
  std::string counted;                   ///< samples, messages, verdicts
  std::optional<double> answered_ratio;  ///< device only: over the last second
};

/// node, host, pid, state, rate_hz, counted, answered_ratio and sentence of each row; null if
/// unknown.
nlohmann::ordered_json to_json(const std::vector<NodeRow>& rows);

class NodeTable {
 public:
  /// Takes all reports of a registry. Nodes that left it stay in the table as `gone` for
  /// kRetentionS, or until another node takes the name.
  void update(const runtime::NodeRegistry& registry, std::int64_t now_ns);
  /// Takes one report from a bag.
  void update(runtime::NodeReport report, std::int64_t now_ns);
  void clear() { entries_.clear(); }
  /// In the order of the ring: device, rendering, coupling, then the taps.
  std::vector<NodeRow> rows(std::int64_t now_ns) const;

  static constexpr double kRetentionS = 60.0;
  static constexpr std::size_t kMaxNodes = 32;

 private:
  struct Entry {
    NodeRow row;
    std::int64_t seen_ns = 0;
    double counted_before = 0.0;
    std::int64_t counted_ns = 0;
    bool present = true;
  };
  void take(const runtime::NodeReport& report, std::int64_t now_ns);
  std::map<std::string, Entry> entries_;
};

}  // namespace voxtouch::view
