#include "core/coupling/design/design_cases.hpp"

#include <cmath>
#include <numbers>

namespace voxtouch::coupling::design {
namespace {

struct Hand {
  double mass = 0.0, damping = 0.0, stiffness = 0.0;
  bool operator==(const Hand&) const = default;
};

void add_once(std::vector<Hand>& hands, const Hand& hand) {
  for (const Hand& there : hands)
    if (there == hand)
      return;
  hands.push_back(hand);
}

/// Corners and centre of the box.
std::vector<Hand> grips(const HandRange& range) {
  std::vector<Hand> hands;
  for (const double m : {range.mass_min, range.mass_max})
    for (const double b : {range.damping_min, range.damping_max})
      for (const double k : {range.stiffness_min, range.stiffness_max})
        add_once(hands, {m, b, k});
  add_once(hands,
           {0.5 * (range.mass_min + range.mass_max), 0.5 * (range.damping_min + range.damping_max),
            0.5 * (range.stiffness_min + range.stiffness_max)});
  return hands;
}

LoopPlant plant_of(const AxisModel& axis, double inertia, const LoopTiming& timing,
                   const Hand& hand) {
  LoopPlant plant;
  plant.mass = inertia;
  plant.damping = axis.damping;
  plant.hand_mass = hand.mass;
  plant.hand_damping = hand.damping;
  plant.hand_stiffness = hand.stiffness;
  plant.period_s = timing.period_s;
  plant.delay_s = timing.delay_s;
  plant.effort_lag_s = effort_lag_s(axis);
  return plant;
}

}  // namespace

LoopTiming slowest(const LoopTiming& timing) {
  const double longer = timing.jitter + timing.consecutive_losses;
  return {timing.period_s * (1.0 + timing.jitter), timing.delay_s + longer * timing.period_s, 0.0,
          0};
}

double effort_lag_s(const AxisModel& axis) {
  return std::isinf(axis.effort_bandwidth_hz)
             ? 0.0
             : 1.0 / (2.0 * std::numbers::pi * axis.effort_bandwidth_hz);
}

InnerLimit InnerLimits::of(const LoopPlant& plant, double velocity_filter_rad_per_s,
                           int velocity_window) {
  for (const Known& known : known_)
    if (known.velocity_window == velocity_window &&
        known.velocity_filter_rad_per_s == velocity_filter_rad_per_s && known.plant == plant)
      return known.limit;
  known_.push_back({plant, velocity_filter_rad_per_s, velocity_window,
                    inner_limit(plant, velocity_filter_rad_per_s, velocity_window)});
  return known_.back().limit;
}

std::vector<DesignCase> design_cases(const AxisModel& axis, const LoopTiming& timing,
                                     const HandRange& hand) {
  std::vector<double> inertias{axis.inertia_min};
  if (axis.inertia_max > axis.inertia_min)
    inertias.push_back(axis.inertia_max);
  const bool alone = hand.any_passive || hand.may_release;
  const std::vector<Hand> gripped = hand.any_passive ? std::vector<Hand>{} : grips(hand);
  std::vector<DesignCase> cases;
  // The slowest timing comes first. It is usually the worst, so a search that stops at the first
  // failure ends early.
  for (const bool slow : {true, false}) {
    const LoopTiming when = slow ? slowest(timing) : timing;
    for (const double inertia : inertias) {
      if (alone)
        cases.push_back({{plant_of(axis, inertia, when, Hand{}), false, slow}});
      for (const Hand& grip : gripped)
        if (!alone || grip != Hand{})
          cases.push_back({{plant_of(axis, inertia, when, grip), true, slow}});
    }
  }
  return cases;
}

}  // namespace voxtouch::coupling::design
