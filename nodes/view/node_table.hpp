#pragma once
/// The nodes of a rig as a table: who runs, how fast, and its last sentence; also of those that
/// hang or have gone.
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
  std::optional<double> rate_hz;         ///< of what it counts
  std::string counted;                   ///< what that is: samples, messages
  std::optional<double> answered_ratio;  ///< of the device: in the last second
};

/// Of each row node, host, pid, state, rate_hz, counted, answered_ratio and sentence; null for what
/// is not known.
nlohmann::ordered_json to_json(const std::vector<NodeRow>& rows);

class NodeTable {
 public:
  /// Everything that a registry knows now; nodes that it knows no more stay in the table as gone,
  /// until another takes the name or kKeptS are over.
  void update(const runtime::NodeRegistry& registry, std::int64_t now_ns);
  /// One report from a bag.
  void update(runtime::NodeReport report, std::int64_t now_ns);
  void forget() { known_.clear(); }
  /// By the way that a sample goes: device, rendering, coupling, then the taps.
  std::vector<NodeRow> rows(std::int64_t now_ns) const;

  static constexpr double kKeptS = 60.0;
  static constexpr std::size_t kMaxNodes = 32;

 private:
  struct Known {
    NodeRow row;
    std::int64_t seen_ns = 0;
    double counted_before = 0.0;
    std::int64_t counted_ns = 0;
    bool here = true;
  };
  void take(const runtime::NodeReport& report, std::int64_t now_ns);
  std::map<std::string, Known> known_;
};

}  // namespace voxtouch::view
