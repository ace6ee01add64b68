#include "nodes/runtime/node_host.hpp"

#include <chrono>
#include <thread>

#include "nodes/runtime/realtime.hpp"

namespace voxtouch::runtime {

int NodeHost::monitored(const std::atomic<bool>& stop, const Report& report,
                        const std::function<void()>& loop, std::vector<Watched> stalls) {
  flush_denormals();
  if (stalls.empty())
    stalls.push_back({"its loop", [this] { return heartbeat_.sign(); }});
  const NodeMonitor monitor(
      participant_, node_, options_,
      [&report](NodeRegistry& registry, NodeReport& status) {
        StatusText text;
        status.message.clear();
        report(registry, status, text);
        status.message = text.text();
      },
      std::move(stalls));
  stop_ = &stop;
  monitor_ = &monitor;
  if (kind_ == Kind::kLoop)
    enter_loop(options_.realtime);
  loop();
  return monitor.peer_lost() ? 1 : 0;
}

void NodeHost::report_failure(const std::string& message) const {
  NodeOptions silent = options_;
  silent.announce = false;  // only the error is printed
  const NodeMonitor monitor(participant_, node_, silent, [&](NodeRegistry&, NodeReport& report) {
    report.state = NodeState::kFailed;
    report.message = message;
  });
  // readers must first match this writer
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
}

}  // namespace voxtouch::runtime
