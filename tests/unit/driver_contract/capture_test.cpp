// A session of driver and controller in the driver's capture, read by a decoder that has no code in
// common with either.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/process/process.hpp"
#include "tests/unit/driver_contract/subject.hpp"

namespace voxtouch::contract {
namespace {

using nlohmann::json;

struct Packets {
  std::vector<json> measurements, commands, all;
};

Packets capture(const test::TemporaryFolder& folder, int periods) {
  const std::string file = folder / "session.pcap";
  {
    const auto subject = lwr(true, file);
    subject->open();
    for (int i = 0; i < periods; ++i) {
      const auto t = subject->cycle(subject->usual_push());
      EXPECT_TRUE(t.sample && t.written) << i;
    }
    subject->close();
  }
  test::Process decoder({VOXTOUCH_PYTHON, "-B", VOXTOUCH_DECODE_FRI, file});
  const test::Finished end = decoder.wait(std::chrono::seconds(30));
  EXPECT_EQ(end.status, 0) << end.err;
  Packets packets;
  std::istringstream lines(end.out);
  for (std::string line; std::getline(lines, line);) {
    const json packet = json::parse(line);
    // In virtual time the controller repeats what is not answered soon, for example on a busy
    // machine.
    if (packet["kind"] == "MSR" && !packets.measurements.empty() &&
        packet["sendSeqCount"] == packets.measurements.back()["sendSeqCount"])
      continue;
    packets.all.push_back(packet);
    (packets.all.back()["kind"] == "MSR" ? packets.measurements : packets.commands)
        .push_back(packets.all.back());
  }
  return packets;
}

double largest(const json& values) {
  double most = 0.0;
  for (const json& v : values)
    most = std::max(most, std::abs(v.get<double>()));
  return most;
}

class FriSessionCapture : public testing::Test {
 protected:
  static void SetUpTestSuite() { packets = new Packets(capture(test::TemporaryFolder(), 400)); }
  static void TearDownTestSuite() { delete packets; }
  static Packets* packets;
};
Packets* FriSessionCapture::packets = nullptr;

TEST_F(FriSessionCapture, CountsWithoutAGapOnBothSides) {
  ASSERT_GT(packets->measurements.size(), 400u);
  ASSERT_GT(packets->commands.size(), 400u);
  for (const auto* side : {&packets->measurements, &packets->commands})
    for (std::size_t i = 1; i < side->size(); ++i)
      ASSERT_EQ((*side)[i]["sendSeqCount"].get<int>(),
                ((*side)[i - 1]["sendSeqCount"].get<int>() + 1) % 65536)
          << i;
}

TEST_F(FriSessionCapture, EveryAnswerReflectsItsMeasurement) {
  const json* open = nullptr;  // the measurement that waits
  std::size_t answered = 0;
  for (const json& packet : packets->all) {
    if (packet["kind"] == "MSR") {
      open = &packet;
      continue;
    }
    ASSERT_NE(open, nullptr) << "an answer to nothing";
    EXPECT_EQ(packet["reflSeqCount"], (*open)["sendSeqCount"]);
    open = nullptr;
    ++answered;
  }
  EXPECT_GE(answered + 1, packets->measurements.size()) << "the last one may be friClose's";
  // And the controller reports in the next measurement that it took it.
  for (std::size_t i = 1; i < packets->commands.size() && i < packets->measurements.size(); ++i)
    EXPECT_EQ(packets->measurements[i]["reflSeqCount"], packets->commands[i - 1]["sendSeqCount"])
        << i;
}

TEST_F(FriSessionCapture, WalksFromMonitorToCommandModeAndBack) {
  std::vector<int> states;
  for (const json& msr : packets->measurements)
    if (states.empty() || states.back() != msr["state"])
      states.push_back(msr["state"]);
  EXPECT_EQ(states, (std::vector<int>{1, 2, 1}));
  const json* msr = nullptr;
  int pushed = 0, mirrored = 0;
  for (const json& packet : packets->all) {
    if (packet["kind"] == "MSR") {
      msr = &packet;
      continue;
    }
    EXPECT_EQ(packet["cmdFlags"], packets->commands.front()["cmdFlags"]);
    if ((*msr)["state"] == 2) {
      pushed += largest(packet["addJntTrq"]) > 0.1;
      continue;
    }
    ++mirrored;
    EXPECT_EQ(largest(packet["addJntTrq"]), 0.0) << "no push outside command mode";
    for (int i = 0; i < 7; ++i)
      EXPECT_NEAR(
          packet["jntPos"][i].get<double>(),
          (*msr)["cmdJntPos"][i].get<double>() + (*msr)["cmdJntPosFriOffset"][i].get<double>(),
          1e-6);
  }
  EXPECT_GE(pushed, 399);
  EXPECT_GT(mirrored, 50);
  EXPECT_EQ(packets->commands.back()["krlInt"][1], 0)
      << "it asks the program to stop before it goes";
  EXPECT_EQ(largest(packets->commands.back()["addJntTrq"]), 0.0);
}

}  // namespace
}  // namespace voxtouch::contract
