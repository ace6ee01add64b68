// A file of the cache is read whole and right, or not at all.
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <fstream>
#include <iterator>
#include <random>

#include "nodes/scene_build/cache_file.hpp"
#include "tests/support/file_count.hpp"
#include "tests/support/process/process.hpp"

namespace voxtouch::test::cache_file {
namespace {

using scene_build::read_cache_file;

constexpr std::uint64_t kMax = 1'000'000;
const std::string kRecipe = "flour, water and salt";

class CacheFile : public testing::Test {
 protected:
  CacheFile() : file_(folder_ / "a.scene") {
    std::mt19937_64 random(3);
    for (int n = 0; n < 1000; ++n)
      content_ += static_cast<char>(random());
    scene_build::write_cache_file(file_, kRecipe, content_);
  }
  std::string bytes() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void put(const std::string& bytes) const {
    std::ofstream(file_, std::ios::binary | std::ios::trunc) << bytes;
  }
  std::string why_not(const std::string& recipe = kRecipe, std::uint64_t most = kMax) const {
    try {
      EXPECT_TRUE(read_cache_file(file_, recipe, most).memory != nullptr);
      return {};
    } catch (const std::runtime_error& error) {
      return error.what();
    }
  }

  TemporaryFolder folder_;
  std::filesystem::path file_;
  std::string content_;
};

TEST_F(CacheFile, GivesBackWhatWasWrittenAndIsThisUsersAlone) {
  EXPECT_TRUE(read_cache_file(file_, kRecipe, kMax).content == content_);
  struct stat is {};
  ASSERT_EQ(::stat(file_.c_str(), &is), 0);
  EXPECT_EQ(is.st_mode & 0777, 0600U);
  EXPECT_EQ(file_count(folder_.path()), 1U) << "nothing is left beside it";
}

TEST_F(CacheFile, ThatIsNotThereIsNoFault) {
  EXPECT_EQ(read_cache_file(folder_ / "none.scene", kRecipe, kMax).memory, nullptr);
}

TEST_F(CacheFile, IsRefusedWithAnyBitOfItChanged) {
  const std::string whole = bytes();
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ (1 << at % 8));
    put(changed);
    EXPECT_FALSE(why_not().empty()) << at;
  }
  put(whole);
  EXPECT_EQ(why_not(), "");
}

TEST_F(CacheFile, IsRefusedWhereverItIsCutOrLonger) {
  const std::string whole = bytes();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    put(whole.substr(0, size));
    EXPECT_FALSE(why_not().empty()) << size;
  }
  put(whole + '\0');
  EXPECT_FALSE(why_not().empty());
}

TEST_F(CacheFile, IsRefusedForAnotherRecipe) {
  std::string other = kRecipe;
  other.back() = 'z';
  EXPECT_FALSE(why_not(other).empty());
  EXPECT_FALSE(why_not(kRecipe + "!").empty());
  EXPECT_FALSE(why_not("").empty());
}

TEST_F(CacheFile, IsRefusedWhereItIsTooLargeForTheMemoryThatItMayTake) {
  EXPECT_FALSE(why_not(kRecipe, content_.size() - 1).empty());
  EXPECT_EQ(why_not(kRecipe, content_.size()), "");
}

TEST_F(CacheFile, ThatOthersMayWriteIsRefused) {
  for (const mode_t mode : {0620U, 0602U, 0644U}) {
    ASSERT_EQ(::chmod(file_.c_str(), mode), 0);
    EXPECT_EQ(why_not().empty(), mode == 0644U) << mode;
  }
}

TEST_F(CacheFile, ThatIsNoRegularFileIsRefusedWithoutWaiting) {
  std::filesystem::rename(file_, folder_ / "elsewhere");
  std::filesystem::create_symlink(folder_ / "elsewhere", file_);
  EXPECT_FALSE(why_not().empty());
  std::filesystem::remove(file_);
  ASSERT_EQ(::mkfifo(file_.c_str(), 0600), 0);
  EXPECT_FALSE(why_not().empty());
  std::filesystem::remove(file_);
  std::filesystem::create_directory(file_);
  EXPECT_FALSE(why_not().empty());
}

TEST_F(CacheFile, IsMarkedAsUsedWhenItIsRead) {
  const auto long_ago = std::filesystem::file_time_type::clock::now() - std::chrono::hours(48);
  std::filesystem::last_write_time(file_, long_ago);
  EXPECT_EQ(why_not(), "");
  EXPECT_GT(std::filesystem::last_write_time(file_), long_ago + std::chrono::hours(47));
}

}  // namespace
}  // namespace voxtouch::test::cache_file
