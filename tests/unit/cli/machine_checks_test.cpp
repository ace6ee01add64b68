#include "nodes/cli/doctor/machine_checks.hpp"

#include <gtest/gtest.h>

#include <fstream>

namespace voxtouch::cli {
namespace machine_checks_test {

namespace fs = std::filesystem;

/// A temporary file system with the files that the checks read.
class Root : public testing::Test {
 protected:
  Root()
      : root_(fs::path(testing::TempDir()) /
              testing::UnitTest::GetInstance()->current_test_info()->name()) {
    fs::remove_all(root_);
  }
  ~Root() override { fs::remove_all(root_); }
  void put(const std::string& file, const std::string& text) const {
    fs::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << text << '\n';
  }
  fs::path root_;
};

using MachineChecks = Root;

TEST_F(MachineChecks, DetectARealTimeKernelByEitherSign) {
  put("proc/sys/kernel/osrelease", "6.1.0-18-amd64");
  put("proc/version", "Linux version 6.1.0-18-amd64 #1 SMP PREEMPT_DYNAMIC");
  EXPECT_EQ(check_kernel(root_).health, Health::kWarning);
  EXPECT_TRUE(check_kernel(root_).sentence.contains("6.1.0-18-amd64"))
      << check_kernel(root_).sentence;
  EXPECT_TRUE(check_kernel(root_).sentence.contains("linux-image-rt-amd64"));
  put("proc/version", "Linux version 6.1.0-18-rt-amd64 #1 SMP PREEMPT_RT");
  EXPECT_EQ(check_kernel(root_).health, Health::kGood);
  put("proc/version", "Linux");
  put("sys/kernel/realtime", "1");
  EXPECT_EQ(check_kernel(root_).health, Health::kGood);
}

TEST_F(MachineChecks, NameGovernorsThatChangeTheClockAndTheCommand) {
  EXPECT_EQ(check_governors(root_).health, Health::kGood) << "none is reported";
  put("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance");
  EXPECT_EQ(check_governors(root_).health, Health::kGood);
  put("sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "powersave");
  EXPECT_TRUE(check_governors(root_).sentence.contains("performance, powersave"))
      << check_governors(root_).sentence;
  EXPECT_TRUE(check_governors(root_).sentence.contains("`cpupower frequency-set -g performance`"));
}

TEST_F(MachineChecks, NameWirelessAndSlowCards) {
  EXPECT_TRUE(check_link("eth0", root_).empty());
  put("sys/class/net/eth0/speed", "1000");
  EXPECT_TRUE(check_link("eth0", root_).empty());
  put("sys/class/net/eth0/speed", "-1");
  EXPECT_TRUE(check_link("eth0", root_).empty()) << "unknown";
  put("sys/class/net/eth0/speed", "10");
  EXPECT_EQ(check_link("eth0", root_).size(), 1U);
  put("sys/class/net/wlan0/wireless/x", "");
  ASSERT_EQ(check_link("wlan0", root_).size(), 1U);
  EXPECT_TRUE(check_link("wlan0", root_)[0].sentence.contains("a cable"));
}

TEST_F(MachineChecks, FindUsbDevicesAndTheirPermissions) {
  ASSERT_EQ(check_devices(root_).size(), 1U);
  EXPECT_EQ(check_devices(root_)[0].health, Health::kGood);
  for (const auto& [key, value] : {std::pair{"idVendor", "2988"}, std::pair{"idProduct", "0302"},
                                   std::pair{"busnum", "1"}, std::pair{"devnum", "7"}})
    put(std::string("sys/bus/usb/devices/1-2/") + key, value);
  put("sys/bus/usb/devices/1-3/idVendor", "0403");  // the maker of the Falcon's chip makes others
  put("sys/bus/usb/devices/1-3/idProduct", "6001");
  std::vector<Finding> findings = check_devices(root_);
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].health, Health::kWarning);
  EXPECT_TRUE(findings[0].sentence.contains("3D Systems Touch")) << findings[0].sentence;
  EXPECT_TRUE(findings[0].sentence.contains("dev/bus/usb/001/007")) << findings[0].sentence;
  EXPECT_TRUE(findings[1].sentence.contains("libHD.so"));
  put("dev/bus/usb/001/007", "");
  put("usr/lib/libHD.so.3.4", "");
  findings = check_devices(root_);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].health, Health::kGood);
}

TEST_F(MachineChecks, FindAnOlderTouchAndNoOtherDeviceOfItsVendor) {
  for (const auto& [product, found] : {std::pair{"2988", true}, std::pair{"0302", false}}) {
    put("sys/bus/usb/devices/1-2/idVendor", "0301");
    put("sys/bus/usb/devices/1-2/idProduct", product);
    const std::vector<Finding> findings = check_devices(root_);
    EXPECT_EQ(findings.front().sentence.contains("3D Systems Touch"), found) << product;
  }
}

TEST(MachineLimits, AreReportedAsNumbers) {
  EXPECT_TRUE(check_limits().sentence.contains("rtprio ")) << check_limits().sentence;
}

}  // namespace machine_checks_test
}  // namespace voxtouch::cli
