#include "tests/support/coupling_models/population.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <set>

namespace voxtouch::coupling::design {
namespace {

TEST(Random, IsSplitMix64) {
  coupling_models::Random random(
      1234567);  // the reference implementation's first numbers for this seed
  EXPECT_EQ(random.next(), 6457827717110365317u);
  EXPECT_EQ(random.next(), 3203168211198807973u);
  EXPECT_EQ(random.next(), 9817491932198370423u);
}

TEST(Random, DrawsEveryDecadeEquallyOften) {
  coupling_models::Random random(1);
  int decades[4] = {};
  for (int i = 0; i < 40000; ++i) {
    const double x = random.log_uniform(1e-3, 10.0);
    ASSERT_GE(x, 1e-3);
    ASSERT_LE(x, 10.0);
    ++decades[static_cast<int>(std::floor(std::log10(x) + 3.0 + 1e-9)) % 4];
  }
  for (const int n : decades)
    EXPECT_NEAR(n, 10000, 400);
}

TEST(Population, IsBitIdenticalEverywhere) {
  const coupling_models::PopulationMember a = coupling_models::draw_member(1, 6),
                                          b = coupling_models::draw_member(1, 7);
  // Written down once: a change of these bits is a change of every published seed.
  EXPECT_EQ(std::bit_cast<std::uint64_t>(a.device.translation.inertia_min), 4586075282217443234u);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(a.contact.all_points), 4628185228813264517u);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(b.device.timing.period_s), 4567358088971955618u);
}

TEST(Population, StaysWithinItsRangesAndCanBeDesignedFor) {
  std::set<double> masses;
  for (std::uint64_t i = 0; i < 500; ++i) {
    const coupling_models::PopulationMember m = coupling_models::draw_member(11, i);
    const coupling_models::FamilyRanges& r = coupling_models::ranges_of(m.family);
    const AxisModel& axis = m.device.translation;
    masses.insert(axis.inertia_min);
    EXPECT_GE(axis.inertia_min, r.mass.low);
    EXPECT_LE(axis.inertia_min, axis.inertia_max);
    EXPECT_LE(axis.inertia_max, r.mass.high);
    EXPECT_GE(axis.damping, r.damping.low);
    EXPECT_LE(axis.damping, r.damping.high);
    EXPECT_GE(m.contact.one_point, 0.0099 * m.contact.all_points);
    EXPECT_LE(m.contact.one_point, m.contact.all_points);
    EXPECT_LE(m.contact.all_points, r.contact.high);
    EXPECT_GE(m.device.timing.period_s, coupling_models::kPeriods.low);
    EXPECT_LE(m.device.timing.delay_s, 4.0 * m.device.timing.period_s);
    EXPECT_LE(m.hand.stiffness_min, m.hand.stiffness_max);
  }
  EXPECT_EQ(masses.size(), 500u);
}

TEST(Population, AMemberDoesNotDependOnThoseBeforeIt) {
  const coupling_models::PopulationMember late = coupling_models::draw_member(5, 1000);
  for (std::uint64_t i = 0; i < 10; ++i)
    coupling_models::draw_member(5, i);
  const coupling_models::PopulationMember again = coupling_models::draw_member(5, 1000);
  EXPECT_EQ(late.device.translation.damping, again.device.translation.damping);
  EXPECT_EQ(late.contact.one_point, again.contact.one_point);
}

TEST(Population, HasEveryCornerOfTheRangesOnce) {
  for (const coupling_models::DeviceFamily family :
       {coupling_models::DeviceFamily::kPhantomLike, coupling_models::DeviceFamily::kLwrLike}) {
    std::set<std::tuple<double, double, double, double, double, double, double>> seen;
    for (const coupling_models::PopulationMember& m : coupling_models::corner_members(family)) {
      const AxisModel& a = m.device.translation;
      seen.emplace(a.inertia_min, a.damping, a.resolution, a.effort_bandwidth_hz,
                   m.device.timing.period_s, m.device.timing.delay_s, m.contact.all_points);
    }
    EXPECT_EQ(seen.size(), 128u);
  }
}

TEST(Population, DrawsHandsOutOfTheRangeAndVerticesOnIt) {
  coupling_models::PopulationMember m = coupling_models::draw_member(1, 1);
  m.hand = {false, false, 0.3, 2.0, 3.0, 30.0, 50.0, 600.0};
  m.device.translation.inertia_max = 1.5 * m.device.translation.inertia_min;
  coupling_models::Random random(2);
  for (int i = 0; i < 200; ++i) {
    const LoopPlant p = coupling_models::draw_plant(m, random);
    EXPECT_TRUE(p.hand_mass >= 0.3 && p.hand_mass <= 2.0 && p.hand_damping >= 3.0 &&
                p.hand_stiffness <= 600.0);
    EXPECT_TRUE(p.mass >= m.device.translation.inertia_min &&
                p.mass <= m.device.translation.inertia_max);
  }
  EXPECT_EQ(coupling_models::vertex_plants(m).size(), 18u);
  m.hand.may_release = true;
  EXPECT_EQ(coupling_models::vertex_plants(m).size(), 20u);
}

}  // namespace
}  // namespace voxtouch::coupling::design
