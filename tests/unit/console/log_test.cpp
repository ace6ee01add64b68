// A log call never blocks or ends its caller, whatever stderr is.
#include "nodes/console/log.hpp"

#include "nodes/console/progress.hpp"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <pty.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <functional>
#include <thread>

#include "tests/support/process/forked.hpp"

namespace voxtouch::console {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// Runs `reported` in a separate process with stderr `fd` (-1: closed). The log exists once per
/// process and as long.
int in_a_process_with_stderr(int fd, const std::function<void()>& reported) {
  test::Forked child([&]() -> int {
    alarm(20);  // a call that blocks is a death by signal 14
    if (fd >= 0)
      dup2(fd, STDERR_FILENO);
    else
      close(STDERR_FILENO);
    reported();
    std::exit(testing::Test::HasFailure()
                  ? 99
                  : 7);  // not _exit: the log writes its last lines at the end
  });
  return child.wait().status;
}

std::string drain(int fd) {
  fcntl(fd, F_SETFL, O_NONBLOCK);
  std::string all;
  char part[65536];
  for (ssize_t n; (n = read(fd, part, sizeof part)) > 0;)
    all.append(part, static_cast<std::size_t>(n));
  return all;
}

struct Pipe {
  Pipe() { EXPECT_EQ(pipe(end), 0); }
  ~Pipe() { close(end[0]), close(end[1]); }
  int end[2] = {-1, -1};
};

TEST(Log, WritesItsTextsInOrderByProcessEnd) {
  const Pipe pipe;
  EXPECT_EQ(in_a_process_with_stderr(pipe.end[1],
                                     [] {
                                       log("{} of {:.2f} N\n", "force", 1.5);
                                       log("\r[{:>3}]", 7);
                                       log("{}\n", std::string("two\nlines, Größe"));
                                     }),
            7);
  EXPECT_EQ(drain(pipe.end[0]), "force of 1.50 N\n\r[  7]two\nlines, Größe\n");
}

TEST(Log, MakesStringsPrintableAndLeavesItsFormatAlone) {
  const Pipe pipe;
  const std::string foreign = "\x1b]0;owned\a";
  EXPECT_EQ(
      in_a_process_with_stderr(
          pipe.end[1],
          [&] { log("\x1b[1m{}|{}|{}\n", foreign, foreign.c_str(), std::string_view(foreign)); }),
      7);
  EXPECT_EQ(drain(pipe.end[0]), "\x1b[1m?]0;owned?|?]0;owned?|?]0;owned?\n");
}

TEST(Log, DetectsTheJournalByItsStream) {
  const Pipe journal, other;
  struct stat stream {};
  ASSERT_EQ(fstat(journal.end[1], &stream), 0);
  const std::string named = std::to_string(stream.st_dev) + ":" + std::to_string(stream.st_ino);
  const auto reported = [&] {
    setenv("JOURNAL_STREAM", named.c_str(), 1);
    std::_Exit(stderr_is_journal() ? 1 : 2);
  };
  EXPECT_EQ(in_a_process_with_stderr(journal.end[1], reported), 1);
  EXPECT_EQ(in_a_process_with_stderr(other.end[1], reported), 2);
}

TEST(Log, CutsAnOverlongText) {
  const Pipe pipe;
  EXPECT_EQ(in_a_process_with_stderr(pipe.end[1], [] { log("{}\n", std::string(50'000, 'x')); }),
            7);
  EXPECT_EQ(drain(pipe.end[0]), std::string(kMaxTextBytes, 'x') + "...\n");
}

void log_much_and_expect_no_wait() {
  const auto begin = steady_clock::now();
  for (int i = 0; i < 20'000; ++i)
    log("line {} that none reads, of some sixty characters and a bit\n", i);
  flush_log();
  EXPECT_LT(steady_clock::now() - begin, milliseconds(10'000));
}

TEST(Log, CountsTextsLostToAFullDisk) {
  const int full = open("/dev/full", O_WRONLY);
  EXPECT_EQ(in_a_process_with_stderr(full,
                                     [] {
                                       log_much_and_expect_no_wait();
                                       EXPECT_EQ(texts_lost(), 20'000U);
                                     }),
            7);
  close(full);
}

TEST(Log, CountsTextsLostToAClosedStream) {
  EXPECT_EQ(in_a_process_with_stderr(-1,
                                     [] {
                                       guard_standard_streams();
                                       log_much_and_expect_no_wait();
                                       EXPECT_EQ(texts_lost(), 20'000U);
                                     }),
            7);
  Pipe pipe;  // its reader has ended; SIGPIPE has its default action
  close(pipe.end[0]);
  EXPECT_EQ(in_a_process_with_stderr(pipe.end[1],
                                     [&] {
                                       close(pipe.end[0]);
                                       log_much_and_expect_no_wait();
                                       EXPECT_EQ(texts_lost(), 20'000U);
                                     }),
            7);
  pipe.end[0] = -1;
}

TEST(Log, NeverWaitsForAnUnreadPipe) {
  const Pipe pipe;
  EXPECT_EQ(in_a_process_with_stderr(pipe.end[1],
                                     [] {
                                       log_much_and_expect_no_wait();
                                       EXPECT_GT(texts_lost(), 10'000U);
                                     }),
            7);
}

TEST(Log, KeepsTheNewestTextsAndCountsTheLost) {
  const Pipe pipe;
  std::string all = "\n";
  EXPECT_EQ(in_a_process_with_stderr(
                pipe.end[1],
                [&] {
                  log_much_and_expect_no_wait();
                  for (int i = 0; i < 200 && all.find("line 19999 ") == std::string::npos; ++i) {
                    all += drain(pipe.end[0]);
                    std::this_thread::sleep_for(milliseconds(10));
                  }
                  EXPECT_NE(all.find("line 19999 "), std::string::npos);
                  std::uint64_t missing = 0;  // one gap or several
                  for (std::size_t at = 0; (at = all.find("\n(", at)) != std::string::npos; ++at)
                    missing += std::strtoull(all.c_str() + at + 2, nullptr, 10);
                  EXPECT_NE(all.find(" lines skipped"), std::string::npos);
                  EXPECT_EQ(missing, texts_lost());
                }),
            7);
}

TEST(Log, IsNotMixedIntoAFileOpenedAfterStderrClosed) {
  EXPECT_EQ(in_a_process_with_stderr(-1,
                                     [] {
                                       close(STDIN_FILENO), close(STDOUT_FILENO);
                                       guard_standard_streams();
                                       const int file = memfd_create("bag", 0);
                                       if (file <= STDERR_FILENO)
                                         std::exit(98);
                                       log("into a bag?\n");
                                       flush_log();
                                       if (lseek(file, 0, SEEK_END) != 0)
                                         std::exit(97);
                                     }),
            7);
}

void show_steps_for(milliseconds time) {
  const auto step = log_each_second("rendering");
  const auto begin = steady_clock::now();
  while (steady_clock::now() - begin < time)
    step("reading mesh 2 of 3");
}

/// A terminal that forwards its input byte for byte.
struct Terminal {
  Terminal() {
    EXPECT_EQ(openpty(&outer, &inner, nullptr, nullptr, nullptr), 0);
    termios raw{};
    tcgetattr(inner, &raw);
    cfmakeraw(&raw);
    tcsetattr(inner, TCSANOW, &raw);
  }
  ~Terminal() { close(outer), close(inner); }
  int outer = -1, inner = -1;
};

TEST(Progress, IsSilentInAPipe) {
  const Pipe pipe;
  EXPECT_EQ(in_a_process_with_stderr(pipe.end[1],
                                     [] {
                                       show_steps_for(milliseconds(1200));
                                       show_progress("voxmap: {} %", 40);
                                       log("ready\n");
                                     }),
            7);
  EXPECT_EQ(drain(pipe.end[0]), "ready\n");
}

TEST(Progress, IsShownOnATerminalAfterTheFirstSecond) {
  const Terminal terminal;
  EXPECT_EQ(in_a_process_with_stderr(terminal.inner, [] { show_steps_for(milliseconds(1200)); }),
            7);
  EXPECT_EQ(drain(terminal.outer), "\r\033[Krendering: reading mesh 2 of 3\r\r\033[K");
}

TEST(Progress, IsOneLineThatOtherTextsClear) {
  const Terminal terminal;
  EXPECT_EQ(in_a_process_with_stderr(terminal.inner,
                                     [] {
                                       show_progress("voxmap: {} %", 40);
                                       show_progress("voxmap: {} %", 80);
                                       log("ready\n");
                                       log("running\n");
                                     }),
            7);
  EXPECT_EQ(drain(terminal.outer),
            "\r\033[Kvoxmap: 40 %\r\r\033[Kvoxmap: 80 %\r\r\033[Kready\nrunning\n");
}

TEST(PrintResult, ThrowsIfItCannotWrite) {
  EXPECT_EQ(in_a_process_with_stderr(STDERR_FILENO,
                                     [] {
                                       const int full = open("/dev/full", O_WRONLY);
                                       dup2(full, STDOUT_FILENO);
                                       const auto result = [] {
                                         print_result("{}\n", "a result");
                                         finish_results();
                                       };
                                       try {
                                         result();
                                         std::_Exit(96);
                                       } catch (const std::runtime_error&) {
                                         std::_Exit(7);
                                       }
                                     }),
            7);
}

}  // namespace
}  // namespace voxtouch::console
