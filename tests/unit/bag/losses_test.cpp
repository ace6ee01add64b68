// Lost recorded data: the recorder counts it, and the reader reports it.
#include <fstream>

#include "nodes/bag/bag_reader.hpp"
#include "nodes/bag/bag_writer.hpp"
#include "tests/unit/bag/support.hpp"

namespace voxtouch::bag::losses_cases {
namespace {

using namespace test;
namespace fs = std::filesystem;

const TopicInfo kState{"/haptic/device/state", "voxtouch_msgs/msg/DeviceState", "cdr", "", 0};
constexpr std::int64_t kMs = 1'000'000;

class Losses : public testing::TestWithParam<Storage> {
 protected:
  fs::path file(int number) const {
    return folder / "run" /
           ("run_" + std::to_string(number) + std::string(names_of(GetParam()).extension));
  }
  BagWriter writer(const SplitOptions& split = {}) const {
    return expect_value(BagWriter::create(folder / "run", {.storage = GetParam(), .split = split}));
  }
  static void append(BagWriter& to, TopicId topic, std::uint64_t from, std::uint64_t count) {
    for (std::uint64_t i = from; i < from + count; ++i) {
      EXPECT_GOOD(to.append(topic, static_cast<std::int64_t>(i) * kMs, noisy_message(9, i, 1000)));
      if (i % 10 == 9)
        EXPECT_GOOD(to.commit());
    }
  }
  void record(std::uint64_t count, const SplitOptions& split = {}) const {
    BagWriter to = writer(split);
    const TopicId topic = expect_value(to.add_topic(kState));
    append(to, topic, 0, count);
    EXPECT_GOOD(to.close());
  }
  BagReader bag() const { return expect_value(BagReader::open(folder / "run")); }
  static TopicReport counts(const BagWriter& of) {
    std::vector<TopicReport> all(1);
    of.fill_counts(all);
    return all.front();
  }
  TemporaryFolder folder;
};
INSTANTIATE_TEST_SUITE_P(Storages, Losses, testing::Values(Storage::kSqlite3, Storage::kMcap),
                         [](const auto& storage) {
                           return std::string(names_of(storage.param).name);
                         });

TEST_P(Losses, AreNoneInAWholeBag) {
  record(100, {.time_ns = 30 * kMs});
  EXPECT_EQ(bag().losses(), std::vector<std::string>{});
  EXPECT_EQ(bag().message_count(), 100U);
}

TEST_P(Losses, NameAMissingFileOfASplitBag) {
  record(100, {.time_ns = 30 * kMs});
  fs::remove(file(1));
  ASSERT_EQ(bag().losses().size(), 1U);
  EXPECT_NE(bag().losses().front().find("30 messages"), std::string::npos)
      << bag().losses().front();
  EXPECT_EQ(bag().message_count(), 70U);
}

TEST_P(Losses, AreNoneForARenamedFile) {
  record(100);
  fs::rename(file(0), file(0).parent_path() / ("other" + file(0).extension().string()));
  EXPECT_EQ(bag().losses(), std::vector<std::string>{});
}

TEST_P(Losses, AreNoneIfMetadataIsBehindTheFiles) {
  record(100);
  std::ifstream in(folder / "run/metadata.yaml");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  for (std::size_t at = 0; (at = text.find(" 100", at)) != text.npos;)
    text.replace(at, 4, " 40");
  std::ofstream(folder / "run/metadata.yaml") << text;
  EXPECT_EQ(bag().losses(), std::vector<std::string>{});
}

TEST(LossesOfMcap, NameAFileCutToHalf) {
  const TemporaryFolder folder;
  {
    BagWriter to = expect_value(BagWriter::create(folder / "run", {}));
    const TopicId topic = expect_value(to.add_topic(kState));
    for (std::uint64_t i = 0; i < 100; ++i) {
      EXPECT_GOOD(to.append(topic, static_cast<std::int64_t>(i) * kMs, noisy_message(9, i, 1000)));
      EXPECT_GOOD(to.commit());
    }
    EXPECT_GOOD(to.close());
  }
  fs::resize_file(folder / "run/run_0.mcap", fs::file_size(folder / "run/run_0.mcap") / 2);
  const BagReader bag = expect_value(BagReader::open(folder / "run"));
  ASSERT_EQ(bag.losses().size(), 1U);
  EXPECT_NE(bag.losses().front().find("of 100 recorded"), std::string::npos)
      << bag.losses().front();
  EXPECT_GT(bag.message_count(), 30U);
  EXPECT_LT(bag.message_count(), 60U);
}

TEST_P(Losses, WhileRecordingAreCountedAndTheBagGoesOn) {
  BagWriter to = writer();
  const TopicId topic = expect_value(to.add_topic(kState));
  append(to, topic, 0, 50);
  fs::remove(file(0));
  EXPECT_TRUE(says(to.refresh(), "50 messages are lost"));
  EXPECT_EQ(counts(to).lost, 50U);
  EXPECT_EQ(counts(to).written, 0U);
  append(to, topic, 50, 20);
  EXPECT_GOOD(to.close());
  EXPECT_EQ(counts(to).lost, 50U);
  EXPECT_EQ(counts(to).written, 20U);
  EXPECT_EQ(bag().message_count(), 20U);
  EXPECT_EQ(bag().losses(), std::vector<std::string>{});
}

TEST_P(Losses, OfAMovedFolderAreCountedToTheEnd) {
  BagWriter to = writer();
  const TopicId topic = expect_value(to.add_topic(kState));
  append(to, topic, 0, 50);
  fs::rename(folder / "run", folder / "elsewhere");
  EXPECT_FALSE(to.refresh());
  append(to, topic, 50, 20);
  EXPECT_FALSE(to.close());
  EXPECT_EQ(counts(to).written, 0U);
  EXPECT_EQ(counts(to).lost, 70U);
}

TEST_P(Losses, OfAReplacedFileAreCounted) {
  BagWriter to = writer();
  const TopicId topic = expect_value(to.add_topic(kState));
  append(to, topic, 0, 50);
  fs::copy_file(file(0), folder / "copy");
  fs::rename(folder / "copy", file(0));
  EXPECT_TRUE(says(to.refresh(), "replaced"));
  EXPECT_EQ(counts(to).lost, 50U);
}

TEST(LossesOfMcap, OfAFileCutWhileRecordingAreCounted) {
  const TemporaryFolder folder;
  BagWriter to = expect_value(BagWriter::create(folder / "run", {}));
  const TopicId topic = expect_value(to.add_topic(kState));
  for (std::uint64_t i = 0; i < 50; ++i)
    EXPECT_GOOD(to.append(topic, static_cast<std::int64_t>(i) * kMs, noisy_message(9, i, 1000)));
  EXPECT_GOOD(to.commit());
  fs::resize_file(folder / "run/run_0.mcap", 100);
  EXPECT_TRUE(says(to.refresh(), "was cut"));
}

/// Data written behind the cut restores the file's size.
TEST(LossesOfMcap, OfAFileCutBeforeMoreIsWrittenAreCounted) {
  const TemporaryFolder folder;
  BagWriter to = expect_value(BagWriter::create(folder / "run", {}));
  const TopicId topic = expect_value(to.add_topic(kState));
  const auto append = [&](std::uint64_t first) {
    for (std::uint64_t i = first; i < first + 50; ++i)
      EXPECT_GOOD(to.append(topic, static_cast<std::int64_t>(i) * kMs, noisy_message(9, i, 1000)));
  };
  append(0);
  EXPECT_GOOD(to.commit());
  fs::resize_file(folder / "run/run_0.mcap", 100);
  append(50);
  EXPECT_TRUE(says(to.refresh(), "was cut"));
  append(100);
  EXPECT_GOOD(to.close());
  std::vector<TopicReport> counts(1);
  to.fill_counts(counts);
  EXPECT_EQ(counts[0].written, 50U) << "in the next file";
  EXPECT_EQ(counts[0].lost, 100U);
}

}  // namespace
}  // namespace voxtouch::bag::losses_cases
