// Finding and loading the library. The order of the tests matters in one process: a loaded library
// stays.
#include <gtest/gtest.h>

#include <string>

#include "devices/phantom/hd_library.hpp"
#include "devices/phantom/phantom_driver.hpp"

namespace voxtouch::phantom {
namespace {

std::string refusal(const std::string& path) {
  try {
    HdLibrary::load(path);
  } catch (const devices::DeviceOpenError& error) {
    return error.what();
  }
  return "";
}

bool says(const std::string& sentence, const std::string& part) {
  return sentence.find(part) != std::string::npos;
}

TEST(HdLibrary, GivenPathIsTheOnlyOneTried) {
  const std::string sentence = refusal("/nowhere/libHD_none.so");
  EXPECT_TRUE(says(sentence, "/nowhere/libHD_none.so")) << sentence;
  EXPECT_FALSE(says(sentence, "libHD.so.3")) << sentence;
}

TEST(HdLibrary, MissingIsReportedWithTriedNamesAndRemedy) {
  const std::string sentence = refusal("");
  if (sentence.empty())
    GTEST_SKIP() << "this machine has the vendor's library";
  for (const char* part :
       {"libHD.so:", "libHD.so.3.4", "libHD.so.3.0", "Install", "option library"})
    EXPECT_TRUE(says(sentence, part)) << sentence;
  PhantomOptions options;
  EXPECT_THROW(PhantomDriver{options}, devices::DeviceOpenError);
}

TEST(HdLibrary, ForeignLibraryIsNamedWithMissingSymbols) {
  const std::string sentence = refusal("libm.so.6");
  EXPECT_TRUE(says(sentence, "libm.so.6")) << sentence;
  EXPECT_TRUE(says(sentence, "hdInitDevice")) << sentence;
}

TEST(HdLibrary, IsLoadedOnceAndStays) {
  const HdLibrary& first = HdLibrary::load(VOXTOUCH_HD_SIM_LIBRARY);
  EXPECT_EQ(first.name(), VOXTOUCH_HD_SIM_LIBRARY);
  EXPECT_NE(first.api().hdGetError, nullptr);
  EXPECT_TRUE(first.hooks().complete());
  EXPECT_EQ(&HdLibrary::load(VOXTOUCH_HD_SIM_LIBRARY), &first);
  EXPECT_EQ(&HdLibrary::load(), &first);
  const std::string sentence = refusal("/nowhere/libHD_none.so");
  EXPECT_TRUE(says(sentence, "another process")) << sentence;
}

TEST(HdLibrary, OneWithoutTheHooksHasNoVirtualTime) {
  // The vendor's library from the driver's view.
  const_cast<HdSimHooks&>(HdLibrary::load(VOXTOUCH_HD_SIM_LIBRARY).hooks()) = {};
  PhantomOptions options;
  options.library = VOXTOUCH_HD_SIM_LIBRARY;
  PhantomDriver driver(options);
  EXPECT_FALSE(driver.simulated());
  EXPECT_TRUE(driver.read(std::chrono::seconds(1)));
}

}  // namespace
}  // namespace voxtouch::phantom
