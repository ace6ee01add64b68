#pragma once
/// A simulated controller as a child process that does not outlive its parent.
#include <sys/types.h>

#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace voxtouch::arm {

class ControllerProcess {
 public:
  /// Starts `program` from the folder of the running program, with these arguments and `hand` (text
  /// of hand_file.hpp) as its hand. Waits until its first line, "simulated controller:...", reports
  /// that it is ready to send. Uses no files on disk. Throws DeviceOpenError, which names `device`,
  /// if the program is missing or ended at once; then with its output.
  ControllerProcess(std::string_view device, const std::string& program,
                    const std::vector<std::string>& arguments, const std::string& hand);
  /// Ends the process with SIGTERM, after 2 s with SIGKILL.
  ~ControllerProcess();
  ControllerProcess(const ControllerProcess&) = delete;
  ControllerProcess& operator=(const ControllerProcess&) = delete;

  pid_t pid() const noexcept { return pid_; }
  /// How it ended, as text; empty while it runs. Any thread.
  std::string ending() const;
  /// Its last output, on one line.
  std::string said() const;

 private:
  void start(const std::string& program, const std::vector<std::string>& arguments);
  [[noreturn]] void refuse(const std::string& why) const;
  void wait_until_ready();
  void end() noexcept;
  bool running() const;  // with the mutex held

  struct File {
    File(const char* name, std::string_view device);
    ~File();
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    int number = -1;
  };
  std::string device_;
  File hand_, log_;  // in memory
  pid_t pid_ = -1;
  mutable std::mutex mutex_;
  mutable std::optional<int> status_;  // as returned by waitpid
};

}  // namespace voxtouch::arm
