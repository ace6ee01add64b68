#include "nodes/view/bag_player.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "nodes/bag/bag_writer.hpp"
#include "tests/support/process/process.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::view {
namespace {

constexpr std::int64_t kYearNs = 365LL * 24 * 3600 * 1'000'000'000;

/// Samples of the device at these times.
std::filesystem::path bag_of(const test::TemporaryFolder& folder,
                             const std::vector<std::int64_t>& times_ns,
                             bag::Storage storage = bag::Storage::kMcap,
                             std::int64_t split_ns = 0) {
  const std::filesystem::path path = folder / "bag";
  auto writer = bag::BagWriter::create(path, {.storage = storage, .split = {.time_ns = split_ns}});
  EXPECT_TRUE(writer);
  const auto topic = writer->add_topic(
      {.name = "/haptic/device/state", .type = "voxtouch_msgs/msg/DeviceState", .offered_qos = ""});
  EXPECT_TRUE(topic);
  std::vector<std::byte> bytes(4 + sizeof(msg::DeviceState));
  bytes[1] = std::byte{1};
  for (const std::int64_t time_ns : times_ns)
    EXPECT_TRUE(writer->append(*topic, time_ns, bytes));
  EXPECT_TRUE(writer->close());
  return path;
}

/// Two seconds of samples; the clock steps after the first.
std::vector<std::int64_t> stepped_times(std::int64_t step_ns) {
  std::vector<std::int64_t> times_ns;
  for (std::int64_t n = 0; n < 200; ++n)
    times_ns.push_back(2 * kYearNs + n * 10'000'000 + (n < 100 ? 0 : step_ns));
  return times_ns;
}

struct Player {
  test::TemporaryFolder folder;
  bus::Participant participant{[] {
    bus::ParticipantOptions options;
    options.domain = static_cast<std::uint32_t>(std::stoul(test::fresh_domain()));
    return options;
  }()};
  Picture picture;
  Facts facts;
  NodeTable nodes;

  nlohmann::json play(BagPlayer& player) {
    for (int n = 0; n < 40; ++n)
      player.advance(0.1, picture, facts, nodes);
    return player.to_json();
  }
};

TEST(BagPlayer, SkipsAStepOfTheClockByAYear) {
  for (const std::int64_t step_ns : {kYearNs, -kYearNs}) {
    Player all;
    BagPlayer player(all.participant, bag_of(all.folder, stepped_times(step_ns)));
    EXPECT_NEAR(player.to_json()["duration"].get<double>(), 1.98, 1e-6);
    EXPECT_TRUE(player.note().contains("clock stepped")) << player.note();
    const auto end = all.play(player);
    EXPECT_EQ(end["t"], end["duration"]);
    EXPECT_FALSE(end["playing"].get<bool>());
    EXPECT_EQ(player.now_ns(), 2 * kYearNs + (step_ns > 0 ? step_ns + 1'990'000'000 : 990'000'000));
  }
}

TEST(BagPlayer, SkipsNothingInARunOfFiveMinutes) {
  Player all;
  std::vector<std::int64_t> times_ns;
  for (std::int64_t n = 0; n <= 3000; ++n)
    times_ns.push_back(n * 100'000'000);
  BagPlayer player(all.participant, bag_of(all.folder, times_ns));
  EXPECT_NEAR(player.to_json()["duration"].get<double>(), 300.0, 1e-6);
  EXPECT_EQ(player.note(), "");
}

TEST(BagPlayer, ReportsAMissingFileAsFailed) {
  Player all;
  const auto path = bag_of(all.folder, stepped_times(0), bag::Storage::kMcap, 1'000'000'000);
  std::ofstream(path / "voxtouch_run.json") << R"({"ok": true, "problems": []})";
  EXPECT_TRUE(BagPlayer(all.participant, path).to_json()["verdict"]["good"].get<bool>());
  ASSERT_TRUE(std::filesystem::remove(path / "bag_1.mcap"));
  const auto verdict = BagPlayer(all.participant, path).to_json()["verdict"];
  EXPECT_FALSE(verdict["good"].get<bool>());
  EXPECT_TRUE(verdict["problems"].dump().contains("100 messages are lost")) << verdict;
}

TEST(BagPlayer, ReportsADamagedFileAsFailed) {
  Player all;
  std::vector<std::int64_t> times_ns;
  for (std::int64_t n = 1; n <= 2000; ++n)
    times_ns.push_back(n * 1'000'000);
  const auto path = bag_of(all.folder, times_ns, bag::Storage::kSqlite3);
  std::ofstream(path / "voxtouch_run.json") << R"({"ok": true, "problems": []})";
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    if (entry.path().extension() != ".db3")
      continue;
    const auto size = static_cast<std::streamoff>(entry.file_size());
    std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(size / 4);
    file << std::string(static_cast<std::size_t>(size / 2), '\xff');
  }
  BagPlayer player(all.participant, path);
  const auto end = all.play(player);
  EXPECT_FALSE(end["verdict"]["good"].get<bool>());
  EXPECT_FALSE(end["verdict"]["problems"].empty());
  EXPECT_NE(player.note(), "");
}

}  // namespace
}  // namespace voxtouch::view
