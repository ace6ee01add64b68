// A mistake in the environment variable gives no device, instead of another one.
#include <cstdlib>

#include "library.hpp"

namespace voxtouch::hd_sim_test {
namespace {

const bool kSet = setenv("VOXTOUCH_HD_SIM", "model=omni;coulomb_nm=much", 1) == 0;

TEST(BadEnvironment, MeansThatNoDeviceIsFound) {
  ASSERT_TRUE(kSet);
  ASSERT_NE(handle(), nullptr);
  phantom::hd::Api api;
  ASSERT_EQ(phantom::hd::resolve_api(api, [](const char* name) { return dlsym(handle(), name); }),
            "");
  EXPECT_EQ(api.hdInitDevice(nullptr), phantom::hd::kInvalidHandle);
  EXPECT_EQ(api.hdGetError().error_code, phantom::hd::kCommConfigError);
}

}  // namespace
}  // namespace voxtouch::hd_sim_test
