/// Files written after a long run: refused at once, kept, or removed.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "nodes/cli/output_file.hpp"
#include "tests/support/file_count.hpp"
#include "tests/support/process/process.hpp"

namespace voxtouch::cli {
namespace {

class OutputFileTest : public testing::Test {
 protected:
  std::size_t files() const { return test::file_count(folder_.path()); }
  test::TemporaryFolder folder_;
};

TEST_F(OutputFileTest, HoldsTheTextOnceItIsKept) {
  OutputFile(folder_ / "a.csv").keep("1,2\n");
  std::ifstream in(folder_ / "a.csv");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "1,2\n");
  EXPECT_EQ(files(), 1u);
}

TEST_F(OutputFileTest, FailedRunWritesAndOverwritesNothing) {
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

TEST_F(OutputFileTest, RefusesAMissingFolderAndAFolder) {
  EXPECT_THROW(OutputFile(folder_ / "none" / "a.csv"), std::runtime_error);
  std::filesystem::create_directory(folder_ / "b");
  EXPECT_THROW(OutputFile(folder_ / "b"), std::runtime_error);
  EXPECT_EQ(files(), 1u);
}

}  // namespace
}  // namespace voxtouch::cli
