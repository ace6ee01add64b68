#include "tests/experiments/hostile_meshes/attempt.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include "tests/support/process/forked.hpp"

namespace voxtouch::hostile {
namespace {

void set_limit(decltype(RLIMIT_CPU) what, rlim_t soft, rlim_t hard) {
  const rlimit limit{soft, hard};
  ::setrlimit(what, &limit);
}

/// The forked half.
int run_child(const std::filesystem::path& file, const Limits& limits, int out) {
  set_limit(RLIMIT_CPU, limits.cpu_s, limits.cpu_s + 2);
  set_limit(RLIMIT_CORE, 0, 0);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  set_limit(RLIMIT_AS, limits.memory_mib << 20, limits.memory_mib << 20);
  // A sanitizer's report must be visible; other output of a reader is not needed.
  if (const int nothing = ::open("/dev/null", O_WRONLY); nothing >= 0)
    ::dup2(nothing, 1), ::dup2(nothing, 2);
#endif
  const Verdict verdict = touch(file, limits);
  const std::string text =
      std::to_string(static_cast<int>(verdict.outcome)) + ' ' + verdict.sentence;
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t n = ::write(out, text.data() + at, text.size() - at);
    if (n <= 0)
      break;
    at += static_cast<std::size_t>(n);
  }
  return 0;
}

/// Reads the child's output until it closes its end; false after a timeout.
bool listen(int in, std::chrono::seconds patience, std::string& text) {
  const auto end = std::chrono::steady_clock::now() + patience;
  std::array<char, 4096> buffer{};
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
                          end - std::chrono::steady_clock::now())
                          .count();
    if (left <= 0)
      return false;
    pollfd ready{in, POLLIN, 0};
    if (::poll(&ready, 1, static_cast<int>(left)) < 0 && errno != EINTR)
      return false;
    if (ready.revents == 0)
      continue;
    const ssize_t n = ::read(in, buffer.data(), buffer.size());
    if (n <= 0)
      return true;
    text.append(buffer.data(), static_cast<std::size_t>(n));
  }
}

}  // namespace

Verdict attempt(const std::filesystem::path& file, const Limits& limits) {
  int ends[2];
  if (::pipe(ends) != 0)
    throw std::runtime_error(std::string("no pipe: ") + std::strerror(errno));
  test::Forked child([&] {
    ::close(ends[0]);
    return run_child(file, limits, ends[1]);
  });
  ::close(ends[1]);
  std::string text;
  const bool heard_bytes = listen(ends[0], std::chrono::seconds(10 * limits.cpu_s), text);
  ::close(ends[0]);
  if (!heard_bytes)
    child.signal(SIGKILL);
  const auto [status, used] = child.wait();
  const int by_signal = status > 128 ? status - 128 : 0;

  Verdict verdict{
      .file = file, .outcome = Outcome::kCrashed, .sentence = {}, .cpu_s = 0.0, .peak_mib = 0};
  verdict.cpu_s = double(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
                  1e-6 * double(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
  verdict.peak_mib = static_cast<std::uint64_t>(used.ru_maxrss) >> 10;
  if (!heard_bytes || by_signal == SIGXCPU) {
    verdict.outcome = Outcome::kOutOfTime;
    verdict.sentence = "took more than " + std::to_string(limits.cpu_s) + " s";
  } else if (by_signal != 0) {
    verdict.sentence = std::string("ended by a signal (") + ::strsignal(by_signal) + ")";
  } else if (status != 0 || text.size() < 3) {
    verdict.sentence = "ended with status " + std::to_string(status) + " and without a word";
  } else {
    verdict.outcome = static_cast<Outcome>(text[0] - '0');
    verdict.sentence = text.substr(2);
  }
  return verdict;
}

}  // namespace voxtouch::hostile
