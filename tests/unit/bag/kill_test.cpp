/// Content of the bag of a killed recorder.
#include <sys/mman.h>

#include <atomic>
#include <thread>

#include "nodes/bag/bag_recorder.hpp"
#include "nodes/bag/bag_writer.hpp"
#include "tests/support/process/forked.hpp"
#include "tests/support/whole_bag.hpp"
#include "tests/unit/bag/support.hpp"

namespace voxtouch::bag {
namespace {

using namespace test;
using namespace std::chrono_literals;

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Memory common to child and parent.
struct Shared {
  std::atomic<std::uint64_t> pushed{0};
  std::atomic<std::int64_t> last_time_ns{0};
};

/// Records one message per millisecond, each with its time, until it is killed.
[[noreturn]] void record_for_ever(const std::filesystem::path& folder, Storage storage,
                                  Shared& shared) {
  auto writer = BagWriter::create(folder, {.storage = storage});
  if (!writer)
    _exit(1);
  BagRecorder recorder(std::make_unique<BagWriter>(std::move(*writer)));
  const auto topic =
      recorder.add_topic({"/haptic/device/state", "voxtouch_msgs/msg/DeviceState", "cdr", "", 0});
  for (std::uint64_t i = 0;; ++i) {
    const std::int64_t time = now_ns();
    if (recorder.push(*topic, time, ring_message(1, i, 200)) != PushResult::kQueued)
      _exit(2);
    shared.last_time_ns = time;
    shared.pushed = i + 1;
    std::this_thread::sleep_for(1ms);
  }
}

class KilledRecorder : public testing::TestWithParam<std::pair<Storage, int>> {};

TEST_P(KilledRecorder, LosesAtMostASecond) {
  const TemporaryFolder folder;
  void* memory =
      mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  auto& shared = *new (memory) Shared();
  voxtouch::test::Forked child(
      [&]() -> int { record_for_ever(folder / "run", GetParam().first, shared); });
  while (shared.pushed == 0)
    std::this_thread::sleep_for(1ms);
  std::this_thread::sleep_for(std::chrono::milliseconds(GetParam().second));
  child.signal(SIGKILL);
  ASSERT_EQ(child.wait().status, 128 + SIGKILL) << "the recorder ended by itself";

  const auto bag = expect_value(WholeBag::open(folder / "run"));
  const auto messages = expect_value(bag.read_topic("/haptic/device/state"));
  ASSERT_FALSE(messages.empty());
  // no gap, no half message
  for (std::size_t i = 0; i < messages.size(); ++i)
    ASSERT_EQ(messages[i].bytes, ring_message(1, i, 200)) << i;
  const std::int64_t lacking_ns = shared.last_time_ns - messages.back().time_ns;
  EXPECT_LE(lacking_ns, 1'000'000'000) << messages.size() << " of " << shared.pushed;
  ASSERT_TRUE(bag.metadata());
  EXPECT_LE(bag.metadata()->message_count, messages.size());
  // metadata.yaml is a second behind at most.
  const std::int64_t described_ns = bag.metadata()->starting_time_ns + bag.metadata()->duration_ns;
  EXPECT_LE(shared.last_time_ns - described_ns, 1'000'000'000);
  if (GetParam().first == Storage::kSqlite3) {  // without its -wal file it lacks more, but not the
                                                // checkpointed messages in the .db3
    std::filesystem::create_directory(folder / "alone");
    std::filesystem::copy_file(folder / "run/run_0.db3", folder / "alone/run_0.db3");
    const auto alone =
        expect_value(WholeBag::open(folder / "alone/run_0.db3")).read_topic("/haptic/device/state");
    ASSERT_TRUE(alone && !alone->empty());
    EXPECT_LE(shared.last_time_ns - alone->back().time_ns, 1'500'000'000);
  }
  RecordProperty("lacking_ms", static_cast<int>(lacking_ns / 1'000'000));
  std::printf("pushed %llu, in the bag %zu, lacking %.0f ms\n",
              static_cast<unsigned long long>(shared.pushed), messages.size(),
              static_cast<double>(lacking_ns) * 1e-6);
  munmap(memory, sizeof(Shared));
}

INSTANTIATE_TEST_SUITE_P(AfterMilliseconds, KilledRecorder,
                         testing::Values(std::pair(Storage::kSqlite3, 1200),
                                         std::pair(Storage::kSqlite3, 1613),
                                         std::pair(Storage::kSqlite3, 2057),
                                         std::pair(Storage::kMcap, 1200),
                                         std::pair(Storage::kMcap, 1613)));

}  // namespace
}  // namespace voxtouch::bag
