#pragma once
/// Another program, run once from its first word to its last.
#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace voxtouch::cli {

struct ChildProgram {
  std::vector<std::string>
      words;            ///< the program, by its path or to be found on PATH, and its arguments
  std::string input{};  ///< its whole stdin
  /// Empty: waits for its end. Otherwise it runs in a new session, which Ctrl-C of this terminal
  /// does not reach, and continues in the background when the time is over.
  std::optional<std::chrono::milliseconds> patience{};
  /// Called every 20 ms with the end of its output so far; may be empty.
  std::function<void(std::string_view said)> listen{};
};

struct Ended {
  int status = 0;    ///< as waitpid gives it
  std::string said;  ///< stdout and stderr, without trailing line ends
};

/// Runs it to its end; empty if it takes longer than its patience. Throws std::runtime_error if it
/// cannot be started.
std::optional<Ended> run_program(const ChildProgram& program);

}  // namespace voxtouch::cli
