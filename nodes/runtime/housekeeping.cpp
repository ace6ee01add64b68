#include "nodes/runtime/housekeeping.hpp"

#include <sched.h>

#include <chrono>

#include <fmt/format.h>

#include "nodes/log/tell.hpp"
#include "nodes/runtime/clock.hpp"

namespace voxtouch::runtime {

Housekeeping::Housekeeping(const bus::Participant& participant, std::string node, const NodeOptions& options,
                           std::function<void(Roster&, NodeReport&)> look)
    : options_(options), node_(node), writer_(participant, std::move(node), options.rig),
      roster_(participant, options.rig), look_(std::move(look)) {
  turn();
  thread_ = std::thread([this] {
    const sched_param ordinary{};
    sched_setscheduler(0, SCHED_OTHER, &ordinary);  // the creator may run under SCHED_FIFO
    while (!stop_.load(std::memory_order_acquire)) {
      turn_or_skip();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
}

Housekeeping::~Housekeeping() {
  stop_.store(true, std::memory_order_release);
  thread_.join();
  last_publish_ns_ = 0;
  turn_or_skip();
  writer_.flush();
}

void Housekeeping::turn_or_skip() noexcept {
  try {
    turn();
  } catch (const std::exception&) {
    // Out of memory, say. A report is lost; an exception that left this thread would end the process, and the device with it.
  }
}

/// Nodes on several hosts each read their own copy of the scene: two that differ would render one and shape the other.
void Housekeeping::compare_scenes(NodeReport& report) const {
  const auto own = report.values.find("scene_hash");
  if (own == report.values.end()) return;
  for (const NodeReport& other : roster_.reports()) {
    const auto its = other.values.find("scene_hash");
    if (its == other.values.end() || its->second == own->second) continue;
    const auto name = other.values.find("scene");
    report.message =
        fmt::format("warning: this node runs scene '{}' ({}), but {} on {} runs '{}' ({}): give both the same file",
                    report.values["scene"], own->second, other.node, other.host,
                    name == other.values.end() ? "?" : name->second, its->second);
    return;
  }
}

void Housekeeping::turn() {
  roster_.update();
  NodeReport report = last_;
  look_(roster_, report);
  report.figures["refused_statuses"] = {roster_.refused(), "statuses"};
  for (std::size_t i = 0; i < options_.warnings.size(); ++i)
    report.values["warning_" + std::to_string(i + 1)] = options_.warnings[i];
  compare_scenes(report);
  if (const std::uint64_t lost = texts_lost()) report.figures["lost_texts"] = {lost, "texts"};
  const bool announce = options_.announce && report.message != last_.message;
  const std::int64_t now = monotonic_ns();
  const bool changed =
      report.state != last_.state || report.session_id != last_.session_id || report.message != last_.message;
  if (!changed && last_publish_ns_ != 0 && now - last_publish_ns_ < 1'000'000'000) return;
  writer_.publish(report);
  last_ = std::move(report);
  if (announce) tell("{}: {}\n", node_, last_.message);  // after the report itself: that one is for the other nodes
  last_publish_ns_ = now;
}

}  // namespace voxtouch::runtime
