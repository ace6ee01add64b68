#include "nodes/console/log.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <thread>

#include <spdlog/async_logger.h>
#include <spdlog/details/thread_pool.h>
#include <spdlog/sinks/sink.h>

namespace voxtouch::console {
namespace {

std::atomic<std::uint64_t> posted{0}, handled{0}, lost{0};
std::atomic<bool> results_begun{false};
std::atomic<bool> progress_shown{false};

/// Level of a line of progress; all other texts have `info`.
constexpr auto kProgress = spdlog::level::debug;
constexpr std::string_view kClearLine = "\r\033[K";

/// Returns false if the stream does not accept more. May block: only the writing thread calls it.
bool write_all(std::string_view text) noexcept {
  while (!text.empty()) {
    const ssize_t n = ::write(STDERR_FILENO, text.data(), text.size());
    if (n > 0) {
      text.remove_prefix(static_cast<std::size_t>(n));
    } else if (n < 0 && errno == EAGAIN) {  // another process made it non-blocking
      pollfd stream{STDERR_FILENO, POLLOUT, 0};
      if (::poll(&stream, 1, -1) < 0 || (stream.revents & (POLLERR | POLLNVAL)))
        return false;
    } else if (n == 0 || errno != EINTR) {
      return false;
    }
  }
  return true;
}

/// spdlog's sinks write through stdio. `exit` takes its lock and would wait for a blocked writer.
class StderrSink final : public spdlog::sinks::sink {
 public:
  explicit StderrSink(std::weak_ptr<spdlog::details::thread_pool> pool) : pool_(std::move(pool)) {}
  void log(const spdlog::details::log_msg& message) override {
    log_gap();
    // The cursor stays at the begin of a line of progress: other processes write over it.
    const bool progress = message.level == kProgress;
    if (progress_line_ || progress)
      write_all(kClearLine);
    progress_line_ = progress;
    if (!write_all({message.payload.data(), message.payload.size()}))
      lost.fetch_add(1);
    handled.fetch_add(1, std::memory_order_release);
  }
  void flush() override {}
  void set_pattern(const std::string&) override {}  // plain sentences
  void set_formatter(std::unique_ptr<spdlog::formatter>) override {}

 private:
  void log_gap() {
    const auto pool = pool_.lock();
    const std::size_t overrun = pool ? pool->overrun_counter() : 0;
    if (overrun == logged_overrun_)
      return;
    write_all(fmt::format("({} lines skipped: stderr was blocked)\n", overrun - logged_overrun_));
    logged_overrun_ = overrun;
  }
  std::weak_ptr<spdlog::details::thread_pool> pool_;
  std::size_t logged_overrun_ = 0;
  bool progress_line_ = false;  ///< the last text was one of progress
};

void enter_writing_thread() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(
      SIG_SETMASK, &all,
      nullptr);  // none of the signals of a write (SIGPIPE, SIGXFSZ, SIGTTOU) may end or stop us
  const sched_param ordinary{};
  sched_setscheduler(0, SCHED_OTHER, &ordinary);  // the creator may run under SCHED_FIFO
}

struct Log {
  std::shared_ptr<spdlog::details::thread_pool> pool =
      std::make_shared<spdlog::details::thread_pool>(kLinesKept, 1, enter_writing_thread);
  std::shared_ptr<spdlog::async_logger> logger =
      std::make_shared<spdlog::async_logger>("stderr", std::make_shared<StderrSink>(pool), pool,
                                             spdlog::async_overflow_policy::overrun_oldest);
  Log() {
    logger->set_level(kProgress);
    logger->set_error_handler([](const std::string&) { count(); });
    std::atexit([] { clear_progress(), flush_log(); });
  }
  static void count() { lost.fetch_add(1), handled.fetch_add(1); }
  static void clear_progress() {
    if (progress_shown.exchange(false))
      console_parts::post("");
  }
};

/// Created with the first text and never destroyed: a stream may block its thread for ever, and
/// `exit` must not wait for it.
Log& the_log() {
  static Log* const log = new Log;
  return *log;
}

std::uint64_t overrun() { return the_log().pool->overrun_counter(); }

}  // namespace

namespace console_parts {

void post(std::string_view text) noexcept {
  try {
    Log& log = the_log();
    const std::string cut =
        text.size() <= kMaxTextBytes ? "" : std::string(text.substr(0, kMaxTextBytes)) + "...\n";
    if (!cut.empty())
      text = cut;
    posted.fetch_add(1);
    log.logger->log(spdlog::level::info, spdlog::string_view_t(text.data(), text.size()));
  } catch (const std::system_error&) {  // the system refuses the thread that writes
    if (::write(STDERR_FILENO, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
      count_lost();
  } catch (...) {
    count_lost();  // no memory
  }
}

void count_lost() noexcept { lost.fetch_add(1); }

void post_progress(std::string_view text) noexcept {
  if (!stderr_is_terminal())
    return;
  try {
    Log& log = the_log();
    posted.fetch_add(1);
    progress_shown = true;
    log.logger->log(kProgress, fmt::format("{}\r", text));
  } catch (...) {
    count_lost();
  }
}

void put(std::string_view text) {
  Log::clear_progress();
  flush_log();
  results_begun = true;
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size())
    finish_results();
}

}  // namespace console_parts

bool stderr_is_journal() noexcept {
  const char* const named = std::getenv(
      "JOURNAL_STREAM");  // device:inode, which a child with another stderr inherits too
  struct stat stream {};
  unsigned long long device = 0, inode = 0;
  return named && std::sscanf(named, "%llu:%llu", &device, &inode) == 2 &&
         fstat(STDERR_FILENO, &stream) == 0 && stream.st_dev == device && stream.st_ino == inode;
}

bool stderr_is_terminal() noexcept { return ::isatty(STDERR_FILENO) == 1; }

std::uint64_t texts_lost() noexcept {
  try {
    return lost.load() + (posted.load() > 0 ? overrun() : 0);
  } catch (...) {
    return lost.load();
  }
}

void flush_log(std::chrono::milliseconds patience) noexcept {
  try {
    static std::atomic<std::uint64_t> stuck_at{
        ~std::uint64_t{0}};  // `handled` when patience ended: it is not spent twice on one text
    const std::uint64_t requested = posted.load();
    const auto until = std::chrono::steady_clock::now() + patience;
    while (requested > 0 && handled.load(std::memory_order_acquire) + overrun() < requested &&
           handled.load() != stuck_at.load()) {
      if (std::chrono::steady_clock::now() >= until)
        return stuck_at.store(handled.load());
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  } catch (...) {  // no memory: the text is lost
  }
}

bool has_results() noexcept { return results_begun; }

void finish_results() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout))
    throw std::runtime_error("cannot write to standard output; check the free disk space");
}

void guard_standard_streams() noexcept {
  for (int fd = 0; fd <= STDERR_FILENO; ++fd)
    if (::fcntl(fd, F_GETFD) < 0 && errno == EBADF)
      (void)!::open("/dev/null", O_RDONLY);  // takes the lowest free number
  ::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace voxtouch::console
