// Folders of run files.
#include "nodes/cli/up/run_files.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "nodes/bag/bag_writer.hpp"
#include "tests/support/process/process.hpp"

namespace voxtouch::cli {
namespace {

class RunFiles : public testing::Test {
 protected:
  RunFiles() { ::setenv("XDG_DATA_HOME", data_.path().c_str(), 1); }
  ~RunFiles() override { ::unsetenv("XDG_DATA_HOME"); }
  test::TemporaryFolder data_;
};

TEST_F(RunFiles, HaveAFolderEachForConcurrentRuns) {
  constexpr int kRuns = 8, kEach = 20;
  std::vector<std::set<std::string>> made(kRuns);
  std::vector<std::thread> runs;
  for (std::set<std::string>& mine : made)
    runs.emplace_back([&mine] {
      for (int n = 0; n < kEach; ++n)
        mine.insert(make_default_bag("cup", {}).string());
    });
  for (std::thread& run : runs)
    run.join();
  std::set<std::string> all;
  for (const std::set<std::string>& mine : made)
    all.insert(mine.begin(), mine.end());
  EXPECT_EQ(all.size(), std::size_t{kRuns * kEach});
  for (const std::string& folder : all)
    EXPECT_TRUE(std::filesystem::is_directory(folder)) << folder;
}

TEST_F(RunFiles, DoNotJoinFaultRecordsOfAnEarlierRun) {
  const std::filesystem::path first = make_default_bag("cup", {});
  std::filesystem::create_directory(fault_folder_of(first));
  std::filesystem::remove(first);
  for (int n = 0; n < 3; ++n)
    EXPECT_FALSE(std::filesystem::exists(fault_folder_of(make_default_bag("cup", {}))));
}

TEST_F(RunFiles, LeaveNoEmptyFolder) {
  std::filesystem::path empty, full;
  {
    const EmptyFolderGuard one(make_default_bag("cup", {})), two(make_default_bag("cup", {}));
    empty = one.folder(), full = two.folder();
    std::filesystem::create_directory(full / "part");
  }
  EXPECT_FALSE(std::filesystem::exists(empty));
  EXPECT_TRUE(std::filesystem::exists(full));
}

TEST_F(RunFiles, HoldABagOnlyInAnEmptyFolder) {
  const std::filesystem::path folder = make_default_bag("cup", {});
  EXPECT_FALSE(bag::BagWriter::create(folder)) << "not said to be made for it";
  EXPECT_TRUE(bag::BagWriter::create(folder, {.folder_is_made = true}));
  EXPECT_FALSE(bag::BagWriter::create(folder, {.folder_is_made = true})) << "a bag is in it";
}

}  // namespace
}  // namespace voxtouch::cli
