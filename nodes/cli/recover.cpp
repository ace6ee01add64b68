#include <algorithm>
#include <chrono>
#include <thread>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/types/number.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/console/log.hpp"
#include "nodes/faults/fault_latch.hpp"
#include "nodes/runtime/options.hpp"

namespace voxtouch::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct RecoverOptions {
  runtime::NodeOptions node;
  bool json = false;
};

/// A fault latch that is set.
struct Latch {
  std::string node, number, reason;
  std::uint64_t session = 0;
};

class Recovery {
 public:
  explicit Recovery(const RecoverOptions& o)
      : participant_(o.node.participant("recover")),
        registry_(participant_, o.node.rig),
        resets_(participant_, qos::kRecover, o.node.rig, qos::profile(qos::ProfileId::kEvent)) {}

  /// Whether a node of the rig reports its status. Waits up to 1 s for a latch.
  bool receives_from_any() {
    return wait([this] { return !registry_.reports().empty() && !latches().empty(); },
                std::chrono::seconds(1)) ||
           !registry_.reports().empty();
  }
  std::vector<Latch> latches() const {
    std::vector<Latch> all;
    for (const runtime::NodeReport& report : registry_.reports())
      if (const auto number = report.values.find(faults::FaultLatch::kNumber);
          number != report.values.end()) {
        const auto reason = report.values.find(faults::FaultLatch::kReason);
        all.push_back({report.node, number->second,
                       reason == report.values.end() ? "" : reason->second, report.session_id});
      }
    return all;
  }
  /// Resets a latch. Returns false if it is still set after 2 s.
  bool reset(const Latch& latch) {
    (void)wait([this] { return resets_.matched_count() > 0; }, std::chrono::seconds(1));
    const auto number = parse_number<std::uint64_t>(latch.number);
    resets_.write(msg::Recover{latch.session, number.value_or(0)});
    return wait(
        [&] {
          return std::ranges::none_of(latches(), [&](const Latch& now) {
            return now.node == latch.node && now.number == latch.number;
          });
        },
        std::chrono::seconds(2));
  }

 private:
  template <class F>
  bool wait(F&& holds, std::chrono::milliseconds patience) {
    for (const auto until = Clock::now() + patience; Clock::now() < until;
         std::this_thread::sleep_for(std::chrono::milliseconds(20))) {
      registry_.update();
      if (holds())
        return true;
    }
    return false;
  }

  bus::Participant participant_;
  runtime::NodeRegistry registry_;
  bus::Writer<msg::Recover> resets_;
};

int recover(const RecoverOptions& o) {
  Recovery recovery(o);
  std::vector<std::string> problems;
  nlohmann::ordered_json opened = nlohmann::ordered_json::array();
  if (!recovery.receives_from_any())
    problems.push_back(fmt::format(
        "No node of rig '{}' found on domain {}. Check --rig, --domain, --interface and "
        "--security.",
        o.node.rig, o.node.domain));
  const std::vector<Latch> latches = recovery.latches();
  if (problems.empty() && latches.empty())
    problems.push_back("No fault latch is set in rig '" + o.node.rig +
                       "'; `voxtouch status` lists the nodes' states");
  for (const Latch& latch : latches) {
    if (!recovery.reset(latch)) {
      problems.push_back(
          fmt::format("The {} is still latched after 2 s: {}", latch.node, latch.reason));
      continue;
    }
    opened.push_back({{"node", latch.node}, {"reason", latch.reason}});
    if (!o.json)
      console::print_result("{} reset; force ramps in. Cause of the latch: {}\n", latch.node,
                            latch.reason);
  }
  if (o.json)
    console::print_result(
        "{}\n",
        nlohmann::ordered_json{{"ok", problems.empty()}, {"opened", opened}, {"problems", problems}}
            .dump(2));
  else
    for (const std::string& problem : problems)
      console::log("error: {}\n", problem);
  return problems.empty() ? 0 : 1;
}

}  // namespace

void add_recover(CLI::App& app, Action& action) {
  auto o = std::make_shared<RecoverOptions>();
  CLI::App* verb = app.add_subcommand("recover");
  runtime::add_rig_options(*verb, o->node);
  verb->add_flag("--json", o->json, "Prints one JSON object on stdout, the rest on stderr");
  verb->callback([o, &action] { action = [o] { return recover(*o); }; });
}

}  // namespace voxtouch::cli
