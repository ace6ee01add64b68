#include "nodes/console/reason.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>

namespace voxtouch::console {
namespace {

TEST(Reason, OfALongPathIsShortAndHasTheCause) {
  const std::string path(300, 'a');
  try {
    (void)std::filesystem::file_size(path);
    FAIL();
  } catch (const std::exception& error) {
    const std::string reason = reason_of(error);
    EXPECT_EQ(reason, "'" + path.substr(0, 64) + "...': File name too long");
  }
}

TEST(Reason, OfARefusedThreadNamesTheLimit) {
  const std::system_error refused(std::make_error_code(std::errc::resource_unavailable_try_again));
  EXPECT_TRUE(reason_of(refused).contains("ulimit -u"));
}

TEST(Reason, NamesAMissingProc) {
  const std::filesystem::filesystem_error missing(
      "read_symlink", "/proc/self/exe", std::make_error_code(std::errc::no_such_file_or_directory));
  EXPECT_TRUE(reason_of(missing).contains("mount /proc"));
}

TEST(Reason, OfOthersIsTheirOwn) {
  EXPECT_EQ(reason_of(std::runtime_error("the disk is full")), "the disk is full");
  EXPECT_EQ(reason_of(std::bad_alloc()), "out of memory");
}

}  // namespace
}  // namespace voxtouch::console
