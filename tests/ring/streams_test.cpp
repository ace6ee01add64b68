// `voxtouch up` with blocked stderr or stdout: the run passes as usual, and a lost result is a
// failure.
#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>

#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

/// `up` under a shell with `redirection`.
RingResult run_redirected(const std::string& redirection, const std::vector<std::string>& more,
                          const std::string& first = "") {
  std::vector<std::string> arguments = {"/bin/sh", "-c", first + "exec \"$@\" " + redirection,
                                        "sh"};
  std::vector<std::string> run = {"--motion", "free", "--duration", "1", "--lockstep"};
  if (std::find(more.begin(), more.end(), "--record") == more.end())
    run.push_back("--no-record");
  run.insert(run.end(), more.begin(), more.end());
  const std::vector<std::string> up = up_arguments(shipped_scene("plane"), run);
  arguments.insert(arguments.end(), up.begin(), up.end());
  Process process(arguments);
  RingResult result{process.wait(std::chrono::seconds(60)), {}};
  result.summary = parse_summary(result.process.out);
  return result;
}

/// Every node's last status reached `up`: these figures have no other source.
void expect_a_good_run(const RingResult& r) {
  ASSERT_EQ(r.process.status, 0) << r.process.out << r.process.err;
  ASSERT_TRUE(r.summary.is_object()) << r.process.out;
  EXPECT_EQ(r.summary["ok"], true);
  EXPECT_EQ(r.summary["samples"], 1000);
  EXPECT_EQ(r.summary["validator"]["checked"], 50);
  EXPECT_NE(r.summary["coupling"]["kind"], "");
}

class Streams : public testing::TestWithParam<bool> {
 protected:
  std::vector<std::string> more() const {
    return GetParam() ? std::vector<std::string>{"--one-process"} : std::vector<std::string>{};
  }
  const TemporaryFolder folder_;
};

TEST_P(Streams, OnAFullDisk) { expect_a_good_run(run_redirected("2>/dev/full", more())); }

TEST_P(Streams, Closed) { expect_a_good_run(run_redirected("2>&- </dev/null", more())); }

TEST_P(Streams, InAFileAtItsSizeLimit) {
  const std::string log = (folder_ / "log").string();
  const int file = open(log.c_str(), O_WRONLY | O_CREAT, 0600);
  ASSERT_EQ(ftruncate(file, 1 << 20), 0);
  close(file);
  expect_a_good_run(
      run_redirected("2>>" + log, more(), "ulimit -f 2048; "));  // of 512 bytes: 1 MiB
  EXPECT_EQ(std::filesystem::file_size(log), 1U << 20);
}

TEST_P(Streams, AsAPipeWithoutAReader) {
  const std::string fifo = (folder_ / "fifo").string();
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  const int end = open(fifo.c_str(), O_RDWR | O_NONBLOCK);
  const std::string much(4096, 'x');
  while (write(end, much.data(), much.size()) > 0) {
  }
  while (write(end, "x", 1) > 0) {
  }
  expect_a_good_run(run_redirected("2<>" + fifo, more()));
  close(end);
}

INSTANTIATE_TEST_SUITE_P(Stderr, Streams, testing::Bool(), [](const auto& kind) {
  return kind.param ? "in_one_process" : "in_processes";
});

/// The bag's disk is full after 64 KiB, a third of the bag: the ring continues, missing messages
/// are counted, and the run fails.
TEST(Bag, FullDiskIsCountedAndFailsTheRun) {
  const TemporaryFolder folder;
  const std::string path = (folder / "bag").string();
  for (const char* redirection : {"", "2>/dev/full"}) {
    std::filesystem::remove_all(path);
    const RingResult r = run_redirected(redirection, {"--record", path}, "ulimit -f 128; ");
    EXPECT_EQ(r.process.status, 1) << r.process.err;
    ASSERT_TRUE(r.summary.is_object()) << r.process.out << r.process.err;
    EXPECT_EQ(r.summary["ok"], false);
    EXPECT_EQ(r.summary["samples"], 1000);
    const std::uint64_t written = r.summary["recording"]["written"],
                        dropped = r.summary["recording"]["dropped"];
    EXPECT_GT(written, 0U);
    EXPECT_GT(dropped, 500U);
    const auto bag = bag::WholeBag::open(path);
    ASSERT_TRUE(bag) << bag.error().sentence;
    std::uint64_t kept = 0;
    for (const auto& topic : bag->topics())
      kept += topic.message_count;
    EXPECT_EQ(kept, written);
  }
}

TEST(Stdout, UnwritableSummaryFails) {
  for (const char* redirection : {">/dev/full", ">&-"}) {
    const RingResult r = run_redirected(redirection, {});
    EXPECT_EQ(r.process.status, 1) << redirection << r.process.err;
    EXPECT_NE(r.process.err.find("standard output"), std::string::npos) << r.process.err;
  }
}

TEST(Stdout, UnwritableHelpFails) {
  for (const char* program : {"voxtouch", "voxtouch_device"}) {
    const std::string help = std::string("exec " VOXTOUCH_BIN "/") + program + " --help";
    EXPECT_EQ(Process({"/bin/sh", "-c", help}).wait().status, 0);
    EXPECT_EQ(Process({"/bin/sh", "-c", help + " >/dev/full"}).wait().status, 1);
    EXPECT_EQ(Process({"/bin/sh", "-c", help + " 2>/dev/full"}).wait().status, 0);
    EXPECT_NE(Process({"/bin/sh", "-c", help + "less 2>/dev/full"}).wait().status, 0);
  }
}

}  // namespace
}  // namespace voxtouch::test
