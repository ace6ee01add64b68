// The device's loop with a device that fails in every way a driver may, commanded over real DDS.
#include "nodes/device/device_loop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <mutex>
#include <vector>

#include "nodes/runtime/clock.hpp"
#include "tests/ring/ring_run.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::device_node {
namespace {

/// Fails at the samples it is reported to; remembers every force it was given.
class FaultyDevice final : public devices::Driver {
 public:
  std::map<std::uint64_t, devices::DeviceError> read_faults,
      write_faults;  ///< by the number of the read
  std::map<std::uint64_t, devices::DeviceSample> odd_samples;
  std::vector<double> pushed;  ///< force after each read [N]; 0 if it failed
  double force = 0.0;
  int stops = 0;
  bool paces = false;  ///< as a real device: `read` waits for the tick of a clock that is not ours
  std::vector<double> delays_ms;  ///< from a tick to the write that answers it
  int skipped_ticks = 0;
  std::uint64_t busy_at = 0;  ///< before this read the thread is blocked for three ticks
  std::function<void(std::uint64_t)> at_read;  ///< called at each
  std::map<std::uint64_t, int>
      stops_ms;  ///< at these reads the whole process is stopped for so long: its own clock too

  FaultyDevice() {
    description_.model = "faulty";
    description_.max_force_n = 8.5;
    description_.max_torque_nm = 0.5;
    description_.max_force_rate_n_per_s = 5'000.0;
    description_.max_torque_rate_nm_per_s = 500.0;
  }
  const DeviceDescription& description() const noexcept override { return description_; }
  devices::DeviceResult<devices::DeviceSample> read(std::chrono::microseconds) noexcept override {
    pushed.push_back(force);
    ++reads_;
    if (at_read)
      at_read(reads_);
    if (paces)
      wait_for_tick();
    if (const auto stop = stops_ms.find(reads_); stop != stops_ms.end())
      runtime::sleep_until(runtime::monotonic_ns() + stop->second * 1'000'000);
    if (const auto fault = read_faults.find(reads_); fault != read_faults.end())
      return std::unexpected(fault->second);
    const auto time_ns = paces ? tick_ns_ : static_cast<std::int64_t>(reads_) * 1'000'000;
    if (const auto odd = odd_samples.find(reads_); odd != odd_samples.end()) {
      devices::DeviceSample sample = odd->second;
      sample.time_ns = time_ns;
      return sample;
    }
    devices::DeviceSample sample;
    sample.time_ns = time_ns;
    sample.pose.position = {0.0, 0.0, 0.5};
    return sample;
  }
  devices::DeviceResult<void> write(const Wrench& command) noexcept override {
    if (const auto fault = write_faults.find(reads_); fault != write_faults.end()) {
      force = 0.0;
      return std::unexpected(fault->second);
    }
    force = command.force.norm();
    if (paces)
      delays_ms.push_back(static_cast<double>(runtime::monotonic_ns() - tick_ns_) * 1e-6);
    return {};
  }
  void stop() noexcept override { force = 0.0, ++stops; }
  bool simulated() const noexcept override { return !paces; }
  std::uint64_t reads() const { return reads_; }

  void set_rate(double rate_hz) { description_.rate_hz = rate_hz; }

 private:
  void wait_for_tick() {
    constexpr std::int64_t kTickNs = 4'150'000;  // it declares 4 ms, and its clock is off
    if (tick_ns_ == 0)
      tick_ns_ = runtime::monotonic_ns();
    if (reads_ == busy_at)
      runtime::sleep_until(tick_ns_ + 3 * kTickNs + kTickNs / 2);
    const auto next = runtime::next_deadline(tick_ns_, runtime::monotonic_ns(), kTickNs);
    skipped_ticks += static_cast<int>(next.skipped);
    runtime::sleep_until(tick_ns_ = next.at_ns);
  }

  std::int64_t tick_ns_ = 0;
  DeviceDescription description_;
  std::uint64_t reads_ = 0;
};

/// A loop of 1200 samples, each answered with 2 N.
class DeviceLoopRun : public testing::Test {
 protected:
  DeviceLoopRun() : participant_({test::kDomain, "lo", "device_loop_test"}), rig_(test::own_rig()) {
    device.pushed.reserve(4'000);
  }

  End run(std::uint64_t samples = 1200) {
    const auto& stream = qos::profile(qos::ProfileId::kStream);
    bus::Writer<msg::DeviceState> states(participant_, qos::kDeviceState, rig_, stream);
    bus::FollowedReader<msg::ForceCommand> commands(participant_, qos::kForceCommand, rig_, stream);
    bus::WaitSet wait_set(participant_);
    wait_set.attach(commands.condition());
    test::NodeThread coupling([this](const std::atomic<bool>& enough) { return answer(enough); });
    DeviceLoop loop({.session_id = 7, .max_samples = samples}, device, states, commands, wait_set,
                    progress, requests, *faults);
    test::wait_until([&] { return commands.matched_count() == 1 && states.matched_count() == 1; });
    EXPECT_TRUE(commands.following().follow(commands.matched().at(0)));
    const std::int64_t begin = runtime::monotonic_ns();
    const End end = loop.run(stop);
    took_s = static_cast<double>(runtime::monotonic_ns() - begin) * 1e-9;
    return end;
  }

  /// Of the forces after these reads. The machine may stall in between, so single ones are not
  /// conclusive.
  double largest(std::ptrdiff_t first, std::ptrdiff_t last) const {
    return *std::max_element(device.pushed.begin() + first, device.pushed.begin() + last);
  }

  FaultyDevice device;
  std::unique_ptr<Faults> faults = make_faults({}, "r", 1000.0);
  Progress progress;
  Requests requests;
  std::atomic<double> commanded_n{2.0};
  std::atomic<bool> stop{false};
  std::vector<msg::DeviceState> seen;
  double took_s = 0.0;

 private:
  int answer(const std::atomic<bool>& enough) {
    const bus::Participant participant({test::kDomain, "lo", "fake_coupling"});
    bus::Reader<msg::DeviceState> states(participant, qos::kDeviceState, rig_,
                                         qos::profile(qos::ProfileId::kStream));
    bus::Writer<msg::ForceCommand> commands(participant, qos::kForceCommand, rig_,
                                            qos::profile(qos::ProfileId::kStream));
    bus::WaitSet wait_set(participant);
    wait_set.attach(states.condition());
    while (!enough.load()) {
      wait_set.wait(10'000'000);
      msg::DeviceState state;
      while (states.take(state)) {
        seen.push_back(state);
        msg::ForceCommand command{};
        command.session_id = state.session_id;
        command.sequence_number = state.sequence_number;
        command.sample_time_ns = state.sample_time_ns;
        command.valid_until_ns = state.sample_time_ns + 5'000'000;
        command.wrench.force.x = commanded_n;
        commands.write(command);
      }
    }
    return 0;
  }

  bus::Participant participant_;
  std::string rig_;
};

TEST_F(DeviceLoopRun, PushesAsCommandedAndEndsAtZero) {
  EXPECT_EQ(run(), End::kFinished);
  EXPECT_GT(largest(1000, 1200), 1.5) << "without a force the other cases show nothing";
  EXPECT_EQ(device.force, 0.0);
  EXPECT_EQ(progress.counters[DeviceCounter::kInterruptions], 0);
}

TEST_F(DeviceLoopRun, MissedSampleInterruptsButDoesNotEnd) {
  device.read_faults = {{900, devices::DeviceError::kTimeout},
                        {901, devices::DeviceError::kProtocol},
                        {902, devices::DeviceError::kRecoverable}};
  EXPECT_EQ(run(), End::kFinished);
  EXPECT_EQ(progress.counters[DeviceCounter::kSamples], 1200);
  EXPECT_EQ(progress.counters[DeviceCounter::kInterruptions], 1)
      << "three failures in a row are one";
  EXPECT_EQ(progress.counters[DeviceCounter::kZeroForce], 3);
  EXPECT_EQ(progress.last_error.load(), devices::DeviceError::kRecoverable);
  EXPECT_GT(largest(700, 900), 1.5) << "the force before the interruption";
  EXPECT_EQ(device.pushed[900], 0.0) << "zero force at once";
  EXPECT_EQ(device.pushed[902], 0.0);
  EXPECT_LT(device.pushed[920], 0.5) << "the force comes back in a ramp";
  EXPECT_GT(largest(1000, 1200), 0.5);
  EXPECT_FALSE(progress.has_error.load());
}

TEST_F(DeviceLoopRun, KeepsItsRecordOfADroppedForce) {
  const test::TemporaryFolder folder;
  faults = make_faults(folder.path(), "r", 1000.0);
  device.write_faults = {{900, devices::DeviceError::kRecoverable}};
  EXPECT_EQ(run(), End::kFinished);
  faults.reset();  // writes the pending record
  const auto states =
      test::read_ring_topic<msg::DeviceState>(folder / "device_1", "/r/device/state");
  ASSERT_FALSE(states.empty());
  EXPECT_NEAR(static_cast<double>(states.back().sequence_number), 899.0, 1.0);
  EXPECT_EQ(states.front().sequence_number, 0U);
  const auto given =
      test::read_ring_topic<msg::ForceCommand>(folder / "device_1", "/r/device/given");
  EXPECT_GT(given.back().wrench.force.x, 1.5);
  EXPECT_FALSE(std::filesystem::exists(folder / "device_2"));
  EXPECT_NE(faults::fault_records_in(folder.path()).at(0).find("force"), std::string::npos);
}

TEST_F(DeviceLoopRun, LatchesForTooLargeCommandsUntilReset) {
  commanded_n = 20.0;
  std::uint64_t number = 0;
  device.at_read = [&](std::uint64_t n) {
    if (n == 1800) {
      runtime::NodeReport report;
      progress.latch.report_to(report);
      number = std::stoull("0" + report.values["fault_latch"]);
      commanded_n = 2.0;
      progress.latch.reset(number + 1);
    }
    if (n == 2000)
      progress.latch.reset(number);
  };
  EXPECT_EQ(run(3500), End::kFinished);
  EXPECT_NE(number, 0U);
  EXPECT_GT(largest(50, 1700), 0.5) << "it had begun to push, and it is cut to the limit";
  EXPECT_EQ(largest(1750, 1999), 0.0) << "no force: another number does not reset it";
  EXPECT_LT(largest(2000, 2100), 1.0) << "ramps in";
  EXPECT_GT(largest(3000, 3500), 1.5);
}

/// One command in twenty is above the limit, then one in four.
TEST_F(DeviceLoopRun, LatchesOnlyIfATenthExceedsTheLimit) {
  bool locked_early = true;
  device.at_read = [&](std::uint64_t n) {
    if (n == 2000)
      locked_early = progress.latch.latched();
    commanded_n = n % (n < 2000 ? 20 : 4) == 0 ? 20.0 : 2.0;
  };
  EXPECT_EQ(run(3500), End::kFinished);
  EXPECT_FALSE(locked_early);
  EXPECT_TRUE(progress.latch.latched());
}

TEST_F(DeviceLoopRun, LatchesIfTheDriverRefusesAGuardedForce) {
  device.write_faults = {{800, devices::DeviceError::kLimit}};
  EXPECT_EQ(run(), End::kFinished);
  EXPECT_GT(largest(700, 800), 1.5);
  EXPECT_EQ(largest(801, 1200), 0.0);
  EXPECT_TRUE(progress.latch.latched());
}

TEST_F(DeviceLoopRun, RampsInAgainAfterADroppedForce) {
  for (std::uint64_t i = 800; i < 810; ++i)
    device.write_faults[i] = devices::DeviceError::kRecoverable;
  EXPECT_EQ(run(), End::kFinished);
  EXPECT_EQ(progress.counters[DeviceCounter::kInterruptions], 1);
  EXPECT_EQ(progress.counters[DeviceCounter::kZeroForce], 10);
  EXPECT_EQ(device.pushed[809], 0.0);
  EXPECT_LT(device.pushed[830], 0.5);
  EXPECT_GT(largest(1000, 1200), 0.5);
}

TEST_F(DeviceLoopRun, ReleasesTheHeldForceAfterAProcessStop) {
  device.stops_ms = {{800, 40}};
  EXPECT_EQ(run(), End::kFinished);
  EXPECT_GT(largest(700, 800), 1.5) << "the force before the stop";
  EXPECT_EQ(device.pushed[800], 0.0) << "zero force at once";
  EXPECT_LT(device.pushed[830], 0.5) << "the force comes back in a ramp";
  EXPECT_GT(largest(1000, 1200), 0.5);
  EXPECT_GE(progress.counters[DeviceCounter::kInterruptions], 1);
  EXPECT_GE(progress.counters[DeviceCounter::kLongestGap], 40.0);
  EXPECT_EQ(progress.counters[DeviceCounter::kSamples], 1200);
}

TEST_F(DeviceLoopRun, ContinuesAfterAShortStop) {
  device.stops_ms = {{800, 2}};
  EXPECT_EQ(run(), End::kFinished);
  EXPECT_GT(largest(801, 803), 0.5);
}

TEST_F(DeviceLoopRun, KeepsTheLargestForceForSlowReaders) {
  EXPECT_EQ(run(), End::kFinished);
  EXPECT_EQ(progress.counters[DeviceCounter::kForce], 0.0) << "it has ended";
  EXPECT_EQ(progress.counters.take(DeviceCounter::kRecentForce),
            progress.counters[DeviceCounter::kMaxForce]);
  EXPECT_GT(progress.counters[DeviceCounter::kMaxForce], 1.5);
}

TEST_F(DeviceLoopRun, ReportsTheFirstAnsweredSampleAndItsRun) {
  EXPECT_TRUE(std::isnan(progress.counters[DeviceCounter::kFirstAnswered]));
  const std::uint64_t before = progress.heartbeat.sign();
  EXPECT_EQ(run(), End::kFinished);
  EXPECT_LT(progress.counters[DeviceCounter::kFirstAnswered], 1000.0);
  EXPECT_GE(progress.heartbeat.sign() - before, 1200U);
}

TEST_F(DeviceLoopRun, CountsNoInterruptionWhileADeviceGetsReady) {
  for (std::uint64_t i = 1; i <= 300; ++i)
    device.write_faults[i] = devices::DeviceError::kRecoverable;
  device.write_faults[800] = devices::DeviceError::kRecoverable;
  EXPECT_EQ(run(), End::kFinished);
  EXPECT_EQ(progress.counters[DeviceCounter::kInterruptions], 1) << "the one after it was ready";
  EXPECT_EQ(progress.counters[DeviceCounter::kZeroForce], 301);
}

TEST_F(DeviceLoopRun, DoesNotSpinOnAFailingDevice) {
  for (std::uint64_t i = 100; i < 400; ++i)
    device.read_faults[i] = devices::DeviceError::kRecoverable;
  device.read_faults[400] = devices::DeviceError::kDisconnected;
  EXPECT_EQ(run(), End::kDeviceGone);
  EXPECT_GT(took_s, 0.35) << "100 good and 300 failed samples at 1 kHz";
}

TEST_F(DeviceLoopRun, EndsAtZeroForceIfTheDeviceIsGone) {
  device.read_faults = {{900, devices::DeviceError::kDisconnected}};
  EXPECT_EQ(run(), End::kDeviceGone);
  EXPECT_EQ(device.force, 0.0);
  EXPECT_GE(device.stops, 1);
}

TEST_F(DeviceLoopRun, EndsAtZeroForceWhenAWriteFindsAFault) {
  device.write_faults = {{900, devices::DeviceError::kFault}};
  EXPECT_EQ(run(), End::kDeviceFault);
  EXPECT_EQ(device.force, 0.0);
  EXPECT_GE(device.stops, 1);
}

TEST_F(DeviceLoopRun, FlagsAnInvalidPoseAndSendsTheLastGood) {
  devices::DeviceSample marked, not_a_number;
  marked.pose.position = {9.0, 9.0, 9.0};
  marked.pose_valid = false;
  not_a_number.pose.position.x() = std::numeric_limits<double>::quiet_NaN();
  for (std::uint64_t i = 200; i < 300; ++i)
    device.odd_samples[i] = i % 2 ? marked : not_a_number;
  EXPECT_EQ(run(500), End::kFinished);
  EXPECT_EQ(progress.counters[DeviceCounter::kLatchedPoses], 100);
  int flagged = 0;
  for (const msg::DeviceState& state : seen) {
    EXPECT_EQ(state.pose.position.z, 0.5) << "sample " << state.sequence_number;
    const bool untrusted = (state.flags & msg::device_state::kFlagPoseLatched) != 0;
    EXPECT_EQ(untrusted, state.sequence_number >= 199 && state.sequence_number < 299)
        << "sample " << state.sequence_number;
    flagged += untrusted;
  }
  EXPECT_GT(flagged, 50);
}

TEST_F(DeviceLoopRun, AnswersARealDeviceAtItsOwnPaceAndAtOnce) {
  device.paces = true;
  device.set_rate(250.0);
  EXPECT_EQ(run(300), End::kFinished);
  std::sort(device.delays_ms.begin(), device.delays_ms.end());
  EXPECT_LT(device.delays_ms[device.delays_ms.size() / 2], 1.5)
      << "half of the commands waited for a deadline of ours";
  EXPECT_LT(device.skipped_ticks, 30) << "ticks went by while the loop slept";
}

TEST_F(DeviceLoopRun, CountsSamplesOfARealDeviceThatItMissed) {
  device.paces = true;
  device.set_rate(250.0);
  device.busy_at = 50;
  EXPECT_EQ(run(100), End::kFinished);
  EXPECT_GE(device.skipped_ticks, 3);
  EXPECT_NEAR(progress.counters[DeviceCounter::kOverruns], device.skipped_ticks,
              0.1 * device.skipped_ticks);
}

TEST_F(DeviceLoopRun, YieldsTheRigAtZeroForce) {
  requests.rig_claimed.store(true);
  EXPECT_EQ(run(), End::kRigClaimed);
  EXPECT_EQ(device.force, 0.0);
}

}  // namespace
}  // namespace voxtouch::device_node
