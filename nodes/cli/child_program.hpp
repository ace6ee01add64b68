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
  std::string input{};  ///< all that it can read
  /// Nothing: it is waited for. Else it runs in a session of its own, where no Ctrl-C of this
  /// program's terminal reaches it, and goes on where it takes longer.
  std::optional<std::chrono::milliseconds> patience{};
  /// Called every 20 ms with the end of what it has said so far; none: nothing listens.
  std::function<void(std::string_view said)> listen{};
};

struct Ended {
  int status = 0;    ///< as waitpid gives it
  std::string said;  ///< stdout and stderr as they came, without the line ends at the end
};

/// Runs it to its end; nothing where it takes longer than its patience. Throws std::runtime_error,
/// a sentence, where it cannot be started.
std::optional<Ended> run_program(const ChildProgram& program);

}  // namespace voxtouch::cli
