// Nodes that `up` starts while it still looks whether the rig is free: nobody hears of them before
// they are told to begin.
#include <gtest/gtest.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <optional>
#include <string>

#include "nodes/runtime/node_registry.hpp"
#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds;

/// A node of the ring, held, and whoever listens in its rig.
class Held {
 public:
  explicit Held(const std::string& node)
      : participant_({static_cast<std::uint32_t>(std::stoul(domain_)), "lo", "onlooker"}),
        registry_(participant_, "haptic"),
        fifo_((folder_ / "word").string()),
        node_(node) {
    if (::mkfifo(fifo_.c_str(), 0600) != 0)
      throw std::runtime_error("no fifo");
    const std::string scene = node == "logger" ? "--bag " + (folder_ / "bag").string()
                                               : "--scene " + shipped_scene("plane");
    process_.emplace(std::vector<std::string>{"/bin/sh", "-c",
                                              "exec " + std::string(VOXTOUCH_BIN) + "/voxtouch_" +
                                                  node + " " + scene + " --held --domain " +
                                                  domain_ + " < " + fifo_});
    word_ = ::open(fifo_.c_str(), O_WRONLY | O_CLOEXEC);  // waits for the reader
  }
  ~Held() { hang_up(); }

  /// Whether the rig hears of it within that time.
  bool is_heard(milliseconds patience) {
    return runtime::look_for(
               registry_,
               [this](const runtime::NodeReport& report) { return report.node == node_; }, patience)
        .has_value();
  }
  void let_begin() const { ASSERT_EQ(::write(word_, "b", 1), 1); }
  void hang_up() {
    if (word_ >= 0)
      ::close(word_);
    word_ = -1;
  }
  Process& process() { return *process_; }

 private:
  TemporaryFolder folder_;
  std::string domain_ = fresh_domain();
  bus::Participant participant_;
  runtime::NodeRegistry registry_;
  std::string fifo_, node_;
  std::optional<Process> process_;
  int word_ = -1;
};

class HeldNode : public testing::TestWithParam<const char*> {};

TEST_P(HeldNode, JoinsTheRigWhenItIsToldAndNotBefore) {
  Held held(GetParam());
  EXPECT_FALSE(held.is_heard(milliseconds(800)));
  ASSERT_TRUE(held.process().running()) << held.process().err();
  held.let_begin();
  held.hang_up();
  EXPECT_TRUE(held.is_heard(milliseconds(30'000))) << held.process().err();
  held.process().signal(SIGTERM);
  EXPECT_EQ(held.process().wait().status, 0);
}

TEST_P(HeldNode, LeavesWithoutAWordWhereItsStarterGoes) {
  Held held(GetParam());
  held.hang_up();
  const Finished end = held.process().wait();
  EXPECT_EQ(end.status, 0);
  EXPECT_EQ(end.err, "");
  EXPECT_FALSE(held.is_heard(milliseconds(100)));
}

TEST_P(HeldNode, LeavesWhereItIsStopped) {
  Held held(GetParam());
  held.process().signal(SIGTERM);
  const Finished end = held.process().wait();
  EXPECT_TRUE(end.status == 0 || end.status == 128 + SIGTERM)
      << end.status;  // the latter before it could listen
  EXPECT_EQ(end.err, "");
}

INSTANTIATE_TEST_SUITE_P(EachNode, HeldNode,
                         testing::Values("logger", "validator", "coupling", "rendering", "device"),
                         [](const auto& node) { return std::string(node.param); });

}  // namespace
}  // namespace voxtouch::test
