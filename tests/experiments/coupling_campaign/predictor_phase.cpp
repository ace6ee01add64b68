#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/coupling/design/filter_search.hpp"
#include "tests/experiments/coupling_campaign/campaign.hpp"

namespace voxtouch::campaign {
namespace {

/// A valid filter, in half of the cases with injected damping up to half of the inner loop's limit.
coupling::design::LoopController draw_controller(const coupling::design::LoopPlant& plant,
                                                 coupling_models::Random& random) {
  constexpr std::array kRatios{0.577, 0.707, 1.0};
  coupling::design::LoopController out;
  const double highest = std::min(200.0, 0.6 / (2.0 * std::numbers::pi * plant.period_s));
  out.w0_rad_per_s = 2.0 * std::numbers::pi * random.log_uniform(1.0, highest);
  out.damping_ratio = kRatios[random.below(3)];
  const double fraction = random.uniform(0.05, 0.5);
  const bool damped = random.chance(0.5);
  out.use(coupling::design::kVelocityEstimates[random.below(
      coupling::design::kVelocityEstimates.size())]);
  if (damped)
    out.injected_damping = fraction * coupling::design::inner_limit(
                                          plant, out.velocity_filter_rad_per_s, out.velocity_window)
                                          .damping;
  return out;
}

coupling::design::LoopPlant slowed(coupling::design::LoopPlant plant, int lost) {
  plant.delay_s += (0.2 + lost) * plant.period_s;
  plant.period_s *= 1.2;
  return plant;
}

}  // namespace

PhaseResult predictor_phase(const Options& options) {
  PhaseResult out{.name = "predictor", .tallies = {}, .figures = {}, .failures = {}};
  const char* const kInside = "nominal gain margin above 1.05";
  const char* const kRule = "margin above 1, also with T * 1.2 and a lost sample";
  for (const char* kind : {"nominal gain margin below 1, wall of one slope",
                           "nominal gain margin below 1, softer part",
                           "nominal gain margin 1 to 1.05", kInside, kRule})
    out.tally(kind);
  std::uint64_t too_slow = 0;
  for (std::uint64_t i = 0; i < options.members; ++i) {
    if (options.progress)
      options.progress(i + 1, options.members);
    const coupling_models::PopulationMember member =
        coupling_models::draw_member(options.seed, options.first + i);
    coupling_models::Random random(options.seed ^ 0x92ed1c, options.first + i);
    coupling_models::NonlinearLoop loop;
    coupling_models::PopulationMember who = member;
    who.hand.any_passive = false, who.hand.may_release = true;
    loop.plant = coupling_models::draw_plant(who, random);
    loop.controller = draw_controller(loop.plant, random);
    const double margin =
        random.chance(0.3) ? random.uniform(0.97, 1.1) : random.log_uniform(0.8, 2.5);
    const double critical =
        coupling::design::critical_stiffness(loop.plant, loop.controller).stiffness;
    if (!(critical > 0.0) || !std::isfinite(critical))
      continue;
    loop.contact_stiffness = critical / margin;
    coupling::design::LoopTiming timing = member.device.timing;
    timing.consecutive_losses = 1;
    disturb(loop, timing, member.device.translation.resolution, random);
    loop.loss = 0.01;
    drive(loop, loop.contact_stiffness, member.device.translation.max_effort, random);
    const double radius =
        coupling::design::spectral_radius(loop.plant, loop.controller, loop.contact_stiffness);
    // Close to the limit, a loop may decay too slowly to be distinguished from an oscillation in a
    // run of reasonable duration.
    if (radius < 1.0 && -std::log(radius) * loop.duration_s / loop.plant.period_s < 1.0) {
      ++too_slow;
      continue;
    }
    const coupling_models::NonlinearVerdict verdict = coupling_models::simulate(loop);
    const bool one_slope = loop.wall == coupling_models::WallLaw::kUnilateral;
    const std::string kind = margin > 1.05   ? kInside
                             : margin >= 1.0 ? "nominal gain margin 1 to 1.05"
                             : one_slope     ? "nominal gain margin below 1, wall of one slope"
                                             : "nominal gain margin below 1, softer part";
    const bool unstable = out.count(kind, verdict);
    // Both, as the designer does: a hand's resonance can make the slower loop the more stable one.
    const bool covered =
        margin >= 1.0 &&
        coupling::design::critical_stiffness(slowed(loop.plant, 1), loop.controller).stiffness >=
            loop.contact_stiffness;
    if (covered)
      out.count(kRule, verdict);
    if (unstable && (covered || kind == kInside))
      out.failures.push_back({kind, options.seed, member.index, false, describe(loop, verdict)});
  }
  out.figures.push_back({"too slow to be judged, left out", static_cast<double>(too_slow)});
  return out;
}

}  // namespace voxtouch::campaign
