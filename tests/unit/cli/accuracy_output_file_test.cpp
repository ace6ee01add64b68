/// Files that are written after a long run: what is refused at once, what stays and what does not.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include <unistd.h>

#include "nodes/cli/output_file.hpp"

namespace voxtouch::cli {
namespace {

class OutputFileTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("voxtouch_output_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_), {}));
  }
  std::filesystem::path folder_;
};

TEST_F(OutputFileTest, HoldsTheTextOnceItIsKept) {
  OutputFile(folder_ / "a.csv").keep("1,2\n");
  std::ifstream in(folder_ / "a.csv");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "1,2\n");
  EXPECT_EQ(files(), 1u);
}

TEST_F(OutputFileTest, LeavesNothingAndOverwritesNothingWhereTheRunFailed) {
  OutputFile(folder_ / "a.csv").keep("old");
  { const OutputFile unused(folder_ / "a.csv"); }
  EXPECT_EQ(std::filesystem::file_size(folder_ / "a.csv"), 3u);
  EXPECT_EQ(files(), 1u);
}

/// A run that is broken off gets no destructor called.
TEST_F(OutputFileTest, HasNoFileWhileTheRunLasts) {
  OutputFile file(folder_ / "a.csv");
  EXPECT_EQ(files(), 0u);
  file.keep("1\n");
  EXPECT_EQ(files(), 1u);
}

TEST_F(OutputFileTest, RefusesAFolderThatIsNotThereAndAFolderItselfBeforeTheRun) {
  EXPECT_THROW(OutputFile(folder_ / "none" / "a.csv"), std::runtime_error);
  std::filesystem::create_directory(folder_ / "b");
  EXPECT_THROW(OutputFile(folder_ / "b"), std::runtime_error);
  EXPECT_EQ(files(), 1u);
}

}  // namespace
}  // namespace voxtouch::cli
