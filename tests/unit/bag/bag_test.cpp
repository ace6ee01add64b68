#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <fstream>
#include <thread>

#include "nodes/bag/bag_writer.hpp"
#include "nodes/bag/sqlite.hpp"
#include "tests/support/process/forked.hpp"
#include "tests/support/whole_bag.hpp"
#include "tests/unit/bag/support.hpp"

namespace voxtouch::bag {
namespace {

using namespace test;

const TopicInfo kState{"/haptic/device/state", "voxtouch_msgs/msg/DeviceState", "cdr",
                       "- history: 1\n  depth: 1", 0};
const TopicInfo kPlan{"/haptic/rendering/plan", "voxtouch_msgs/msg/ScenePlan", "cdr", "", 0};

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_bag(const std::filesystem::path& folder, std::uint64_t count,
               Storage storage = Storage::kSqlite3) {
  auto writer = expect_value(BagWriter::create(folder, {.storage = storage}));
  const TopicId state = expect_value(writer.add_topic(kState)),
                plan = expect_value(writer.add_topic(kPlan));
  for (std::uint64_t i = 0; i < count; ++i)
    EXPECT_GOOD(writer.append(state, static_cast<std::int64_t>(1000 + i), ring_message(9, i)));
  EXPECT_GOOD(writer.append(plan, 500, ring_message(9, 0, 1)));
  EXPECT_GOOD(writer.close());
}

/// Tests for both storages.
class EachBag : public testing::TestWithParam<Storage> {
 protected:
  std::string file_in(const std::string& name) const {
    return name + std::string(names_of(GetParam()).extension);
  }
  BagWriter writer_of(const std::filesystem::path& path, WriterOptions options = {}) const {
    options.storage = GetParam();
    return expect_value(BagWriter::create(path, options));
  }
};
INSTANTIATE_TEST_SUITE_P(Storages, EachBag, testing::Values(Storage::kSqlite3, Storage::kMcap),
                         [](const auto& storage) {
                           return std::string(names_of(storage.param).name);
                         });

TEST_P(EachBag, ReturnsItsMessagesInOrderOfTime) {
  const TemporaryFolder folder;
  write_bag(folder / "run", 100, GetParam());
  const auto bag = expect_value(WholeBag::open(folder / "run"));
  ASSERT_EQ(bag.topics().size(), 2u);
  EXPECT_EQ(bag.topics()[0].name, kState.name);
  EXPECT_EQ(bag.topics()[0].type, kState.type);
  EXPECT_EQ(bag.topics()[0].offered_qos, kState.offered_qos);
  EXPECT_EQ(bag.topics()[0].message_count, 100u);
  EXPECT_EQ(bag.message_count(), 101u);
  std::vector<std::int64_t> times;
  EXPECT_GOOD(bag.for_each([&](const BagMessage& message) {
    times.push_back(message.time_ns);
    const auto sequence = times.size() == 1 ? 0 : times.size() - 2;
    const auto expected = ring_message(9, sequence, times.size() == 1 ? 1 : 32);
    EXPECT_TRUE(std::ranges::equal(message.bytes, expected));
    return true;
  }));
  ASSERT_EQ(times.size(), 101u);
  EXPECT_EQ(times.front(), 500);  // the plan came last and is the oldest
  EXPECT_TRUE(std::ranges::is_sorted(times));
}

TEST_P(EachBag, ClosedIsTwoFilesWithTrueMetadata) {
  const TemporaryFolder folder;
  write_bag(folder / "run", 10, GetParam());
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "run"))
    names.push_back(entry.path().filename());
  std::ranges::sort(names);
  EXPECT_EQ(names, (std::vector<std::string>{"metadata.yaml", file_in("run_0")}));
  const auto metadata = expect_value(read_metadata(folder / "run" / "metadata.yaml"));
  EXPECT_EQ(metadata.version, 8);
  EXPECT_EQ(metadata.storage_identifier, names_of(GetParam()).name);
  EXPECT_EQ(metadata.message_count, 11u);
  EXPECT_EQ(metadata.starting_time_ns, 500);
  EXPECT_EQ(metadata.duration_ns, 1009 - 500);
  ASSERT_EQ(metadata.files.size(), 1u);
  EXPECT_EQ(metadata.files[0].path, file_in("run_0"));
  EXPECT_EQ(metadata.files[0].message_count, 11u);
  ASSERT_EQ(metadata.topics.size(), 2u);
  EXPECT_EQ(metadata.topics[0].message_count, 10u);
  EXPECT_EQ(metadata.topics[0].offered_qos, kState.offered_qos);
}

TEST(Bag, ClosedOpensOnAReadOnlyDisk) {
  const TemporaryFolder folder;
  write_bag(folder / "run", 10);
  namespace fs = std::filesystem;
  fs::permissions(folder / "run", fs::perms::owner_read | fs::perms::owner_exec);
  const auto bag = WholeBag::open(folder / "run");
  fs::permissions(folder / "run", fs::perms::owner_all);
  ASSERT_TRUE(bag) << bag.error().sentence;
  EXPECT_EQ(bag->message_count(), 11u);
  // The reason: the file's header (bytes 18, 19) no longer has the flag of a write-ahead log.
  const std::string header = text_of(folder / "run" / "run_0.db3").substr(0, 20);
  EXPECT_EQ(header[18], 1);
  EXPECT_EQ(header[19], 1);
}

TEST(Bag, NeverOverwritesAnything) {
  const TemporaryFolder folder;
  write_bag(folder / "run", 10);
  const std::string before = text_of(folder / "run" / "run_0.db3");
  const auto again = BagWriter::create(folder / "run");
  ASSERT_FALSE(again);
  EXPECT_TRUE(says(again, "/run' exists")) << again.error().sentence;
  EXPECT_EQ(text_of(folder / "run" / "run_0.db3"), before);

  std::filesystem::create_directory(folder / "empty");
  EXPECT_TRUE(says(BagWriter::create(folder / "empty"), "exists and is not overwritten"));
  std::ofstream(folder / "file") << "mine";
  EXPECT_TRUE(says(BagWriter::create(folder / "file"), "exists and is not overwritten"));
  EXPECT_EQ(text_of(folder / "file"), "mine");
}

TEST(Bag, IsNamedByItsFolderAlsoWithATrailingSlash) {
  const TemporaryFolder folder;
  EXPECT_TRUE(BagWriter::create((folder / "a/b/run").string() + "/"));
  EXPECT_TRUE(std::filesystem::exists(folder / "a/b/run/run_0.mcap")) << "the default storage";
}

TEST_P(EachBag, HasMetadataFromTheStartAndRefreshesIt) {
  const TemporaryFolder folder;
  auto writer = writer_of(folder / "run", {.commit_period = std::chrono::milliseconds(5),
                                           .refresh_period = std::chrono::milliseconds(20)});
  EXPECT_EQ(expect_value(read_metadata(folder / "run/metadata.yaml")).message_count, 0u);
  const TopicId state = expect_value(writer.add_topic(kState));
  EXPECT_GOOD(writer.append(state, 7, ring_message(1, 0)));
  std::this_thread::sleep_for(std::chrono::milliseconds(25));
  EXPECT_GOOD(writer.tick());
  EXPECT_EQ(expect_value(read_metadata(folder / "run/metadata.yaml")).message_count, 1u);
  EXPECT_EQ(expect_value(WholeBag::open(folder / "run")).message_count(),
            1u);  // read while it is recorded
}

TEST(Bag, HasWholeMetadataAtEveryInstant) {
  const TemporaryFolder folder;
  auto writer = expect_value(BagWriter::create(folder / "run"));
  for (int i = 0; i < 50; ++i)
    (void)expect_value(writer.add_topic(kState));
  EXPECT_GOOD(writer.refresh());
  std::atomic<bool> done{false};
  std::uint64_t reads = 0, whole = 0;
  std::thread reader([&] {
    while (!done) {
      const auto metadata = read_metadata(folder / "run/metadata.yaml");
      ++reads;
      whole += metadata && metadata->topics.size() == 50;
    }
  });
  for (int i = 0; i < 40; ++i)
    EXPECT_GOOD(writer.refresh());
  done = true;
  reader.join();
  EXPECT_GT(reads, 5u);
  EXPECT_EQ(whole, reads);
}

TEST(Bag, ReportsWhyAFolderCannotBeMade) {
  const auto refused = BagWriter::create("/proc/voxtouch/run");
  ASSERT_FALSE(refused);
  EXPECT_TRUE(says(refused, "/proc/voxtouch'")) << refused.error().sentence;
}

TEST_P(EachBag, RefusesInvalidTopicsAndMessages) {
  const TemporaryFolder folder;
  auto writer = writer_of(folder / "run");
  const TopicId state = expect_value(writer.add_topic(kState));
  EXPECT_TRUE(says(writer.append(state, -1, ring_message(1, 0)), "before 1970"));
  EXPECT_TRUE(says(writer.append(state + 1, 1, ring_message(1, 0)), "number 1"));
  EXPECT_GOOD(writer.append(state, 0, {}));  // empty is a message too
  EXPECT_GOOD(writer.close());
  EXPECT_EQ(expect_value(WholeBag::open(folder / "run")).message_count(), 1u);
}

TEST_P(EachBag, CountsFullDiskLossesAndStaysReadable) {
  const TemporaryFolder folder;
  auto writer = writer_of(folder / "run", {.max_bytes = 200'000});
  const TopicId state = expect_value(writer.add_topic(kState));
  std::uint64_t refused = 0;
  std::string sentence;
  for (std::uint64_t i = 0; i < 500; ++i) {
    const auto appended =
        writer.append(state, static_cast<std::int64_t>(i), noisy_message(1, i, 1000));
    const auto committed = i % 10 == 9 ? writer.commit() : Result<void>();
    for (const auto* step : {&appended, &committed})
      if (!*step) {
        ++refused;
        sentence = step->error().sentence;
      }
  }
  EXPECT_GT(refused, 0u);
  EXPECT_NE(sentence.find("full"), std::string::npos) << sentence;
  (void)writer.close();
  std::vector<TopicReport> counts(1);
  writer.fill_counts(counts);
  EXPECT_GT(counts[0].written, 50u);
  EXPECT_EQ(counts[0].written + counts[0].lost, 500u);
  const auto bag = expect_value(WholeBag::open(folder / "run"));
  EXPECT_EQ(bag.message_count(), counts[0].written);
  EXPECT_EQ(bag.metadata()->message_count, counts[0].written);
}

// The operating system refuses to let any file grow, which emulates a full disk, also for
// metadata.yaml.
TEST_P(EachBag, ResumesOnceTheDiskHasRoomAgain) {
  const TemporaryFolder folder;
  voxtouch::test::Forked child([&] {
    std::signal(SIGXFSZ, SIG_IGN);
    auto writer = BagWriter::create(folder / "run", {.storage = GetParam()});
    const auto state = writer->add_topic(kState);
    rlimit limit{};
    getrlimit(RLIMIT_FSIZE, &limit);
    const rlim_t soft = limit.rlim_cur;
    std::uint64_t time = 0;
    const auto write_100 = [&] {
      for (int i = 0; i < 100; ++i, ++time)
        (void)writer->append(*state, static_cast<std::int64_t>(time), noisy_message(1, time, 1000));
      return writer->refresh().has_value();
    };
    const bool before = write_100();
    limit.rlim_cur = 300'000;
    setrlimit(RLIMIT_FSIZE, &limit);
    bool during = true;
    // the log takes some more before it is at its limit too
    for (int i = 0; i < 6; ++i)
      during = write_100();
    limit.rlim_cur = soft;
    setrlimit(RLIMIT_FSIZE, &limit);
    const bool after = write_100();
    const bool closed = writer->close().has_value();
    std::vector<TopicReport> counts(1);
    writer->fill_counts(counts);
    const bool adds_up = counts[0].lost > 0 && counts[0].written + counts[0].lost == time &&
                         counts[0].written >= 200;
    return (before ? 0 : 1) | (during ? 2 : 0) | (after ? 0 : 4) | (closed ? 0 : 8) |
           (adds_up ? 0 : 16);
  });
  EXPECT_EQ(child.wait().status, 0);
  const auto bag = expect_value(WholeBag::open(folder / "run"));
  EXPECT_EQ(bag.metadata()->message_count, bag.message_count());
  EXPECT_GE(bag.message_count(), 200u);
}

TEST(BagReader, FindsTheDatabaseWhenMetadataIsStaleMissingOrBroken) {
  const TemporaryFolder folder;
  write_bag(folder / "run", 10);
  std::filesystem::rename(folder / "run", folder / "moved");
  // the name of the folder does not matter
  EXPECT_EQ(expect_value(WholeBag::open(folder / "moved")).message_count(), 11u);
  std::filesystem::rename(folder / "moved/run_0.db3", folder / "moved/other_0.db3");
  EXPECT_EQ(expect_value(WholeBag::open(folder / "moved")).message_count(), 11u);
  std::ofstream(folder / "moved/metadata.yaml") << "rosbag2_bagfile_information: [";
  EXPECT_EQ(expect_value(WholeBag::open(folder / "moved")).message_count(), 11u);
  std::filesystem::remove(folder / "moved/metadata.yaml");
  EXPECT_EQ(expect_value(WholeBag::open(folder / "moved")).message_count(), 11u);
  EXPECT_EQ(expect_value(WholeBag::open(folder / "moved/other_0.db3")).message_count(), 11u);
}

TEST(BagReader, RejectsWhatIsNotABag) {
  const TemporaryFolder folder;
  EXPECT_TRUE(says(WholeBag::open(folder / "nothing"), "/nothing'"));
  EXPECT_TRUE(says(WholeBag::open(folder.path()), "has no .db3"));
  std::ofstream(folder / "text.db3") << std::string(5000, 'x');
  const auto text = WholeBag::open(folder / "text.db3");
  ASSERT_FALSE(text);
  EXPECT_TRUE(says(text, "database")) << text.error().sentence;
  write_bag(folder / "run", 1);
  const auto bag = expect_value(WholeBag::open(folder / "run"));
  const auto none = bag.read_topic("/none");
  EXPECT_TRUE(says(none, "no topic '/none'") && says(none, kState.name)) << none.error().sentence;
}

// As `ros2 bag record` of Jazzy leaves it after a split: version 9, schema 4, two files.
TEST(BagReader, ReadsABagOfJazzyInTwoFiles) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "jazzy");
  for (int part = 0; part < 2; ++part) {
    const auto file = folder / "jazzy" / (std::string("jazzy_") + std::to_string(part) + ".db3");
    const auto database = expect_value(Database::open(file, Database::Mode::kCreate));
    EXPECT_GOOD(database.run(
        "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);"
        "CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL,"
        " metadata TEXT NOT NULL);"
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,"
        " serialization_format TEXT NOT NULL,"
        " offered_qos_profiles TEXT NOT NULL, type_description_hash TEXT NOT NULL);"
        "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL,"
        " encoding TEXT NOT NULL,"
        " encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp "
        "INTEGER NOT NULL,"
        " data BLOB NOT NULL);"
        "CREATE INDEX timestamp_idx ON messages (timestamp ASC); INSERT INTO schema VALUES (4, "
        "'jazzy');"
        "INSERT INTO topics VALUES (" +
        std::to_string(part + 1) +
        ", '/chatter', 'std_msgs/msg/String', 'cdr', '', 'RIHS01_0');"
        "INSERT INTO messages VALUES (1, " +
        std::to_string(part + 1) + ", " + std::to_string(100 + part) + ", x'00010000');"));
  }
  std::ofstream(folder / "jazzy/metadata.yaml") << R"(rosbag2_bagfile_information:
  version: 9
  storage_identifier: sqlite3
  duration: {nanoseconds: 1}
  starting_time: {nanoseconds_since_epoch: 100}
  message_count: 2
  topics_with_message_count:
    - topic_metadata:
        name: /chatter
        type: std_msgs/msg/String
        serialization_format: cdr
        offered_qos_profiles:
          - history: unknown
            depth: 0
            reliability: reliable
        type_description_hash: RIHS01_0
      message_count: 2
  compression_format: ""
  compression_mode: ""
  relative_file_paths: [jazzy_0.db3, jazzy_1.db3]
  files: []
  custom_data: ~
  ros_distro: jazzy
)";
  const auto bag = expect_value(WholeBag::open(folder / "jazzy"));
  EXPECT_EQ(bag.metadata()->version, 9);
  EXPECT_NE(bag.metadata()->topics[0].offered_qos.find("reliable"), std::string::npos);
  const auto messages = expect_value(bag.read_topic("/chatter"));
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_EQ(messages[1].time_ns, 101);
  EXPECT_EQ(bag.topics().size(), 1u);
}

TEST(BagReader, RefusesUnreadableBagsWithAMessage) {
  const TemporaryFolder folder;
  write_bag(folder / "run", 1);
  std::string yaml = text_of(folder / "run/metadata.yaml");
  std::string other = yaml, compressed = yaml;
  other.replace(other.find("sqlite3"), 7, "rocksdb");
  compressed.replace(compressed.find("compression_mode: \"\""), 20, "compression_mode: \"FILE\"");
  std::ofstream(folder / "run/metadata.yaml") << other;
  EXPECT_NE(WholeBag::open(folder / "run").error().sentence.find("rocksdb"), std::string::npos);
  std::ofstream(folder / "run/metadata.yaml") << compressed;
  EXPECT_NE(WholeBag::open(folder / "run").error().sentence.find("compressed"), std::string::npos);
}

}  // namespace
}  // namespace voxtouch::bag
