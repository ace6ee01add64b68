// Every fault of an emulator: the driver's error, the time of zero force at the plant, and the
// recovery.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>

#include "devices/lwr/lwr_driver.hpp"
#include "tests/support/process/process.hpp"
#include "tests/unit/driver_contract/subject.hpp"

namespace voxtouch::contract {
namespace {

using namespace std::chrono_literals;

std::unique_ptr<Subject> subject_of(const FaultCase& fault, bool virtual_time) {
  if (fault.plant == Plant::kPhantom)
    return phantom("premium", virtual_time);
  return fault.plant == Plant::kLwr ? lwr(virtual_time) : fr3(virtual_time);
}

bool reported(const FaultOutcome& o, devices::DeviceError error) {
  return std::find(o.reported.begin(), o.reported.end(), error) != o.reported.end();
}

class EveryFault : public testing::TestWithParam<std::size_t> {
 protected:
  const FaultCase& fault() const { return fault_cases()[GetParam()]; }
};

TEST_P(EveryFault, IsReportedWithZeroForceAndEndsAsExpected) {
  const auto subject = subject_of(fault(), true);
  const FaultOutcome o = run_fault(*subject, fault());
  EXPECT_EQ(name_of(o.after), name_of(fault().after));
  EXPECT_TRUE(o.good()) << o.largest_n << " N, " << o.largest_nm << " Nm";
  if (fault().after == After::kRefused) {
    EXPECT_GT(o.sentence.size(), 40u) << o.sentence;
    return;
  }
  EXPECT_TRUE(o.pushed) << o.before_n;
  if (fault().after == After::kRidesThrough) {
    EXPECT_TRUE(o.reported.empty());
    return;
  }
  ASSERT_FALSE(o.reported.empty());
  EXPECT_EQ(devices::name_of(o.reported.front()), devices::name_of(fault().reported));
  ASSERT_TRUE(o.zero_after_s);
  EXPECT_LE(*o.zero_after_s, o.bound_s + 1e-9);
  EXPECT_EQ(o.bound_s - subject->slack_s() > o.period_s + 1e-9, !fault().why.empty())
      << "longer than a period only with a reason";
  // In virtual time nothing waits, so a driver without input has nothing to report yet.
  if (fault().reported != devices::DeviceError::kTimeout) {
    EXPECT_GT(o.sentence.size(), 20u) << o.sentence;
  }
}

std::string fault_name(const testing::TestParamInfo<std::size_t>& i) {
  const FaultCase& fault = fault_cases()[i.param];
  const char* plant = fault.plant == Plant::kPhantom ? "phantom_"
                      : fault.plant == Plant::kLwr   ? "lwr_"
                                                     : "fr3_";
  return plant + std::string(fault.name);
}
INSTANTIATE_TEST_SUITE_P(Each, EveryFault, testing::Range<std::size_t>(0, fault_cases().size()),
                         fault_name);

/// Faults that are detected by clocks.
TEST(FaultInRealTime, IsZeroInTimeToo) {
  for (const FaultCase& fault : fault_cases()) {
    const bool one_of_them = fault.name == "comm_error" || fault.name == "timer_error" ||
                             fault.name == "skipped_ticks" || fault.name == "silent" ||
                             fault.name == "estop";
    if (!one_of_them)
      continue;
    SCOPED_TRACE(fault.name);
    const FaultOutcome o = run_fault(*subject_of(fault, false), fault);
    EXPECT_TRUE(o.good()) << o.before_n << " N before, " << o.largest_n << " N after";
    EXPECT_TRUE(reported(o, fault.reported));
    EXPECT_FALSE(o.sentence.empty());
    EXPECT_EQ(name_of(o.after), name_of(fault.after));
  }
}

TEST(Fault, KilledControllerDisconnectsAndTheDriverCloses) {
  const std::uint16_t port = arm::UdpSocket("127.0.0.1", 0).local().port;
  test::Process controller({std::string(VOXTOUCH_BIN) + "/voxtouch_fri_controller", "--remote",
                            "127.0.0.1:" + std::to_string(port), "--period-ms", "5"});
  lwr::LwrOptions options;
  options.address = "127.0.0.1";
  options.port = port;
  options.silence_s = 0.1;
  std::optional<lwr::LwrDriver> driver(options);
  const Wrench push{Vec3(3, 0, 0), Vec3::Zero()};
  int accepted = 0;
  for (int i = 0; i < 2000 && accepted < 20; ++i)
    accepted += driver->read(20ms) && driver->write(push);
  ASSERT_EQ(accepted, 20) << driver->status_text();
  controller.signal(SIGKILL);
  std::vector<devices::DeviceError> errors;
  for (int i = 0; i < 30; ++i) {
    const auto sample = driver->read(20ms);
    if (!sample)
      errors.push_back(sample.error());
    const auto written = driver->write(push);
    if (!sample) {
      EXPECT_FALSE(written);
    }
  }
  ASSERT_GT(errors.size(), 10u);
  EXPECT_EQ(errors.front(), devices::DeviceError::kTimeout);
  EXPECT_EQ(errors.back(), devices::DeviceError::kDisconnected);
  EXPECT_NE(driver->last_error().find("cable"), std::string::npos) << driver->last_error();
  const auto start = std::chrono::steady_clock::now();
  driver.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - start, 2s);
}

}  // namespace
}  // namespace voxtouch::contract
