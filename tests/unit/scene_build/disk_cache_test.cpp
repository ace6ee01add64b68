// The folder of built scenes: bounded, shared by programs that start together, and no fault where
// it cannot be used.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <thread>

#include "nodes/scene_build/cache_file.hpp"
#include "nodes/scene_build/cache_options.hpp"
#include "nodes/scene_build/disk_cache.hpp"
#include "tests/support/file_count.hpp"
#include "tests/support/process/process.hpp"

namespace voxtouch::test::disk_cache {
namespace {

using scene_build::DiskCache;

TEST(SceneDiskCache, FindsWhatWasKeptAndNothingElse) {
  const TemporaryFolder folder;
  DiskCache cache(folder / "new" / "scenes", 10'000, "test");
  EXPECT_EQ(cache.find("one").memory, nullptr);
  cache.keep("one", "built one");
  cache.keep("two", "built two");
  EXPECT_EQ(cache.find("one").content, "built one");
  EXPECT_EQ(cache.find("two").content, "built two");
  EXPECT_EQ(cache.find("three").memory, nullptr);
  cache.keep("one", "built again");
  EXPECT_EQ(cache.find("one").content, "built again");
}

TEST(SceneDiskCache, ReplacesAFileThatIsNotRight) {
  const TemporaryFolder folder;
  DiskCache cache(folder.path(), 10'000, "test");
  cache.keep("one", "built one");
  std::ofstream(cache.file_of("one"), std::ios::binary | std::ios::in | std::ios::out)
      .seekp(40)
      .put('\x55')
      .put('\x66');
  EXPECT_EQ(cache.find("one").memory, nullptr);
  cache.keep("one", "built one");
  EXPECT_EQ(cache.find("one").content, "built one");
}

TEST(SceneDiskCache, ForgetsWhatWasUsedLongestAgo) {
  const TemporaryFolder folder;
  DiskCache cache(folder.path(), 4'000, "test");
  const std::string kilo(1'000, 'x');
  const auto used = [&](const std::string& recipe, int hours_ago) {
    std::filesystem::last_write_time(
        cache.file_of(recipe),
        std::filesystem::file_time_type::clock::now() - std::chrono::hours(hours_ago));
  };
  for (const char* recipe : {"a", "b", "c"})
    cache.keep(recipe, kilo);
  used("a", 3), used("b", 2), used("c", 1);
  EXPECT_NE(cache.find("a").memory, nullptr);  // used now
  cache.keep("d", kilo);                       // more than 4000 bytes with their heads
  EXPECT_FALSE(std::filesystem::exists(cache.file_of("b")));
  for (const char* recipe : {"a", "c", "d"})
    EXPECT_NE(cache.find(recipe).memory, nullptr) << recipe;
  cache.keep("larger than all", std::string(5'000, 'x'));
  EXPECT_EQ(file_count(folder.path()), 3U);
  cache.keep("whole", std::string(3'900, 'x'));
  EXPECT_NE(cache.find("whole").memory, nullptr);
  EXPECT_EQ(file_count(folder.path()), 1U);
}

TEST(SceneDiskCache, ClearsWhatProgramsThatWereEndedLeft) {
  const TemporaryFolder folder;
  DiskCache cache(folder.path(), 4'000, "test");
  const std::filesystem::path old = cache.file_of("a").string() + ".AbCdEf",
                              fresh = cache.file_of("a").string() + ".GhIjKl",
                              other = folder / "notes.txt";
  for (const auto& file : {old, fresh, other})
    std::ofstream(file) << "half";
  for (const auto& file : {old, other})
    std::filesystem::last_write_time(
        file, std::filesystem::file_time_type::clock::now() - std::chrono::hours(2));
  cache.keep("b", "built");
  EXPECT_FALSE(std::filesystem::exists(old));
  EXPECT_TRUE(std::filesystem::exists(fresh) && std::filesystem::exists(other));
}

TEST(SceneDiskCache, ServesManyAtOnceThatWriteReadAndForget) {
  const TemporaryFolder folder;
  const auto content_of = [](int number) {
    return std::string(20'000, static_cast<char>('a' + number));
  };
  std::atomic<int> wrong{0}, found{0};
  std::vector<std::thread> programs;
  for (int p = 0; p < 6; ++p)
    programs.emplace_back([&, p] {
      DiskCache cache(folder.path(), 90'000, "test");  // room for four of six
      for (int n = 0; n < 60; ++n) {
        const int which = (p + n) % 6;
        const std::string recipe = "recipe " + std::to_string(which);
        if (const rendering::Kept kept = cache.find(recipe); kept.memory)
          ++found, wrong += kept.content != content_of(which);
        else
          cache.keep(recipe, content_of(which));
      }
    });
  for (std::thread& program : programs)
    program.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(found, 0);
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    EXPECT_EQ(entry.path().extension(), ".scene");
  EXPECT_LE(file_count(folder.path()), 5U);
}

TEST(SceneDiskCache, ThatCannotBeWrittenIsSaidAndNoFault) {
  const TemporaryFolder folder;
  std::ofstream(folder / "file") << "in the way";
  testing::internal::CaptureStderr();
  DiskCache cache(folder / "file" / "scenes", 10'000, "test");
  cache.keep("one", "built one");
  EXPECT_EQ(cache.find("one").memory, nullptr);
  DiskCache nowhere({}, 10'000, "test");
  nowhere.keep("one", "built one");
  EXPECT_EQ(nowhere.find("one").memory, nullptr);
}

TEST(SceneDiskCache, LiesWhereTheUserHasSuchThings) {
  const auto folder_with = [](const char* cache, const char* home) {
    ::setenv("XDG_CACHE_HOME", cache, 1), ::setenv("HOME", home, 1);
    return scene_build::cache_folder().string();
  };
  const char* was = std::getenv("XDG_CACHE_HOME");
  const std::string before = was ? was : "", home = std::getenv("HOME") ? std::getenv("HOME") : "";
  EXPECT_EQ(folder_with("/var/cache", "/home/me"), "/var/cache/voxtouch/scenes");
  EXPECT_EQ(folder_with("", "/home/me"), "/home/me/.cache/voxtouch/scenes");
  EXPECT_EQ(folder_with("not/absolute", "/home/me"), "/home/me/.cache/voxtouch/scenes");
  EXPECT_EQ(folder_with("", ""), "");
  ::setenv("HOME", home.c_str(), 1);
  was ? ::setenv("XDG_CACHE_HOME", before.c_str(), 1) : ::unsetenv("XDG_CACHE_HOME");
}

TEST(SceneDiskCache, IsNotOpenedWhereItIsOff) {
  EXPECT_EQ(scene_build::open_cache({}, "test"), nullptr)
      << "no test may find what another one built";
  ::unsetenv("VOXTOUCH_NO_CACHE");
  EXPECT_NE(scene_build::open_cache({}, "test"), nullptr);
  EXPECT_EQ(scene_build::open_cache({.off = true}, "test"), nullptr);
  ::setenv("VOXTOUCH_NO_CACHE", "1", 1);
  std::vector<std::string> words;
  scene_build::append_arguments({}, words);
  EXPECT_TRUE(words.empty());
  scene_build::append_arguments({.most_mb = 20}, words);
  scene_build::append_arguments({.off = true}, words);
  EXPECT_EQ(words, (std::vector<std::string>{"--cache-mb", "20", "--no-cache"}));
}

}  // namespace
}  // namespace voxtouch::test::disk_cache
