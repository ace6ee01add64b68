#include "nodes/runtime/held_start.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

namespace voxtouch::runtime {
namespace {

Word& word() noexcept {
  static Word said = Word::kBegin;
  return said;
}

bool& held() noexcept {
  static bool said = false;
  return said;
}

void close_fd(int& fd) noexcept {
  if (fd >= 0)
    ::close(fd);
  fd = -1;
}

/// Waits so long for a word, where none was said yet.
Word listen(int timeout_ms) noexcept {
  if (word() != Word::kNone)
    return word();
  pollfd input{STDIN_FILENO, POLLIN, 0};
  const int ready = ::poll(&input, 1, timeout_ms);
  if (ready == 0 || (ready < 0 && errno == EINTR))
    return Word::kNone;
  char said = 0;
  const ssize_t count = ready < 0 ? -1 : ::read(STDIN_FILENO, &said, 1);
  if (count < 0 && (errno == EINTR || errno == EAGAIN))
    return Word::kNone;
  return word() = count == 1 ? Word::kBegin : Word::kLeave;
}

}  // namespace

void be_held() noexcept { word() = Word::kNone, held() = true; }

bool was_held() noexcept { return held(); }

Word word_of_starter() noexcept { return listen(0); }

bool may_begin(const std::atomic<bool>& stop) noexcept {
  constexpr int kLookMs = 20;
  while (!stop.load()) {
    const Word said = listen(kLookMs);
    if (said != Word::kNone)
      return said == Word::kBegin;
  }
  return false;
}

Starter Starter::make() {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    throw std::runtime_error(std::string("no pipe could be made to start a node (") +
                             std::strerror(errno) + ")");
  Starter out;
  out.input_ = ends[0], out.output_ = ends[1];
  return out;
}

Starter::Starter(Starter&& other) noexcept
    : input_(std::exchange(other.input_, -1)),
      output_(std::exchange(other.output_, -1)) {}

Starter::~Starter() { close_fd(input_), close_fd(output_); }

void Starter::close_input() noexcept { close_fd(input_); }

void Starter::let_begin() noexcept {
  if (output_ >= 0)
    (void)!::write(output_, "b", 1);  // SIGPIPE is ignored
  close_fd(output_);
}

}  // namespace voxtouch::runtime
