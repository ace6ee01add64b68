#include "tests/support/coupling_models/nonlinear_loop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "tests/support/coupling_models/loop_run.hpp"

namespace voxtouch::coupling_models {
namespace {

void refuse_nonsense(const NonlinearLoop& l) {
  const auto need = [](bool kept, const char* sentence) {
    if (!kept)
      throw std::invalid_argument(std::string("Simulated loop: ") + sentence);
  };
  need(l.plant.mass + l.plant.hand_mass > 0.0,
       "the mass of device and hand together must be above 0.");
  need(l.plant.damping + l.plant.hand_damping >= 0.0, "the damping must not be below 0.");
  need(l.plant.hand_stiffness >= 0.0 && l.plant.effort_lag_s >= 0.0,
       "stiffness and lag must not be below 0.");
  need(l.plant.period_s > 0.0 && l.duration_s > 0.0, "period and duration must be above 0.");
  need(l.jitter >= 0.0 && l.jitter < 1.0, "the jitter must be in [0, 1).");
  need(l.plant.delay_s >= 0.0 && l.delay_jitter_s >= 0.0,
       "delay and its jitter must not be below 0.");
  const double latest =
      l.plant.delay_s + l.delay_jitter_s + std::max(0.0, l.disturbance.more_delay_s);
  need(latest < 0.9 * PendingEfforts::kMaxEfforts * l.plant.period_s * (1.0 - l.jitter),
       "the delay is beyond some 200 of the shortest periods.");
}

/// The residual motion that the quantiser may leave; the loop's linear response is computed only if
/// it matters.
class Rest {
 public:
  Rest(const NonlinearLoop& loop) : loop_(loop), amplitude_(loop.resolution) {}
  void seen(double amplitude) noexcept { largest_ = std::max(largest_, amplitude); }
  bool covers(double amplitude) {
    if (amplitude <= quiet())
      return true;
    if (asked_ || loop_.resolution <= 0.0 || amplitude > kMaxSteps * loop_.resolution)
      return false;
    asked_ = true;
    double gain = quantiser_gain(loop_, loop_.contact_stiffness);
    if (loop_.wall == WallLaw::kSoftening || loop_.wall == WallLaw::kHardening)
      gain = std::max(gain, quantiser_gain(loop_, 0.3 * loop_.contact_stiffness));
    amplitude_ = loop_.resolution * std::clamp(gain, 1.0, kMaxSteps);
    return amplitude <= quiet();
  }
  double quiet() const noexcept { return std::max(amplitude_, 1e-4 * largest_); }

 private:
  static constexpr double kMaxSteps = 30.0;
  const NonlinearLoop& loop_;
  double amplitude_, largest_ = 0.0;
  bool asked_ = false;
};

/// Peak to peak of the quarters of a run.
using Quarters = std::array<Stretch, 4>;

constexpr double kFalls =
    0.9;  ///< a quarter this much smaller than the one before it: the run decays

double ratio(const Quarters& q, std::size_t i) {
  return q[i].position.width() / q[i - 1].position.width();
}

LoopOutcome outcome_at_the_end(const Quarters& q) {
  const double last = ratio(q, 3), before = ratio(q, 2);
  const bool flattens = std::log(last) > 0.5 * std::log(before);  // both below zero while it falls
  return last < kFalls && before < kFalls && !flattens ? LoopOutcome::kDecaying
                                                       : LoopOutcome::kSustained;
}

}  // namespace

NonlinearVerdict simulate(const NonlinearLoop& loop) {
  refuse_nonsense(loop);
  const double longest = loop.longest_s > 0.0 ? loop.longest_s : 16.0 * loop.duration_s;
  const double quarter_samples = std::ceil(0.25 * loop.duration_s / loop.plant.period_s);
  auto quarter = static_cast<std::uint64_t>(quarter_samples);
  LoopRun run(loop);
  Rest rest(loop);
  Quarters q;
  for (Stretch& s : q)
    s = run.run(quarter), rest.seen(s.position.width());
  bool was_hopeless = false;
  NonlinearVerdict v;
  for (;;) {
    const double length = 4.0 * static_cast<double>(quarter) * loop.plant.period_s;
    if (run.ran_away()) {
      v.outcome = LoopOutcome::kRunaway;
      break;
    }
    if (rest.covers(q[3].position.width())) {
      v.outcome = LoopOutcome::kRest;
      break;
    }
    // At this rate it will not have fallen by a tenth in a quarter of the longest run either.
    const bool hopeless = ratio(q, 3) > std::pow(kFalls, length / longest);
    if ((hopeless && was_hopeless) || 2.0 * length > longest * (1.0 + 1e-9)) {
      v.outcome = outcome_at_the_end(q);
      break;
    }
    was_hopeless = hopeless;
    q[0].add(q[1]), q[2].add(q[3]);
    q[1] = q[2];
    quarter *= 2;
    q[2] = run.run(quarter), q[3] = run.run(quarter);
  }
  v.stable = v.outcome == LoopOutcome::kRest || v.outcome == LoopOutcome::kDecaying;
  v.early_amplitude = q[2].position.width(), v.late_amplitude = q[3].position.width();
  v.late_effort = q[3].effort.width();
  v.energy_extracted_j = run.most_work();
  v.work_j = run.work();
  v.quiet = rest.quiet();
  v.end_position = run.position();
  for (const Stretch& s : q)
    v.deepest = std::max(v.deepest, s.position.high);
  v.simulated_s = run.time();
  v.statistics = run.statistics();
  return v;
}

double quantiser_gain(const NonlinearLoop& loop, double contact_stiffness) {
  constexpr int kMaxSamples = 1'000'000;
  NonlinearLoop linear;
  linear.plant = loop.plant;
  linear.controller = loop.controller;
  linear.contact_stiffness = contact_stiffness;
  linear.wall = WallLaw::kBilateral;
  refuse_nonsense(linear);
  if (!(coupling::design::spectral_radius(linear.plant, linear.controller, contact_stiffness) <
        1.0))
    return 1.0;
  LoopRun run(linear);
  run.misread_once(1.0);
  double sum = 0.0;
  for (int length = 256; length < kMaxSamples;
       length *= 2) {  // the run's length doubles with each block
    double part = 0.0;
    for (int i = 0; i < length; ++i)
      run.run(1), part += std::abs(run.position());
    sum += part;
    if (part <= 1e-2 * sum)
      break;
  }
  return sum;
}

double simulated_limit(NonlinearLoop loop, double stable, double highest, double accuracy) {
  const auto holds = [&](double stiffness) {
    loop.contact_stiffness = stiffness;
    return simulate(loop).stable;
  };
  if (!holds(stable))
    return stable;
  double low = stable, high = 2.0 * stable;
  for (; high < highest && holds(high); high *= 2.0)
    low = high;
  if (high >= highest) {
    if (holds(highest))
      return highest;
    high = highest;
  }
  while (high > low * (1.0 + accuracy)) {
    const double middle = std::sqrt(low * high);
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

double settling_time(const NonlinearLoop& loop) {
  const coupling::design::LoopPlant& p = loop.plant;
  const double mass = p.mass + p.hand_mass, damping = p.damping + p.hand_damping;
  double slowest = std::max(p.period_s, p.effort_lag_s);
  if (damping > 0.0) {
    const double rate = 0.5 * damping / mass, w2 = p.hand_stiffness / mass;
    // Two real poles of a gripped device: the slower one is near B / k_h. A free one has none: its
    // energy decays by B.
    const double slower = rate * rate > w2 && w2 > 0.0 ? rate + std::sqrt(rate * rate - w2) : 0.0;
    slowest = std::max({slowest, 1.0 / rate, slower > 0.0 ? slower / w2 : 0.0});
  }
  if (loop.controller.law == coupling::design::LoopController::Law::kShapingFilter)
    slowest =
        std::max(slowest, (loop.controller.damping_ratio + 1.0) / loop.controller.w0_rad_per_s);
  if (loop.controller.velocity_filter_rad_per_s > 0.0)
    slowest = std::max(slowest, 1.0 / loop.controller.velocity_filter_rad_per_s);
  return slowest;
}

}  // namespace voxtouch::coupling_models
