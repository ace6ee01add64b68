#pragma once
/// A part of a test in a separate process.
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <functional>
#include <stdexcept>

namespace voxtouch::test {

struct ForkEnd {
  int status = -1;  ///< exit status; 128 + signal number if a signal ended it
  rusage used{};
};

/// Runs `body` in a copy of this process, which ends at once, by _exit, with the result of `body`.
/// The copy is killed if this object is destroyed before `wait`.
class Forked {
 public:
  explicit Forked(const std::function<int()>& body) : pid_(fork()) {
    if (pid_ < 0)
      throw std::runtime_error("no process could be made");
    if (pid_ == 0)
      _exit(body());
  }
  ~Forked() {
    if (pid_ == 0)
      return;
    signal(SIGKILL);
    wait();
  }
  Forked(const Forked&) = delete;
  Forked& operator=(const Forked&) = delete;

  void signal(int number) const { ::kill(pid_, number); }
  /// Once.
  ForkEnd wait() {
    ForkEnd end;
    int raw = 0;
    while (wait4(pid_, &raw, 0, &end.used) < 0 && errno == EINTR)
      continue;
    end.status = WIFSIGNALED(raw) ? 128 + WTERMSIG(raw) : WEXITSTATUS(raw);
    pid_ = 0;
    return end;
  }

 private:
  pid_t pid_;
};

}  // namespace voxtouch::test
