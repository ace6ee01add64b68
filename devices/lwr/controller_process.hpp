#pragma once
/// The simulated controller as a child process that lives no longer than whoever started it.
#include <sys/types.h>

#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace voxtouch::lwr {

class ControllerProcess {
 public:
  /// Starts voxtouch_fri_controller from the running program's folder with these arguments and `hand` (text of hand_file.hpp) as
  /// its hand, and waits until it is ready to send. Nothing of it is on a disk. Throws DeviceOpenError: the program is not there, or
  /// it ended at once; then with what it said.
  ControllerProcess(const std::vector<std::string>& arguments, const std::string& hand);
  /// Ends it: asked first, by force after 2 s.
  ~ControllerProcess();
  ControllerProcess(const ControllerProcess&) = delete;
  ControllerProcess& operator=(const ControllerProcess&) = delete;

  pid_t pid() const noexcept { return pid_; }
  /// How it ended, as words; empty while it runs. Any thread.
  std::string ending() const;

 private:
  void start(const std::string& program, const std::vector<std::string>& arguments);
  void wait_until_ready();
  void end() noexcept;
  bool running() const;  // with the mutex held
  std::string said() const;

  struct File {
    explicit File(const char* name);
    ~File();
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    int number = -1;
  };
  File hand_, log_;  // in memory
  pid_t pid_ = -1;
  mutable std::mutex mutex_;
  mutable std::optional<int> status_;  // as waitpid gave it
};

}  // namespace voxtouch::lwr
