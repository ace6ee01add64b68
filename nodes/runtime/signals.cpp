#include "nodes/runtime/signals.hpp"

#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

namespace voxtouch::runtime {

std::atomic<bool>& stop_requested() noexcept {
  static std::atomic<bool> flag{false};
  return flag;
}

void catch_signals() {
  stop_requested();  // created here, since a handler must not create it
  struct sigaction action {};
  action.sa_handler = [](int) { stop_requested().store(true, std::memory_order_relaxed); };
  sigset_t ours;
  sigemptyset(&ours);
  struct sigaction hangup {};
  sigaction(SIGHUP, nullptr, &hangup);
  const bool under_nohup = hangup.sa_handler == SIG_IGN;
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    if (number == SIGHUP && under_nohup)
      continue;
    sigaction(number, &action, nullptr);
    sigaddset(&ours, number);
  }
  signal(SIGPIPE, SIG_IGN);
  pthread_sigmask(SIG_UNBLOCK, &ours, nullptr);
}

void die_with_parent(int parent) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent)
    raise(SIGTERM);  // the parent had already ended at the request
}

}  // namespace voxtouch::runtime
