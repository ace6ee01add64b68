#include <algorithm>
#include <map>
#include <memory>
#include <thread>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "nodes/bus/writer_discovery.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/console/log.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/options.hpp"
#include "nodes/runtime/signals.hpp"
#include "nodes/view/node_table.hpp"

namespace voxtouch::cli {
namespace {

struct StatusOptions {
  runtime::NodeOptions node;
  bool one_rig = false, watch = false, json = false;
};

/// Rigs are found by the topics of their nodes' statuses.
class Rigs {
 public:
  explicit Rigs(const StatusOptions& o)
      : participant_(o.node.participant("status")),
        discovery_(participant_.get()) {
    if (o.one_rig)
      add(o.node.rig);
    one_rig_ = o.one_rig;
  }

  void update() {
    discovery_.take([this](const dds_builtintopic_endpoint_t& writer) {
      const std::string name = writer.topic_name, tail = "/" + std::string(qos::kNodeStatus.path);
      constexpr std::string_view kRos = "rt/";
      if (one_rig_ || !name.starts_with(kRos) || !name.ends_with(tail) ||
          name.size() <= kRos.size() + tail.size())
        return;
      add(name.substr(kRos.size(), name.size() - kRos.size() - tail.size()));
    });
    for (auto& [name, rig] : rigs_) {
      rig.registry->update();
      rig.nodes.update(*rig.registry, runtime::monotonic_ns());
    }
  }

  /// Of each rig that has nodes.
  std::map<std::string, std::vector<view::NodeRow>> rows() const {
    std::map<std::string, std::vector<view::NodeRow>> all;
    for (const auto& [name, rig] : rigs_)
      if (auto rows = rig.nodes.rows(runtime::monotonic_ns()); !rows.empty())
        all[name] = std::move(rows);
    return all;
  }

 private:
  struct Rig {
    std::unique_ptr<runtime::NodeRegistry> registry;
    view::NodeTable nodes;
  };
  void add(const std::string& name) {
    constexpr std::size_t kMaxRigs = 64;  // any participant can choose its name
    if (rigs_.size() < kMaxRigs && !rigs_.contains(name))
      rigs_[name].registry = std::make_unique<runtime::NodeRegistry>(participant_, name);
  }
  bus::Participant participant_;
  bus::WriterDiscovery discovery_;
  bool one_rig_ = false;
  std::map<std::string, Rig> rigs_;
};

using Rows = std::map<std::string, std::vector<view::NodeRow>>;

bool is_well(const view::NodeRow& row) {
  return row.state != "failed" && row.state != "hangs" && row.state != "gone";
}
bool is_well(const Rows& rigs) {
  return std::ranges::all_of(rigs, [](const auto& rig) {
    return std::ranges::all_of(rig.second, [](const auto& row) { return is_well(row); });
  });
}

std::string to_text(const Rows& rigs, std::uint32_t domain) {
  if (rigs.empty())
    return fmt::format(
        "No node found on domain {}. Check that a ring runs, --domain, --interface and "
        "--security.\n",
        domain);
  std::string text;
  for (const auto& [name, rows] : rigs) {
    text += fmt::format("rig {}, domain {}\n  {:<10} {:<9} {:>16} {:>9}  {}\n", name, domain,
                        "node", "state", "rate", "answered", "last message");
    for (const view::NodeRow& row : rows)
      text += fmt::format(
          "  {:<10} {:<9} {:>16} {:>9}  {}\n", row.report.node, row.state,
          row.rate_hz ? fmt::format("{:.0f} {}/s", *row.rate_hz, row.counted) : "-",
          row.answered_ratio ? fmt::format("{:.1f} %", 100.0 * *row.answered_ratio) : "-",
          row.report.message);
  }
  return text;
}

std::string to_json(const Rows& rigs, std::uint32_t domain) {
  nlohmann::ordered_json j{
      {"ok", is_well(rigs)}, {"domain", domain}, {"rigs", nlohmann::ordered_json::object()}};
  for (const auto& [name, rows] : rigs)
    j["rigs"][name] = view::to_json(rows);
  return j.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

/// Once: after as long as nodes that run need to be found and their rates to be counted.
int status(const StatusOptions& o) {
  constexpr std::int64_t kOnceNs = 2'500'000'000, kEachNs = 1'000'000'000;
  runtime::catch_signals();
  Rigs rigs(o);
  const std::int64_t begin_ns = runtime::monotonic_ns();
  std::int64_t reported_ns = begin_ns;
  while (!runtime::stop_requested().load()) {
    rigs.update();
    const std::int64_t now_ns = runtime::monotonic_ns();
    if (now_ns - reported_ns >= (o.watch ? kEachNs : kOnceNs)) {
      reported_ns = now_ns;
      const Rows rows = rigs.rows();
      console::print_result("{}\n",
                            o.json ? to_json(rows, o.node.domain) : to_text(rows, o.node.domain));
      console::finish_results();  // each second, so that the watch ends with its reader
      if (!o.watch)
        return !rows.empty() && is_well(rows) ? 0 : 1;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return 0;
}

}  // namespace

void add_status(CLI::App& app, Action& action) {
  auto o = std::make_shared<StatusOptions>();
  CLI::App* verb = app.add_subcommand("status");
  runtime::add_rig_options(*verb, o->node);
  verb->add_flag("--watch", o->watch, "Prints the list every second until Ctrl-C");
  verb->add_flag("--json", o->json,
                 "Prints one JSON object on stdout; with --watch one every second");
  verb->callback([o, verb, &action] {
    o->one_rig = verb->get_option("--rig")->count() > 0;
    action = [o] { return status(*o); };
  });
}

}  // namespace voxtouch::cli
