#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tests/experiments/coupling_campaign/campaign.hpp"

namespace voxtouch::campaign {
namespace {

constexpr double kMaxSamples = 2e6;

/// Slowest decay of the linear loop [s]; 0 if it does not decay.
double linear_time_constant(const coupling_models::NonlinearLoop& loop) {
  const double rate = -std::log(
      coupling::design::spectral_radius(loop.plant, loop.controller, loop.contact_stiffness));
  return rate > 0.0 ? loop.plant.period_s / rate : 0.0;
}

const char* name_of(coupling_models::WallLaw wall) {
  switch (wall) {
    case coupling_models::WallLaw::kBilateral:
      return "bilateral";
    case coupling_models::WallLaw::kUnilateral:
      return "unilateral";
    case coupling_models::WallLaw::kSoftening:
      return "softening";
    case coupling_models::WallLaw::kHardening:
      return "hardening";
  }
  return "?";
}

}  // namespace

Tally& PhaseResult::tally(const std::string& kind) {
  const auto there = std::ranges::find(tallies, kind, &Tally::name);
  return there != tallies.end() ? *there : tallies.emplace_back(Tally{.name = kind});
}

bool PhaseResult::count(const std::string& kind, const coupling_models::NonlinearVerdict& verdict) {
  Tally& t = tally(kind);
  ++t.runs;
  t.unstable += verdict.stable ? 0 : 1;
  t.decaying += verdict.outcome == coupling_models::LoopOutcome::kDecaying ? 1 : 0;
  return !verdict.stable;
}

void drive(coupling_models::NonlinearLoop& loop, double displayed, double max_effort,
           coupling_models::Random& random) {
  const double mass = loop.plant.mass + loop.plant.hand_mass;
  const double depth = random.log_uniform(0.5e-3, 10e-3);
  loop.push = std::min((displayed + loop.plant.hand_stiffness) * depth, 0.6 * max_effort);
  const double swing = std::sqrt((displayed + loop.plant.hand_stiffness) / mass);  // rad/s
  // Up to ten times the depth; more only adds time in the air.
  loop.start_speed = std::min(random.log_uniform(0.01, 0.3), 10.0 * depth * swing);
  const double slowest = std::max(coupling_models::settling_time(loop), linear_time_constant(loop));
  const double most = kMaxSamples * loop.plant.period_s;
  loop.duration_s =
      std::clamp(std::max(8.0 * slowest, 20.0 * 6.283 / swing), 2000.0 * loop.plant.period_s, most);
  loop.longest_s = 8.0 * loop.duration_s;
  loop.wall_knee = depth * random.log_uniform(0.3, 3.0);
}

void disturb(coupling_models::NonlinearLoop& loop, const coupling::design::LoopTiming& timing,
             double resolution, coupling_models::Random& random) {
  constexpr std::array kWalls{coupling_models::WallLaw::kUnilateral,
                              coupling_models::WallLaw::kSoftening,
                              coupling_models::WallLaw::kHardening};
  loop.wall = kWalls[random.below(3)];
  loop.resolution = resolution;
  loop.jitter = timing.jitter;
  loop.loss = random.uniform(0.01, 0.03);
  loop.most_consecutive_losses = timing.consecutive_losses;
  loop.measured_period = random.chance(0.5);
  loop.seed = random.next();
}

std::string describe(const coupling_models::NonlinearLoop& l,
                     const coupling_models::NonlinearVerdict& v) {
  const coupling::design::LoopPlant& p = l.plant;
  const coupling::design::LoopController& c = l.controller;
  const char* law = c.law == coupling::design::LoopController::Law::kShapingFilter ? "filter"
                    : c.law == coupling::design::LoopController::Law::kSpringDamper
                        ? "spring_damper"
                        : "direct";
  return fmt::format(
      "plant {{m {:.17g}, b {:.17g}, m_h {:.17g}, b_h {:.17g}, k_h {:.17g}, T {:.17g}, delay "
      "{:.17g}, lag {:.17g}}}, "
      "{} {{w0 {:.17g}, d {}, K {:.17g}, c {:.17g}, r {:.17g}, B {:.17g}, w_v {:.17g}, n {}, slow "
      "{:.17g} within {:.17g}}}, k {:.17g} {} knee {:.17g}, q "
      "{:.17g}, "
      "F_c {:.17g}, F_max {:.17g}, jitter {}, measured {}, delay jitter {:.17g}, loss {:.17g} up "
      "to {}, contact "
      "damping {}, "
      "push {:.17g}, speed {:.17g}, duration {:.17g}..{:.17g}, loop seed {}: peak to peak {:.4g} "
      "then {:.4g} (rest "
      "{:.4g}) "
      "after {:.4g} s",
      p.mass, p.damping, p.hand_mass, p.hand_damping, p.hand_stiffness, p.period_s, p.delay_s,
      p.effort_lag_s, law, c.w0_rad_per_s, c.damping_ratio, c.gain, c.stiffness, c.damping,
      c.injected_damping, c.velocity_filter_rad_per_s, c.velocity_window, l.slow_velocity_rad_per_s,
      l.velocity_band, l.contact_stiffness, name_of(l.wall), l.wall_knee, l.resolution,
      l.coulomb_friction, l.max_effort, l.jitter, l.measured_period, l.delay_jitter_s, l.loss,
      l.most_consecutive_losses, l.damping_only_in_contact, l.push, l.start_speed, l.duration_s,
      l.longest_s, l.seed, v.early_amplitude, v.late_amplitude, v.quiet, v.simulated_s);
}

}  // namespace voxtouch::campaign
