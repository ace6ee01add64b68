// Effects of the environment variable. It is read once per process, so this separate program sets
// it first.
#include <cstdlib>

#include "library.hpp"

namespace voxtouch::hd_sim_test {
namespace {

/// Before the library is loaded.
const bool kSet =
    setenv("VOXTOUCH_HD_SIM", "virtual=1;model=omni;grip=pen-firm;seed=7;coulomb_nm=0", 1) == 0;

TEST(Environment, SetsWhatTheLibraryStartsFrom) {
  ASSERT_TRUE(kSet);
  ASSERT_NE(handle(), nullptr);
  phantom::hd::Api api;
  ASSERT_EQ(phantom::hd::resolve_api(api, [](const char* name) { return dlsym(handle(), name); }),
            "");
  decltype(&hdsim_step) step;
  find(step, "hdsim_step");
  ASSERT_NE(api.hdInitDevice(nullptr), phantom::hd::kInvalidHandle);
  EXPECT_STREQ(api.hdGetString(phantom::hd::kDeviceModelType), "PHANTOM Omni");
  api.hdStartScheduler();
  EXPECT_EQ(step(), 0);
  api.hdStopScheduler();
  api.hdDisableDevice(0);
}

}  // namespace
}  // namespace voxtouch::hd_sim_test
