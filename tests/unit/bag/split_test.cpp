/// Bags that go on in another file.
#include <fstream>

#include "nodes/bag/bag_writer.hpp"
#include "tests/support/whole_bag.hpp"
#include "tests/unit/bag/support.hpp"

namespace voxtouch::bag::split_cases {
namespace {

using namespace test;
namespace fs = std::filesystem;

const TopicInfo kState{"/haptic/device/state", "voxtouch_msgs/msg/DeviceState", "cdr", "", 0};
const TopicInfo kPlan{"/haptic/rendering/plan", "voxtouch_msgs/msg/ScenePlan", "cdr", "", 0};
constexpr std::int64_t kMs = 1'000'000;

class SplitBag : public testing::TestWithParam<Storage> {
 protected:
  std::string file(int number) const {
    return "run_" + std::to_string(number) + std::string(names_of(GetParam()).extension);
  }
  BagWriter writer_of(const SplitOptions& split) const {
    return expect_value(BagWriter::create(folder / "run", {.storage = GetParam(), .split = split}));
  }
  /// A plan at 0, and 100 states from there on, one each 100 ms.
  void write(const SplitOptions& split) const {
    auto writer = writer_of(split);
    const TopicId state = expect_value(writer.add_topic(kState)),
                  plan = expect_value(writer.add_topic(kPlan));
    EXPECT_GOOD(writer.append(plan, 0, ring_message(9, 0, 1)));
    for (std::uint64_t i = 0; i < 100; ++i)
      EXPECT_GOOD(writer.append(state, static_cast<std::int64_t>(i) * 100 * kMs,
                                noisy_message(9, i, 1000)));
    EXPECT_GOOD(writer.close());
  }
  void expect_all() const {
    const auto bag = expect_value(WholeBag::open(folder / "run"));
    EXPECT_EQ(bag.topics().size(), 2u);
    const auto states = expect_value(bag.read_topic(kState.name));
    ASSERT_EQ(states.size(), 100u);
    for (std::size_t i = 0; i < 100; ++i)
      ASSERT_EQ(states[i].bytes, noisy_message(9, i, 1000));
    EXPECT_EQ(expect_value(bag.read_topic(kPlan.name)).size(), 1u);
  }
  TemporaryFolder folder;
};
INSTANTIATE_TEST_SUITE_P(Storages, SplitBag, testing::Values(Storage::kSqlite3, Storage::kMcap),
                         [](const auto& storage) {
                           return std::string(names_of(storage.param).name);
                         });

TEST_P(SplitBag, ByTimeHasAFileForEachSpanAndMetadataNamesThem) {
  write({.time_ns = 3000 * kMs});
  const auto metadata = expect_value(read_metadata(folder / "run/metadata.yaml"));
  EXPECT_EQ(metadata.message_count, 101u);
  EXPECT_EQ(metadata.duration_ns, 9900 * kMs);
  ASSERT_EQ(metadata.files.size(), 4u);
  for (int n = 0; n < 4; ++n) {
    const FileInfo& one = metadata.files[static_cast<std::size_t>(n)];
    EXPECT_EQ(one.path, file(n));
    EXPECT_EQ(one.starting_time_ns, 3000 * n * kMs);
    EXPECT_EQ(one.duration_ns, (n < 3 ? 2900 : 900) * kMs);
    EXPECT_EQ(one.message_count, n == 0 ? 31u : n < 3 ? 30u : 10u);
    const auto alone = expect_value(WholeBag::open(folder / "run" / file(n)));
    EXPECT_EQ(alone.topics().size(), 2u);  // in each, so that each is a bag
    EXPECT_EQ(alone.message_count(), one.message_count);
  }
  expect_all();
}

/// A reader that assumes a read-only file ignores its write-ahead log, and would find no tables.
TEST_P(SplitBag, NewFileIsReadableAfterAKill) {
  auto writer = writer_of({.time_ns = 1000 * kMs});
  const TopicId state = expect_value(writer.add_topic(kState));
  expect_value(writer.add_topic(kPlan));
  EXPECT_GOOD(writer.append(state, 0, noisy_message(9, 0, 1000)));
  EXPECT_GOOD(writer.append(state, 1000 * kMs, noisy_message(9, 1, 1000)));
  fs::create_directory(folder / "alone");
  fs::copy_file(folder / "run" / file(1),
                folder / "alone" / file(1));  // the file on the disk, without its companions
  const auto alone = expect_value(WholeBag::open(folder / "alone" / file(1)));
  EXPECT_EQ(alone.topics().size(), 2u);
}

TEST_P(SplitBag, BySizeNoFileIsMuchLarger) {
  constexpr std::uint64_t kMax = 60'000;
  write({.bytes = kMax});
  const auto metadata = expect_value(read_metadata(folder / "run/metadata.yaml"));
  EXPECT_GE(metadata.files.size(), 2u);
  EXPECT_LE(metadata.files.size(), 8u);
  std::uint64_t messages = 0;
  for (const FileInfo& one : metadata.files) {
    EXPECT_LE(fs::file_size(folder / "run" / one.path), kMax + 16'384)
        << one.path;  // its end: index, summary
    messages += one.message_count;
  }
  EXPECT_EQ(messages, 101u);
  expect_all();
}

TEST_P(SplitBag, OversizedMessageHasItsOwnFile) {
  auto writer = writer_of({.bytes = 5'000});
  const TopicId state = expect_value(writer.add_topic(kState));
  for (std::uint64_t i = 0; i < 3; ++i)
    EXPECT_GOOD(writer.append(state, static_cast<std::int64_t>(i), noisy_message(9, i, 50'000)));
  EXPECT_GOOD(writer.close());
  EXPECT_EQ(expect_value(read_metadata(folder / "run/metadata.yaml")).files.size(), 3u);
  EXPECT_EQ(expect_value(WholeBag::open(folder / "run")).message_count(), 3u);
}

TEST_P(SplitBag, KeepsTheOldFileAndReportsIfNoNewOneOpens) {
  auto writer = writer_of({.time_ns = 10});
  const TopicId state = expect_value(writer.add_topic(kState));
  std::ofstream(folder / "run" / file(1)) << "mine";  // blocks the name
  std::string said;
  for (std::uint64_t i = 0; i < 20; ++i)
    if (const auto appended =
            writer.append(state, static_cast<std::int64_t>(i), ring_message(9, i));
        !appended)
      said = appended.error().sentence;
  EXPECT_NE(said.find(file(1)), std::string::npos) << said;
  EXPECT_GOOD(writer.close());
  std::vector<TopicReport> counts(1);
  writer.fill_counts(counts);
  EXPECT_EQ(counts[0].written, 20u);
  EXPECT_EQ(counts[0].lost, 0u);
  EXPECT_EQ(fs::file_size(folder / "run" / file(1)), 4u);
  EXPECT_EQ(expect_value(WholeBag::open(folder / "run" / file(0))).message_count(), 20u);
}

TEST_P(SplitBag, IsReadWholeIfMetadataListsOnlyTheFirstFiles) {
  write({.time_ns = 3000 * kMs});
  std::ofstream(folder / "run/metadata.yaml")
      << "rosbag2_bagfile_information:\n  version: 8\n  storage_identifier: "
      << names_of(GetParam()).name << "\n  relative_file_paths:\n    - " << file(0) << "\n    - "
      << file(1) << "\n";
  expect_all();
}

}  // namespace
}  // namespace voxtouch::bag::split_cases
