/// When a bag is flushed to the disk: never while it records, always when it is closed.
#include <dlfcn.h>
#include <unistd.h>

#include <atomic>

#include "nodes/bag/bag_writer.hpp"
#include "tests/unit/bag/support.hpp"

namespace {

std::atomic<int> flushes{0};
std::atomic<int> replacements{0};  // renames over a file that is there, which ext4 makes durable
                                   // first (its mount option auto_da_alloc)

int flush_by(const char* name, int file) {
  ++flushes;
  return reinterpret_cast<int (*)(int)>(dlsym(RTLD_NEXT, name))(file);
}

}  // namespace

// In front of the C library's, for this program and the sqlite that it has loaded.
extern "C" int fsync(int file) { return flush_by("fsync", file); }
extern "C" int fdatasync(int file) { return flush_by("fdatasync", file); }
extern "C" int rename(const char* from, const char* to) {
  if (access(to, F_OK) == 0)
    ++replacements;
  return reinterpret_cast<int (*)(const char*, const char*)>(dlsym(RTLD_NEXT, "rename"))(from, to);
}

namespace voxtouch::bag {
namespace {

using namespace test;

// A flush takes as long as the disk and everybody else on it like, 1.2 s for a bag of 80 MB: the
// queue would fill and `up` would rightly call the logger hung.
class Flushes : public testing::TestWithParam<Storage> {};
INSTANTIATE_TEST_SUITE_P(Storages, Flushes, testing::Values(Storage::kSqlite3, Storage::kMcap),
                         [](const auto& storage) {
                           return std::string(names_of(storage.param).name);
                         });

TEST_P(Flushes, OnlyWhenTheBagIsClosed) {
  const TemporaryFolder folder;
  auto writer = expect_value(BagWriter::create(folder / "run", {.storage = GetParam()}));
  const TopicId topic = expect_value(
      writer.add_topic({"/haptic/device/state", "voxtouch_msgs/msg/DeviceState", "cdr", "", 0}));
  const int before = flushes, replaced_before = replacements;
  for (std::uint64_t i = 0; i < 20001; ++i) {
    EXPECT_GOOD(writer.append(topic, static_cast<std::int64_t>(i), ring_message(9, i, 200)));
    if (i % 2000 != 0)
      continue;
    EXPECT_GOOD(writer.refresh());
    EXPECT_GOOD(writer.report({}));
  }
  EXPECT_EQ(flushes - before, 0);
  EXPECT_EQ(replacements - replaced_before, 0);
  EXPECT_GOOD(writer.close());
  const int file_and_metadata = flushes - before;
  EXPECT_GE(file_and_metadata, 2);
  RecordingReport last;
  last.closed = true;
  EXPECT_GOOD(writer.report(last));
  EXPECT_GT(flushes - before, file_and_metadata);
}

}  // namespace
}  // namespace voxtouch::bag
