#include "tests/support/coupling_models/population.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace voxtouch::coupling_models {
namespace {

constexpr FamilyRanges kPhantomLike{
    .mass = {0.03, 0.2},
    .damping = {0.003, 1.0},
    .contact = {20.0, 5000.0},
    .max_effort = {3.0, 38.0},
    .max_stiffness = {500.0, 5000.0},
    .coulomb_friction = {0.01, 0.2},
    .hand_mass = {0.02, 0.2},
    .hand_damping = {0.5, 8.0},
    .hand_stiffness = {20.0, 800.0},
};
constexpr FamilyRanges kLwrLike{
    .mass = {1.6, 24.0},
    .damping = {6.0, 63.0},
    .contact = {100.0, 16000.0},
    .max_effort = {20.0, 150.0},
    .max_stiffness = {1000.0, 16000.0},
    .coulomb_friction = {0.5, 5.0},
    .hand_mass = {0.3, 2.0},
    .hand_damping = {3.0, 30.0},
    .hand_stiffness = {50.0, 600.0},
};

double log_in(Random& random, const Interval& i) { return random.log_uniform(i.low, i.high); }
double even_in(Random& random, const Interval& i) { return random.uniform(i.low, i.high); }

Interval part_of(Random& random, const Interval& whole) {
  const double a = log_in(random, whole), b = log_in(random, whole);
  return {std::min(a, b), std::max(a, b)};
}

double bandwidth_of(double lag_s) {
  return lag_s > 0.0 ? 1.0 / (2.0 * std::numbers::pi * lag_s)
                     : std::numeric_limits<double>::infinity();
}

coupling::design::HandRange whole_hand(const FamilyRanges& r) {
  return {false,
          true,
          r.hand_mass.low,
          r.hand_mass.high,
          r.hand_damping.low,
          r.hand_damping.high,
          r.hand_stiffness.low,
          r.hand_stiffness.high};
}

coupling::design::HandRange draw_hand(const FamilyRanges& r, Random& random) {
  coupling::design::HandRange hand = whole_hand(r);
  hand.any_passive = random.chance(0.1);
  hand.may_release = random.chance(0.7);
  if (random.chance(0.5)) {
    const Interval m = part_of(random, r.hand_mass), b = part_of(random, r.hand_damping),
                   k = part_of(random, r.hand_stiffness);
    hand.mass_min = m.low, hand.mass_max = m.high;
    hand.damping_min = b.low, hand.damping_max = b.high;
    hand.stiffness_min = k.low, hand.stiffness_max = k.high;
  }
  return hand;
}

/// A wild hand: anything that creates no energy. Half of them have no spring, half of those hold
/// nothing but mass.
void draw_wild_hand(coupling::design::LoopPlant& plant, double device_mass, Random& random) {
  plant.hand_mass = device_mass * random.log_uniform(1e-3, 1e1);
  plant.hand_stiffness = random.chance(0.5) ? random.log_uniform(1e-1, 1e4) : 0.0;
  plant.hand_damping = random.chance(0.5) ? random.log_uniform(1e-3, 1e1) : 0.0;
}

coupling::design::LoopPlant released(const PopulationMember& member, double mass) {
  const coupling::design::AxisModel& axis = member.device.translation;
  const double pi2 = 2.0 * std::numbers::pi;
  return {mass,
          axis.damping,
          0.0,
          0.0,
          0.0,
          member.device.timing.period_s,
          member.device.timing.delay_s,
          std::isfinite(axis.effort_bandwidth_hz) ? 1.0 / (pi2 * axis.effort_bandwidth_hz) : 0.0};
}

}  // namespace

const FamilyRanges& ranges_of(DeviceFamily family) noexcept {
  return family == DeviceFamily::kPhantomLike ? kPhantomLike : kLwrLike;
}

PopulationMember draw_member(std::uint64_t seed, std::uint64_t index) {
  Random random(seed, index);
  PopulationMember out{.seed = seed, .index = index, .device = {}, .hand = {}, .contact = {}};
  out.family = index % 2 == 0 ? DeviceFamily::kPhantomLike : DeviceFamily::kLwrLike;
  const FamilyRanges& r = ranges_of(out.family);
  out.device.name = fmt::format(
      "{} {} of population {}",
      out.family == DeviceFamily::kPhantomLike ? "Phantom-like" : "LWR-like", index, seed);
  coupling::design::AxisModel& axis = out.device.translation;
  axis.inertia_min = axis.inertia_max = log_in(random, r.mass);
  const double spread = random.uniform(1.0, 3.0);
  if (random.chance(0.5))
    axis.inertia_max = std::min(r.mass.high, spread * axis.inertia_min);
  axis.damping = log_in(random, r.damping);
  const double friction = log_in(random, r.coulomb_friction);
  axis.coulomb_friction = random.chance(0.5) ? friction : 0.0;
  axis.resolution = log_in(random, kResolutions);
  axis.max_effort = even_in(random, r.max_effort);
  axis.max_stiffness = log_in(random, r.max_stiffness);
  axis.effort_bandwidth_hz = bandwidth_of(even_in(random, kEffortLags));
  out.device.timing.period_s = log_in(random, kPeriods);
  out.device.timing.delay_s = even_in(random, kDelaysInPeriods) * out.device.timing.period_s;
  out.device.timing.jitter = 0.2;
  out.device.timing.consecutive_losses = 1 + static_cast<int>(random.below(3));
  out.contact.all_points = log_in(random, r.contact);
  out.contact.one_point = out.contact.all_points / random.log_uniform(1.0, 100.0);
  out.hand = draw_hand(r, random);
  return out;
}

std::vector<PopulationMember> corner_members(DeviceFamily family) {
  const FamilyRanges& r = ranges_of(family);
  std::vector<PopulationMember> out;
  for (unsigned corner = 0; corner < 128; ++corner) {
    const auto pick = [&](unsigned bit, const Interval& i) {
      return (corner >> bit) & 1u ? i.high : i.low;
    };
    PopulationMember m{
        .index = corner, .family = family, .device = {}, .hand = whole_hand(r), .contact = {}};
    m.device.name = fmt::format(
        "{} corner {}", family == DeviceFamily::kPhantomLike ? "Phantom-like" : "LWR-like", corner);
    coupling::design::AxisModel& axis = m.device.translation;
    axis.inertia_min = axis.inertia_max = pick(0, r.mass);
    axis.damping = pick(1, r.damping);
    axis.resolution = pick(2, kResolutions);
    axis.max_effort = r.max_effort.high;
    axis.max_stiffness = r.max_stiffness.high;
    axis.effort_bandwidth_hz = bandwidth_of(pick(3, kEffortLags));
    m.device.timing.period_s = pick(4, kPeriods);
    m.device.timing.delay_s = pick(5, kDelaysInPeriods) * m.device.timing.period_s;
    m.contact.all_points = m.contact.one_point = pick(6, r.contact);
    out.push_back(m);
  }
  return out;
}

coupling::design::LoopPlant draw_plant(const PopulationMember& member, Random& random) {
  const coupling::design::AxisModel& axis = member.device.translation;
  coupling::design::LoopPlant plant =
      released(member, random.uniform(axis.inertia_min, axis.inertia_max));
  const coupling::design::HandRange& hand = member.hand;
  if (hand.may_release && random.chance(0.4))
    return plant;
  if (hand.any_passive) {
    draw_wild_hand(plant, plant.mass, random);
    return plant;
  }
  plant.hand_mass = random.log_uniform(hand.mass_min, hand.mass_max);
  plant.hand_damping = random.log_uniform(hand.damping_min, hand.damping_max);
  plant.hand_stiffness = random.log_uniform(hand.stiffness_min, hand.stiffness_max);
  return plant;
}

std::vector<coupling::design::LoopPlant> vertex_plants(const PopulationMember& member) {
  const coupling::design::HandRange& h = member.hand;
  std::vector<coupling::design::LoopPlant> out;
  for (const double mass :
       {member.device.translation.inertia_min, member.device.translation.inertia_max}) {
    coupling::design::LoopPlant plant = released(member, mass);
    if (h.may_release || h.any_passive)
      out.push_back(plant);
    const auto held = [&](double m, double b, double k) {
      plant.hand_mass = m, plant.hand_damping = b, plant.hand_stiffness = k;
      out.push_back(plant);
    };
    for (const double m : {h.mass_min, h.mass_max})
      for (const double b : {h.damping_min, h.damping_max})
        for (const double k : {h.stiffness_min, h.stiffness_max})
          held(m, b, k);
    held(0.5 * (h.mass_min + h.mass_max), 0.5 * (h.damping_min + h.damping_max),
         0.5 * (h.stiffness_min + h.stiffness_max));
    if (member.device.translation.inertia_min == member.device.translation.inertia_max)
      break;
  }
  return out;
}

}  // namespace voxtouch::coupling_models
