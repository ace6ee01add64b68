#pragma once
/// Messages on stderr and results on stdout. A blocked stderr never stalls a device.
#include <chrono>
#include <cstdint>
#include <string>
#include <type_traits>

#include <fmt/format.h>

#include "nodes/console/printable.hpp"

namespace voxtouch::console {
namespace console_parts {

/// Strings may come from a file or a message: made printable. The format itself is a constant.
template <class T>
decltype(auto) sanitized(const T& value) {
  if constexpr (std::is_convertible_v<const T&, std::string_view>)
    return printable(value);
  else
    return (value);
}

/// fmt 10.1 and later take named values only.
template <class... Args>
std::string formatted(fmt::string_view format, const Args&... args) {
  return fmt::vformat(format, fmt::make_format_args(args...));
}

void post(std::string_view text) noexcept;
void post_progress(std::string_view text) noexcept;
void count_lost() noexcept;
void put(std::string_view text);

}  // namespace console_parts

/// Prints a text on stderr. Never throws, and never waits for the stream: a thread of ordinary
/// priority writes. If the stream is blocked (full disk, closed, a pipe or terminal without a
/// reader), the newest kLinesKept texts are queued and the others are counted. Not for real-time
/// threads: it allocates and locks.
template <class... Args>
void log(fmt::format_string<Args...> format, Args&&... args) noexcept {
  try {
    console_parts::post(console_parts::formatted(format, console_parts::sanitized(args)...));
  } catch (...) {
    console_parts::count_lost();
  }
}

/// Prints one line of progress on a terminal, in place of the previous one; any other text clears
/// it. Prints nothing if stderr is not a terminal. The text has no line feed. Never throws or
/// blocks. Not for real-time threads: it allocates and locks.
template <class... Args>
void show_progress(fmt::format_string<Args...> format, Args&&... args) noexcept {
  try {
    console_parts::post_progress(
        console_parts::formatted(format, console_parts::sanitized(args)...));
  } catch (...) {
    console_parts::count_lost();
  }
}

inline constexpr std::size_t kLinesKept = 1024;  ///< texts that wait for a slow stream
inline constexpr std::size_t kMaxTextBytes =
    16 * 1024;  ///< [bytes]; the rest of a longer text is cut off
/// How long the end of a process waits for a stream that takes nothing.
inline constexpr std::chrono::milliseconds kStopTimeout{500};

/// Whether stderr is systemd's journal, which stores all text: it receives changes, and no rates.
bool stderr_is_journal() noexcept;
/// Whether stderr is a terminal: progress is shown only there.
bool stderr_is_terminal() noexcept;

/// Texts of this process that no stream took, so far.
std::uint64_t texts_lost() noexcept;

/// Waits until all texts are written or lost, `patience` at most. `exit` does it; callers of
/// `_Exit` must call it.
void flush_log(std::chrono::milliseconds patience = kStopTimeout) noexcept;

/// Writes a result on stdout, after all earlier texts. Waits for the reader. Throws
/// std::runtime_error if it cannot be written, since a lost result is a failure.
template <class... Args>
void print_result(fmt::format_string<Args...> format, Args&&... args) {
  console_parts::put(console_parts::formatted(format, console_parts::sanitized(args)...));
}

/// Whether a result has been printed so far. Any thread.
bool has_results() noexcept;
/// Before a program that has printed results ends well; throws as `print_result`.
void finish_results();

/// First call of every main. Opens a closed standard stream to /dev/null: otherwise the next file
/// or socket would get its number and its output. A file at its size limit is an error, not a
/// signal.
void guard_standard_streams() noexcept;

}  // namespace voxtouch::console
