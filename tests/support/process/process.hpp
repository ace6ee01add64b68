#pragma once
/// Programs under test as child processes; a test ends only processes that it started.
#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace voxtouch::test {

struct Finished {
  int status = -1;  ///< exit status; 128 + signal number if a signal ended it
  std::string out, err;
};

class Process {
 public:
  /// Starts `arguments[0]` with further environment variables; throws if it cannot be started.
  explicit Process(const std::vector<std::string>& arguments,
                   const std::map<std::string, std::string>& environment = {});
  ~Process();  ///< ends it by force if it still runs
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  pid_t pid() const noexcept { return pid_; }
  void signal(int number) const;
  bool running();
  /// Waits for its end; ends it by force after `patience` (status 128 + 9 then).
  Finished wait(std::chrono::seconds patience = std::chrono::seconds(60));
  std::string err() const;  ///< output so far

 private:
  pid_t pid_ = 0;
  std::optional<int> status_;
  std::filesystem::path folder_;
};

/// Whether `up` has shown a line of figures on standard error: all its nodes run.
inline bool runs(const Process& up) {
  return up.err().find(" samples  force") != std::string::npos;
}

/// A temporary folder, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

/// Also if its status was not yet collected: the process that inherits the children of a killed one
/// may take seconds.
bool has_ended(pid_t process);
/// A DDS domain that no other test of this machine uses at the same time; the same for the whole
/// process.
std::string fresh_domain();
/// Pids of the living children of `parent`.
std::vector<pid_t> children_of(pid_t parent);
/// The living child with a program path that ends with `program`; 0 if there is none.
pid_t child_called(pid_t parent, const std::string& program);

}  // namespace voxtouch::test
