/// The layout of --help.
#include <gtest/gtest.h>

#include <sstream>

#include "tests/golden/golden.hpp"

namespace voxtouch::test {
namespace {

/// Subcommands that the main help lists.
std::vector<std::string> verbs() {
  std::vector<std::string> found;
  std::istringstream lines(voxtouch({"--help"}).out);
  bool listed = false;
  for (std::string line; std::getline(lines, line);) {
    if (listed && line.size() > 2 && line[2] != ' ')
      found.push_back(line.substr(2, line.find(' ', 2) - 2));
    listed = listed || line == "Subcommands:";
  }
  return found;
}

TEST(Help, HasAtMost100Columns) {
  const std::vector<std::string> all = verbs();
  EXPECT_GT(all.size(), 15U);
  for (const std::string& verb : all) {
    const Finished run = voxtouch({verb, "--help"});
    EXPECT_EQ(run.status, 0) << verb;
    std::istringstream lines(run.out);
    for (std::string line; std::getline(lines, line);) {
      if (!line.starts_with("Usage: ")) {
        EXPECT_LE(line.size(), 100U) << verb << ": " << line;
      }
    }
  }
}

TEST(Help, KeepsTheLinesOfExamples) {
  const Finished run = voxtouch({"up", "--help"});
  EXPECT_NE(run.out.find("\n  voxtouch up cup_virtual_tool --motion slide --view\n"),
            std::string::npos)
      << run.out;
}

}  // namespace
}  // namespace voxtouch::test
