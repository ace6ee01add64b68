#include "nodes/runtime/signals.hpp"

#include <signal.h>
#include <sys/prctl.h>

namespace voxtouch::runtime {

std::atomic<bool>& stop_requested() noexcept {
  static std::atomic<bool> flag{false};
  return flag;
}

void catch_signals() {
  stop_requested();  // made before a handler can need it
  struct sigaction action {};
  action.sa_handler = [](int) { stop_requested().store(true, std::memory_order_relaxed); };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  signal(SIGPIPE, SIG_IGN);
}

void die_with_parent() { prctl(PR_SET_PDEATHSIG, SIGTERM); }

}  // namespace voxtouch::runtime
