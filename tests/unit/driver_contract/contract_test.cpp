// Contract of every driver, for any device. "Within one period": what the plant receives over a
// period that begins one period after the cause, or later.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <random>
#include <tuple>

#include "devices/limits.hpp"
#include "tests/support/heap_count/heap_count.hpp"
#include "tests/unit/driver_contract/subject.hpp"

namespace voxtouch::contract {
namespace {

using namespace std::chrono_literals;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kHuge = std::numeric_limits<double>::max();

struct Maker {
  const char* name;
  MakeSubject make;
};
void PrintTo(const Maker& maker, std::ostream* out) { *out << maker.name; }

class DriverContract : public testing::TestWithParam<Maker> {
 protected:
  void SetUp() override { subject = GetParam().make(); }

  void open() {
    subject->open();
    const DeviceDescription& d = subject->driver().description();
    period_s = 1.0 / d.rate_hz;
    push = subject->usual_push();
  }
  void open_and_push() {
    open();
    ASSERT_TRUE(subject->push_until_measured(push)) << subject->driver().last_error();
  }
  Subject::Cycle cycle(const std::optional<Wrench>& command) { return subject->cycle(command); }
  void cycles(int n, const std::optional<Wrench>& command) {
    for (int i = 0; i < n; ++i)
      cycle(command);
  }
  /// Every period that begins within `for_s` from one period after `since_s` on was without force;
  /// there were some.
  void expect_zero_after(double since_s, double for_s, double periods = 1.0) {
    int seen = 0;
    for (const Received& r : subject->received()) {
      if (r.begin_s < since_s + (periods - 0.01) * period_s + subject->slack_s() ||
          r.begin_s > since_s + for_s)
        continue;
      ++seen;
      EXPECT_TRUE(r.wrench.zero())
          << "at " << 1e3 * (r.begin_s - since_s) << " ms: " << r.wrench.force.norm() << " N";
    }
    EXPECT_GT(seen, 0);  // in real time a busy machine skips periods
  }
  /// Long enough for that.
  int periods_of(double seconds) const {
    return static_cast<int>((seconds + subject->slack_s()) / period_s) + 5;
  }

  std::unique_ptr<Subject> subject;
  double period_s = 1e-3;
  Wrench push;
};

auto numbers_of(const DeviceDescription& d) {
  return std::make_tuple(
      d.rate_hz, d.max_force_n, d.max_torque_nm, d.max_force_rate_n_per_s,
      d.max_torque_rate_nm_per_s, d.max_stiffness_n_per_m, d.mass_min_kg, d.mass_max_kg,
      d.damping_ns_per_m, d.coulomb_friction_n, d.position_resolution_m, d.delay_s,
      d.force_bandwidth_hz, d.inertia_min_kg_m2, d.inertia_max_kg_m2, d.damping_nms_per_rad,
      d.coulomb_friction_nm, d.orientation_resolution_rad, d.max_stiffness_nm_per_rad, d.jitter,
      d.consecutive_losses, d.grip, d.input_dof, d.output_dof, d.model);
}

TEST_P(DriverContract, KeepsItsDescriptionAfterOpening) {
  open();
  const DeviceDescription d = subject->driver().description();
  EXPECT_FALSE(d.model.empty());
  EXPECT_GE(d.rate_hz, 10.0);
  EXPECT_LE(d.rate_hz, 10000.0);
  EXPECT_TRUE(d.max_force_n > 0.0 && d.max_force_n < 1000.0);
  EXPECT_TRUE(d.max_torque_nm >= 0.0 && d.max_torque_nm < 1000.0);
  EXPECT_GT(d.max_force_rate_n_per_s, 0.0);
  EXPECT_TRUE(d.max_stiffness_n_per_m > 0.0 && std::isfinite(d.max_stiffness_n_per_m));
  EXPECT_TRUE(d.mass_min_kg > 0.0 && d.mass_max_kg >= d.mass_min_kg &&
              std::isfinite(d.mass_max_kg));
  EXPECT_TRUE(d.damping_ns_per_m >= 0.0 && d.coulomb_friction_n >= 0.0 &&
              d.position_resolution_m >= 0.0);
  EXPECT_TRUE(d.delay_s >= 0.0 && d.delay_s < 1.0);
  EXPECT_GT(d.force_bandwidth_hz, 0.0);
  EXPECT_EQ(d.max_torque_nm > 0.0, d.inertia_max_kg_m2 > 0.0 && d.max_stiffness_nm_per_rad > 0.0);
  EXPECT_TRUE(d.output_dof == 3 || d.output_dof == 6);
  EXPECT_TRUE(d.max_torque_nm == 0.0 || d.output_dof == 6);
  EXPECT_EQ(subject->driver().simulated(), subject->virtual_time());
  cycles(20, push);
  cycles(2, Wrench{Vec3(kNaN, 0, 0), Vec3::Zero()});
  subject->driver().stop();
  EXPECT_EQ(numbers_of(subject->driver().description()), numbers_of(d));
  subject->close();
  subject->open();
  EXPECT_EQ(numbers_of(subject->driver().description()), numbers_of(d));
}

TEST_P(DriverContract, ReadGivesFiniteSamplesAndTimeGrows) {
  open();
  std::int64_t last = -1;
  int samples = 0;
  double path_s = 0.0;
  for (int i = 0; i < 300; ++i) {
    const auto t = cycle(push);
    if (!t.sample)
      continue;
    ++samples;
    EXPECT_TRUE(t.sample->pose.finite() && t.sample->twist.finite());
    EXPECT_NEAR(t.sample->pose.orientation.norm(), 1.0, 1e-9);
    EXPECT_TRUE(t.sample->pose_valid);
    EXPECT_GT(t.sample->time_ns, last);
    if (last >= 0)
      path_s += 1e-9 * static_cast<double>(t.sample->time_ns - last);
    last = t.sample->time_ns;
  }
  EXPECT_GT(samples, subject->virtual_time() ? 299 : 200);
  EXPECT_NEAR(path_s / (samples - 1), period_s, subject->virtual_time() ? 1e-9 : period_s);
}

TEST_P(DriverContract, PlantReceivesTheWrittenForce) {
  open();
  for (const Vec3& direction :
       {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(-0.5, 0.4, -0.3)}) {
    const Wrench command{push.force.norm() * direction, Vec3::Zero()};
    ASSERT_TRUE(subject->push_until_measured(command, 0.03)) << subject->driver().last_error();
  }
  const Wire wire = subject->wire();
  EXPECT_GT(wire.pushes, 20u);
  EXPECT_NEAR(wire.force_n, push.force.norm(), 0.01 * push.force.norm());
}

TEST_P(DriverContract, RefusedCommandsReachThePlantAsZero) {
  open_and_push();
  const DeviceDescription d = subject->driver().description();
  struct Bad {
    Wrench wrench;
    devices::DeviceError error;
  };
  std::vector<Bad> all;
  for (const double value : {kNaN, kInf, -kInf})
    for (int axis = 0; axis < 6; ++axis) {
      Wrench bad = push;
      (axis < 3 ? bad.force : bad.torque)[axis % 3] = value;
      all.push_back({bad, devices::DeviceError::kNotFinite});
    }
  all.push_back(
      {{Vec3(0, d.max_force_n * (1 + 1e-9), 0), Vec3::Zero()}, devices::DeviceError::kLimit});
  all.push_back({{Vec3(kHuge, kHuge, kHuge), Vec3::Zero()}, devices::DeviceError::kLimit});
  all.push_back({{push.force, Vec3(0, d.max_torque_nm * (1 + 1e-9) + 1e-9, 0)},
                 devices::DeviceError::kLimit});
  for (const Bad& bad : all) {
    ASSERT_TRUE(subject->push_until_measured(push));
    Subject::Cycle first;
    do
      first = cycle(bad.wrench);  // in real time a period may go by without a sample
    while (!first.sample && !subject->virtual_time());
    ASSERT_FALSE(first.written);
    EXPECT_EQ(first.written.error(), bad.error)
        << bad.wrench.force.transpose() << " " << bad.wrench.torque.transpose();
    cycles(periods_of(8 * period_s), bad.wrench);
    expect_zero_after(first.time_s, 8 * period_s + subject->slack_s());
  }
  EXPECT_TRUE(subject->push_until_measured(push)) << "and takes good ones again";
}

TEST_P(DriverContract, StopIsImmediateAndIdempotent) {
  open_and_push();
  ASSERT_TRUE(cycle(std::nullopt).time_s > 0.0);
  double at_s = subject->now_s();
  subject->driver().stop();
  subject->driver().stop();
  cycles(periods_of(0.1), std::nullopt);
  expect_zero_after(at_s, 0.1);

  ASSERT_TRUE(subject->push_until_measured(push));  // now with a pending command
  at_s = cycle(push).time_s;
  subject->driver().stop();
  subject->driver().stop();
  cycles(periods_of(0.1), std::nullopt);
  expect_zero_after(at_s, 0.1, subject->answers_are_final() ? 2.0 : 1.0);
  EXPECT_TRUE(subject->push_until_measured(push)) << "the next write pushes again";
}

TEST_P(DriverContract, AnUnansweredPeriodIsZeroForce) {
  open_and_push();
  const double at_s = cycle(std::nullopt).time_s;
  cycles(periods_of(0.1), std::nullopt);
  expect_zero_after(at_s, 0.1);
}

TEST_P(DriverContract, ClosedDriverSendsNothing) {
  open_and_push();
  cycle(push);
  subject->close();
  const double at_s = subject->now_s();
  if (!subject->virtual_time())
    std::this_thread::sleep_for(150ms);  // time passes independently of calls
  EXPECT_GT(subject->received().size(), 0u);
  for (const Received& r : subject->received()) {
    if (r.begin_s < at_s - 0.01 * period_s)
      continue;
    EXPECT_TRUE(r.wrench.zero()) << r.wrench.force.norm();
  }
  // The same plant, opened once more: the force of before has not waited in it.
  subject->open();
  const std::size_t before = subject->received().size();
  cycles(20, std::nullopt);
  for (std::size_t i = before; i < subject->received().size(); ++i)
    EXPECT_TRUE(subject->received()[i].wrench.zero() || !subject->exclusive());
}

TEST_P(DriverContract, SecondOpeningIsRefusedOrIndependent) {
  open_and_push();
  const auto second = subject->open_another();
  if (subject->exclusive()) {
    EXPECT_EQ(second.driver, nullptr);
    EXPECT_GT(second.sentence.size(), 40u) << second.sentence;
    EXPECT_TRUE(second.sentence.find("another") != std::string::npos ||
                second.sentence.find("already") != std::string::npos)
        << second.sentence;
  } else {
    EXPECT_NE(second.driver, nullptr);
  }
  EXPECT_TRUE(subject->push_until_measured(push));
}

TEST_P(DriverContract, RandomCommandsKeepTheLimitsOnTheWire) {
  open_and_push();
  const DeviceDescription d = subject->driver().description();
  std::mt19937_64 random(20);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const auto vector = [&](double limit) {
    const Vec3 v(2 * uniform() - 1, 2 * uniform() - 1, 2 * uniform() - 1);
    const double scale = std::pow(10.0, 1.5 * uniform() - 1.0);  // 0.1 to 3 times the limit
    return Vec3(v.normalized() * limit * scale);
  };
  const std::array<double, 8> odd = {kNaN, kInf, -kInf, kHuge, -kHuge, 1e300, 5e-324, -0.0};
  int refused = 0, accepted = 0, samples = 0;
  const int commands = subject->virtual_time() ? 10000 : 500;
  Wrench command;
  for (int i = 0; i < commands; ++i) {
    if (i % subject->periods_to_reach() == 0) {
      const int n = i / subject->periods_to_reach();
      command = {vector(d.max_force_n), vector(std::max(d.max_torque_nm, 1e-9))};
      if (n % 3 == 0)
        command.torque.setZero();
      if (n % 5 == 0)
        command.force[static_cast<int>(random() % 3)] = odd[random() % odd.size()];
      if (n % 7 == 0)
        command.torque[static_cast<int>(random() % 3)] = odd[random() % odd.size()];
    }
    const auto expected = devices::check_command(command, d);
    const auto t = cycle(command);
    if (!t.sample)
      continue;
    ++samples;
    accepted += t.written.has_value();
    if (expected)
      continue;
    ++refused;
    ASSERT_FALSE(t.written);
    EXPECT_EQ(t.written.error(), expected.error());
  }
  const Wire wire = subject->wire();
  EXPECT_EQ(wire.not_finite, 0u);
  EXPECT_LE(wire.force_n, d.max_force_n * (1 + 1e-4));
  EXPECT_LE(wire.torque_nm, d.max_torque_nm * (1 + 1e-3) + 1e-2);
  EXPECT_LE(wire.drive_ratio, 1.0 + 1e-6);
  EXPECT_GT(wire.force_n, 0.5 * d.max_force_n);
  EXPECT_GT(samples, commands / 2);
  EXPECT_GT(refused, samples / 4);
  EXPECT_GT(accepted, samples / 20);
  for (const Received& r : subject->received()) {
    ASSERT_TRUE(r.wrench.finite());
    ASSERT_LE(r.wrench.force.norm(), d.max_force_n * 1.05);
  }
}

TEST_P(DriverContract, OpenDriverUsesNoHeap) {
  if (!test::heap_is_counted())
    GTEST_SKIP() << "the sanitiser owns malloc";
  open_and_push();
  devices::Driver& driver = subject->driver();
  const auto timeout = std::chrono::microseconds(static_cast<std::int64_t>(4e6 * period_s));
  int good = 0;
  EXPECT_EQ(test::heap_count_of([&] {
              for (int i = 0; i < 300; ++i) {
                good += driver.read(timeout).has_value();
                if (i % 17)
                  (void)driver.write(push);
                if (i % 5 == 0)
                  (void)driver.write({Vec3(kNaN, 0, 0), Vec3::Zero()});
                if (i % 7 == 0)
                  (void)driver.write({Vec3(1e9, 0, 0), Vec3::Zero()});
                if (i % 11 == 0)
                  driver.stop();
                (void)driver.description();
              }
            }),
            0);
  EXPECT_GT(good, 150);
}

TEST_P(DriverContract, VirtualTimeIsBitIdentical) {
  if (!subject->virtual_time())
    GTEST_SKIP() << "real time is never the same";
  const auto run = [&] {
    subject = nullptr;
    subject = GetParam().make();
    open();
    std::mt19937_64 random(5);
    std::vector<double> all;
    for (int i = 0; i < 600; ++i) {
      const Vec3 force = push.force + Vec3(static_cast<double>(random() % 100),
                                           static_cast<double>(random() % 100), 0) *
                                          (0.002 * push.force.norm());
      const auto t = cycle(Wrench{force, Vec3::Zero()});
      EXPECT_TRUE(t.sample);
      if (!t.sample)
        break;
      all.push_back(static_cast<double>(t.sample->time_ns));
      const devices::DeviceSample& s = *t.sample;
      for (const Vec3& v :
           {s.pose.position, Vec3(s.pose.orientation.vec()), s.twist.linear, s.twist.angular})
        all.insert(all.end(), v.data(), v.data() + 3);
      all.push_back(t.written.has_value());
    }
    for (std::size_t i = 0; i < 600 && i < subject->received().size(); ++i)
      for (int axis = 0; axis < 3; ++axis)
        all.push_back(subject->received()[i].wrench.force[axis]);
    return all;
  };
  const auto first = run(), second = run();
  ASSERT_EQ(first.size(), second.size());
  EXPECT_GT(first.size(), 600u * 14);
  EXPECT_EQ(std::memcmp(first.data(), second.data(), first.size() * sizeof(double)), 0);
}

const Maker kMakers[] = {
    {"sim_phantom", simulated_phantom},
    {"sim_lwr", simulated_lwr},
    {"phantom_virtual", [] { return phantom("premium", true); }},
    {"phantom_6dof_virtual", [] { return phantom("premium-6dof", true); }},
    {"phantom_real", [] { return phantom("premium", false); }},
    {"lwr_virtual", [] { return lwr(true); }},
    {"lwr_real", [] { return lwr(false); }},
    {"fr3_virtual", [] { return fr3(true); }},
    {"fr3_panda_virtual", [] { return fr3(true, 5); }},
    {"fr3_real", [] { return fr3(false); }},
};
INSTANTIATE_TEST_SUITE_P(Every, DriverContract, testing::ValuesIn(kMakers),
                         [](const auto& maker) { return std::string(maker.param.name); });

}  // namespace
}  // namespace voxtouch::contract
