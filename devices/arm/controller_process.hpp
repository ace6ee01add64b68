#pragma once
/// A simulated controller as a child process that lives no longer than whoever started it.
#include <sys/types.h>

#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace voxtouch::arm {

class ControllerProcess {
 public:
  /// Starts `program` from the running program's folder with these arguments and `hand` (text of
  /// hand_file.hpp) as its hand, and waits until it is ready to send: its first line begins with
  /// "simulated controller:". Nothing of it is on a disk. Throws DeviceOpenError, which names
  /// `device`: the program is not there, or it ended at once; then with what it said.
  ControllerProcess(std::string_view device, const std::string& program,
                    const std::vector<std::string>& arguments, const std::string& hand);
  /// Ends it: asked first, by force after 2 s.
  ~ControllerProcess();
  ControllerProcess(const ControllerProcess&) = delete;
  ControllerProcess& operator=(const ControllerProcess&) = delete;

  pid_t pid() const noexcept { return pid_; }
  /// How it ended, as words; empty while it runs. Any thread.
  std::string ending() const;
  /// Its last words, on one line.
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
  mutable std::optional<int> status_;  // as waitpid gave it
};

}  // namespace voxtouch::arm
