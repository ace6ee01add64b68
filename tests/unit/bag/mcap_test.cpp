/// Properties of MCAP only: a file that is valid at each commit, chunks that overlap in time,
/// checksums, and forms of other writers.
#include <zlib.h>

#include <algorithm>
#include <fstream>
#include <random>

#include "nodes/bag/bag_writer.hpp"
#include "nodes/bag/mcap_format.hpp"
#include "tests/support/whole_bag.hpp"
#include "tests/unit/bag/support.hpp"

namespace voxtouch::bag::mcap_cases {
namespace {

using namespace test;
using mcap::Bytes;
using mcap::Op;

const TopicInfo kState{"/haptic/device/state",
                       "voxtouch_msgs/msg/DeviceState",
                       "cdr",
                       "- history: 1",
                       0,
                       "RIHS01_1",
                       "uint64 session_id\nuint64 sequence_number\n"};
const TopicInfo kNote{"/haptic/note", "std_msgs/msg/String", "cdr", "", 0};

std::vector<std::byte> content_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}
void put_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

using Messages = std::vector<std::pair<std::int64_t, std::vector<std::byte>>>;
Result<Messages> messages_of(const std::filesystem::path& path, std::int64_t from = 0,
                             std::int64_t to = std::numeric_limits<std::int64_t>::max()) {
  const auto bag = BagReader::open(path);
  if (!bag)
    return std::unexpected(bag.error());
  Messages all;
  const auto read = bag->for_each_between(from, to, [&](const BagMessage& m) {
    return all.emplace_back(m.time_ns, std::vector(m.bytes.begin(), m.bytes.end())), true;
  });
  if (!read)
    return std::unexpected(read.error());
  return all;
}

BagWriter mcap_writer(const std::filesystem::path& folder) {
  return expect_value(BagWriter::create(folder, {.storage = Storage::kMcap}));
}

/// Three chunks; some times of a later chunk are before those of an earlier one.
void write_overlapping(const std::filesystem::path& folder, bool close = true) {
  auto writer = mcap_writer(folder);
  const TopicId state = expect_value(writer.add_topic(kState));
  for (std::int64_t chunk = 0; chunk < 3; ++chunk) {
    for (std::int64_t n = 0; n < 40; ++n)
      EXPECT_GOOD(writer.append(
          state, 1000 + 100 * chunk + 5 * n,
          ring_message(static_cast<std::uint64_t>(chunk), static_cast<std::uint64_t>(n))));
    EXPECT_GOOD(writer.commit());
  }
  if (close)
    EXPECT_GOOD(writer.close());
}

/// The footer's offset of the summary; empty if the file has no valid end.
std::optional<std::uint64_t> summary_of(const std::filesystem::path& path) {
  const auto bytes = content_of(path);
  const std::size_t tail = mcap::kFooterSize + mcap::kMagic.size();
  if (bytes.size() < tail)
    return std::nullopt;
  mcap::Cursor cursor{std::span(bytes).last(tail)};
  const auto footer = mcap::next_record(cursor);
  if (!footer || footer->op != Op::kFooter ||
      !std::ranges::equal(cursor.rest(), std::as_bytes(std::span(mcap::kMagic))))
    return std::nullopt;
  return mcap::Cursor(footer->content).number<std::uint64_t>();
}

TEST(McapBag, IsCompleteAfterEachCommitAndHasASummary) {
  const TemporaryFolder folder;
  const auto file = folder / "run/run_0.mcap";
  auto writer = mcap_writer(folder / "run");
  EXPECT_EQ(summary_of(file), 0u);
  const TopicId state = expect_value(writer.add_topic(kState));
  EXPECT_EQ(summary_of(file), 0u);
  for (std::uint64_t n = 0; n < 5; ++n) {
    EXPECT_GOOD(writer.append(state, static_cast<std::int64_t>(n), noisy_message(1, n, 100)));
    EXPECT_GOOD(writer.commit());
    EXPECT_EQ(summary_of(file), 0u);
    EXPECT_EQ(expect_value(messages_of(file)).size(), n + 1);  // read while it is recorded
  }
  EXPECT_GOOD(writer.close());
  EXPECT_GT(summary_of(file).value_or(0), 0u);
  EXPECT_EQ(expect_value(messages_of(file)).size(), 5u);
}

TEST(McapBag, ListsItsTypes) {
  const TemporaryFolder folder;
  auto writer = mcap_writer(folder / "run");
  (void)expect_value(writer.add_topic(kState)), (void)expect_value(writer.add_topic(kNote));
  TopicInfo other = kState;
  other.name = "/other/device/state";  // of the same type, with its schema stored once
  (void)expect_value(writer.add_topic(other));
  EXPECT_GOOD(writer.commit());
  const auto check = [&] {
    const auto bag = expect_value(BagReader::open(folder / "run"));
    ASSERT_EQ(bag.topics().size(), 3u);
    EXPECT_EQ(bag.topics()[0].type, kState.type);
    EXPECT_EQ(bag.topics()[0].definition, kState.definition);
    EXPECT_EQ(bag.topics()[0].type_hash, kState.type_hash);
    EXPECT_EQ(bag.topics()[0].offered_qos, kState.offered_qos);
    EXPECT_EQ(bag.topics()[1].definition, "");
    EXPECT_EQ(bag.topics()[2].definition, kState.definition);
    EXPECT_FALSE(expect_value(bag.times()));
  };
  check();  // without a summary
  EXPECT_GOOD(writer.close());
  check();
}

TEST(McapBag, ChunksThatOverlapAreReadInOrderOfTimeAndOfArrival) {
  const TemporaryFolder folder;
  write_overlapping(folder / "run");
  const auto all = expect_value(messages_of(folder / "run"));
  ASSERT_EQ(all.size(), 120u);
  EXPECT_TRUE(std::ranges::is_sorted(all, {}, [](const auto& m) { return m.first; }));
  EXPECT_EQ(all[20].second, ring_message(0, 20));  // 1100: of the first chunk first
  EXPECT_EQ(all[21].second, ring_message(1, 0));
  for (const auto& [from, to] : {std::pair<std::int64_t, std::int64_t>{0, 1001},
                                 {1095, 1105},
                                 {1100, 1300},
                                 {1395, 5000},
                                 {1100, 1100},
                                 {2000, 3000}}) {
    Messages expected;
    for (const auto& one : all)
      if (one.first >= from && one.first < to)
        expected.push_back(one);
    EXPECT_EQ(expect_value(messages_of(folder / "run", from, to)), expected)
        << from << " to " << to;
  }
  const auto times = expect_value(expect_value(BagReader::open(folder / "run")).times());
  ASSERT_TRUE(times);
  EXPECT_EQ(*times, (std::pair<std::int64_t, std::int64_t>{1000, 1395}));
}

// In lockstep rare messages have the time 0 whenever they are written.
TEST(McapBag, LaterChunkMayBeginBeforeAllOthers) {
  const TemporaryFolder folder;
  auto writer = mcap_writer(folder / "run");
  const TopicId state = expect_value(writer.add_topic(kState));
  for (const std::int64_t time : {2000, 3000, 0, 1000}) {
    EXPECT_GOOD(writer.append(state, time, ring_message(1, static_cast<std::uint64_t>(time))));
    EXPECT_GOOD(
        writer.append(state, time + 1, ring_message(1, static_cast<std::uint64_t>(time + 1))));
    EXPECT_GOOD(writer.commit());
  }
  const auto check = [&] {
    const auto all = expect_value(messages_of(folder / "run"));
    std::vector<std::int64_t> times;
    for (const auto& [time, bytes] : all)
      times.push_back(time);
    EXPECT_EQ(times, (std::vector<std::int64_t>{0, 1, 1000, 1001, 2000, 2001, 3000, 3001}));
    EXPECT_EQ(expect_value(messages_of(folder / "run", 1, 2001)).size(), 4u);
  };
  check();
  EXPECT_GOOD(writer.close());
  check();
}

TEST(McapBag, OfTimeZeroIsReadByOthersToo) {
  const TemporaryFolder folder;
  auto writer = mcap_writer(folder / "run");
  const TopicId state = expect_value(writer.add_topic(kState));
  EXPECT_GOOD(writer.append(state, 0, ring_message(1, 0)));
  EXPECT_GOOD(writer.append(state, 1, ring_message(1, 1)));
  EXPECT_GOOD(writer.close());
  const auto all = expect_value(messages_of(folder / "run"));
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].first, 0);
  EXPECT_EQ(all[1].first, 1);
  EXPECT_EQ(expect_value(messages_of(folder / "run", 0, 1)).size(), 1u);
  const auto bytes = content_of(folder / "run/run_0.mcap");
  mcap::Cursor records{std::span(bytes).subspan(mcap::kMagic.size())};
  auto record = mcap::next_record(records);
  while (record && record->op != Op::kChunk)
    record = mcap::next_record(records);
  ASSERT_TRUE(record);
  EXPECT_EQ(mcap::Cursor(record->content).number<std::uint64_t>(),
            1u);  // start of the chunk: some readers treat 0 as missing
}

TEST(McapBag, LargeAndManyMessagesAreWrittenEarly) {
  const TemporaryFolder folder;
  auto writer = mcap_writer(folder / "run");
  const TopicId state = expect_value(writer.add_topic(kState));
  EXPECT_GOOD(writer.append(state, 1, noisy_message(1, 0, std::size_t{3} << 20)));
  EXPECT_EQ(writer.metadata().message_count, 1u);
  for (std::uint64_t n = 0; n < 1100; ++n)
    EXPECT_GOOD(writer.append(state, 2, noisy_message(1, n, 1000)));
  EXPECT_GT(writer.metadata().message_count, 900u);
  EXPECT_GOOD(writer.close());
  EXPECT_EQ(expect_value(messages_of(folder / "run")).size(), 1101u);
}

TEST(McapBag, CutAnywhereGivesWholeMessagesBeforeTheCut) {
  const TemporaryFolder folder;
  write_overlapping(folder / "run");
  const auto whole = content_of(folder / "run/run_0.mcap");
  const auto all = expect_value(messages_of(folder / "run"));
  std::size_t most = 0, opened = 0;
  for (std::size_t size = 0; size < whole.size(); size += 7) {
    put_file(folder / "cut.mcap", std::span(whole).first(size));
    const auto some = messages_of(folder / "cut.mcap");
    if (!some) {
      EXPECT_FALSE(some.error().sentence.empty());
      EXPECT_LT(size, 200u) << some.error().sentence;  // not even its header
      continue;
    }
    ++opened;
    EXPECT_EQ(some->size() % 40, 0u) << "half a chunk at " << size;
    EXPECT_GE(some->size(), most);
    most = some->size();
    for (const auto& one : *some)
      ASSERT_NE(std::ranges::find(all, one), all.end());
  }
  EXPECT_EQ(most, all.size());
  EXPECT_GT(opened, 100u);
}

TEST(McapBag, DamagedBytesAreRefusedOrHarmless) {
  const TemporaryFolder folder;
  write_overlapping(folder / "run");
  const auto whole = content_of(folder / "run/run_0.mcap");
  const auto all = expect_value(messages_of(folder / "run"));
  std::mt19937 random(7);
  int refused = 0;
  for (int n = 0; n < 1500; ++n) {
    auto damaged = whole;
    const std::size_t at = random() % damaged.size();
    damaged[at] ^= static_cast<std::byte>(1 + random() % 255);
    put_file(folder / "damaged.mcap", damaged);
    const auto some = messages_of(folder / "damaged.mcap");
    if (!some) {
      ++refused;
      EXPECT_FALSE(some.error().sentence.empty());
      continue;
    }
    for (const auto& one : *some)
      ASSERT_NE(std::ranges::find(all, one), all.end()) << "byte " << at;
  }
  EXPECT_GT(refused, 100);
}

/// As rosbag2's preset "fastwrite" writes (no chunks), and as its default does (uncompressed chunks
/// with schema and channel), here both in one file; without a summary, as after a kill of the
/// recorder.
TEST(McapBag, OfOtherWritersIsRead) {
  const auto message = [](Bytes& out, std::uint64_t time, std::byte what) {
    const auto at = out.begin(Op::kMessage);
    out.number(std::uint16_t{7}), out.number(std::uint32_t{3}), out.number(time), out.number(time);
    out.raw(std::span(&what, 1));
    out.end(at);
  };
  Bytes inner;
  auto at = inner.begin(Op::kSchema);
  inner.number(std::uint16_t{4}), inner.text("std_msgs/msg/String"), inner.text("ros2msg"),
      inner.text("string data\n");
  inner.end(at);
  at = inner.begin(Op::kChannel);
  inner.number(std::uint16_t{7}), inner.number(std::uint16_t{4}), inner.text("/chatter"),
      inner.text("cdr"), inner.number(std::uint32_t{0});
  inner.end(at);
  message(inner, 20, std::byte{2});
  Bytes out;
  out.raw(std::as_bytes(std::span(mcap::kMagic)));
  at = out.begin(Op::kHeader);
  out.text("ros2"), out.text("libmcap 1.3.0");
  out.end(at);
  at = out.begin(Op::kChunk);
  out.number(std::uint64_t{20}), out.number(std::uint64_t{20}),
      out.number(std::uint64_t{inner.size()}), out.number(std::uint32_t{0}), out.text("");
  out.number(std::uint64_t{inner.size()}), out.raw(inner.view());
  out.end(at);
  message(out, 30, std::byte{3});
  message(out, 10, std::byte{1});
  const TemporaryFolder folder;
  put_file(folder / "others.mcap", out.view());
  const auto bag = expect_value(WholeBag::open(folder / "others.mcap"));
  ASSERT_EQ(bag.topics().size(), 1u);
  EXPECT_EQ(bag.topics()[0].name, "/chatter");
  EXPECT_EQ(bag.topics()[0].type, "std_msgs/msg/String");
  const auto all = expect_value(messages_of(folder / "others.mcap"));
  ASSERT_EQ(all.size(), 3u);
  for (std::int64_t n = 0; n < 3; ++n) {
    EXPECT_EQ(all[static_cast<std::size_t>(n)].first, 10 * (n + 1));
    EXPECT_EQ(all[static_cast<std::size_t>(n)].second, std::vector{static_cast<std::byte>(n + 1)});
  }
}

TEST(McapBag, RefusesWhatItCannotUncompress) {
  Bytes out;
  out.raw(std::as_bytes(std::span(mcap::kMagic)));
  auto at = out.begin(Op::kHeader);
  out.text("ros2"), out.text("libmcap 1.3.0");
  out.end(at);
  const std::size_t chunk_at = out.size();
  at = out.begin(Op::kChunk);
  out.number(std::uint64_t{1}), out.number(std::uint64_t{2}), out.number(std::uint64_t{9}),
      out.number(std::uint32_t{0}), out.text("lz4");
  out.number(std::uint64_t{1}), out.number(std::uint8_t{0});
  out.end(at);
  const std::size_t chunk_size = out.size() - chunk_at;
  at = out.begin(Op::kDataEnd);
  out.number(std::uint32_t{0});
  out.end(at);
  const std::size_t summary = out.size();
  at = out.begin(Op::kSchema);
  out.number(std::uint16_t{1}), out.text("a/msg/B"), out.text("ros2msg"), out.text("");
  out.end(at);
  at = out.begin(Op::kChannel);
  out.number(std::uint16_t{1}), out.number(std::uint16_t{1}), out.text("/a"), out.text("cdr"),
      out.number(std::uint32_t{0});
  out.end(at);
  at = out.begin(Op::kChunkIndex);
  for (const std::uint64_t value :
       {std::uint64_t{1}, std::uint64_t{2}, std::uint64_t{chunk_at}, std::uint64_t{chunk_size}})
    out.number(value);
  out.number(std::uint32_t{0}), out.number(std::uint64_t{0}), out.text("lz4"),
      out.number(std::uint64_t{1}), out.number(std::uint64_t{9});
  out.end(at);
  at = out.begin(Op::kFooter);
  out.number(std::uint64_t{summary}), out.number(std::uint64_t{0}), out.number(std::uint32_t{0});
  out.end(at);
  out.raw(std::as_bytes(std::span(mcap::kMagic)));
  const TemporaryFolder folder;
  put_file(folder / "lz4.mcap", out.view());
  const auto some = messages_of(folder / "lz4.mcap");
  EXPECT_TRUE(says(some, "lz4")) << (some ? "read" : some.error().sentence);
}

}  // namespace
}  // namespace voxtouch::bag::mcap_cases
