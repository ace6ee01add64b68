#include "core/coupling/design/nonlinear_loop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/coupling/design/exact_plant.hpp"
#include "core/coupling/design/loop_law.hpp"
#include "core/coupling/design/random.hpp"

namespace voxtouch {
namespace {

/// Efforts that are under way to the device, by time of arrival, counted from the current sample.
class EffortsUnderWay {
 public:
  struct Effort {
    double in_s, value;
  };
  static constexpr std::size_t kMost = 256;

  /// The newest effort; those that would arrive after it have been overtaken and are dropped. Their number.
  std::uint64_t send(double in_s, double value) noexcept {
    std::uint64_t dropped = 0;
    for (; size_ > 0 && at(size_ - 1).in_s >= in_s; --size_) ++dropped;
    if (size_ < kMost) at(size_++) = {in_s, value};
    return dropped;
  }
  bool any_within(double period_s) noexcept { return size_ > 0 && at(0).in_s < period_s; }
  Effort take() noexcept {
    const Effort first = at(0);
    first_ = (first_ + 1) % kMost, --size_;
    return first;
  }
  void pass(double period_s) noexcept {
    for (std::size_t i = 0; i < size_; ++i) at(i).in_s -= period_s;
  }

 private:
  Effort& at(std::size_t i) noexcept { return ring_[(first_ + i) % kMost]; }
  std::array<Effort, kMost> ring_{};
  std::size_t first_ = 0, size_ = 0;
};

struct Range {
  double low = INFINITY, high = -INFINITY;
  void add(double x) noexcept { low = std::min(low, x), high = std::max(high, x); }
  void add(const Range& r) noexcept { low = std::min(low, r.low), high = std::max(high, r.high); }
  double width() const noexcept { return high > low ? high - low : 0.0; }
};

/// What a stretch of the run has seen.
struct Stretch {
  Range position, effort;
  void add(const Stretch& s) noexcept { position.add(s.position), effort.add(s.effort); }
};

class LoopRun {
 public:
  explicit LoopRun(const NonlinearLoop& loop)
      : loop_(loop), law_(loop), plant_(loop.plant, loop.coulomb_friction, loop.push), random_(loop.seed, 0) {
    plant_.set(loop.start_position, loop.start_speed);
    statistics_.period_min = statistics_.delay_min = INFINITY;
    measured_ = quantised(loop.start_position);
  }

  Stretch run(std::uint64_t samples) noexcept {
    Stretch out;
    for (std::uint64_t i = 0; i < samples && !ran_away(); ++i) sample(out);
    return out;
  }
  bool ran_away() const noexcept { return !(std::abs(plant_.position()) < kRunaway); }
  double most_work() const noexcept { return most_work_; }
  double work() const noexcept { return plant_.work(); }
  double position() const noexcept { return plant_.position(); }
  double time() const noexcept { return time_; }
  LoopStatistics statistics() const noexcept {
    LoopStatistics s = statistics_;
    s.period_mean = s.samples > 0 ? time_ / static_cast<double>(s.samples) : 0.0;
    return s;
  }
  void misread_once(double error) noexcept { error_ = error; }

 private:
  double quantised(double x) const noexcept {
    return loop_.resolution > 0.0 ? loop_.resolution * std::floor(x / loop_.resolution + 0.5) : x;
  }
  bool disturbed() const noexcept { return time_ >= loop_.disturbance.at_s; }
  double stiffness() const noexcept {
    const LoopDisturbance& d = loop_.disturbance;
    if (d.stiffness_factor == 1.0 || !disturbed()) return loop_.contact_stiffness;
    const double share = d.stiffness_ramp_s > 0.0 ? std::min(1.0, (time_ - d.at_s) / d.stiffness_ramp_s) : 1.0;
    return loop_.contact_stiffness * (1.0 + share * (d.stiffness_factor - 1.0));
  }
  bool loses() noexcept {
    const LoopDisturbance& d = loop_.disturbance;
    if (d.silence_s > 0.0 && disturbed() && time_ < d.at_s + d.silence_s) return true;
    return loop_.loss > 0.0 && random_.chance(loop_.loss) && lost_in_a_row_ < loop_.most_lost_in_a_row;
  }
  void measure() noexcept {
    ++statistics_.samples;
    if (loses()) {
      ++statistics_.lost, ++lost_in_a_row_;
      statistics_.longest_loss = std::max(statistics_.longest_loss, static_cast<std::uint64_t>(lost_in_a_row_));
      return;
    }
    lost_in_a_row_ = 0;
    const double noise =
        loop_.measurement_noise > 0.0 ? random_.uniform(-loop_.measurement_noise, loop_.measurement_noise) : 0.0;
    measured_ = quantised(plant_.position() + noise) + std::exchange(error_, 0.0);
  }
  double faded(double effort) noexcept {
    if (loop_.fade_after_lost <= 0) return effort;
    const double step = lost_in_a_row_ > loop_.fade_after_lost ? -1.0 / kFadeOutS : 1.0 / kFadeInS;
    weight_ = std::clamp(weight_ + step * loop_.plant.period_s, 0.0, 1.0);
    return weight_ * effort;
  }
  double delay() noexcept {
    double out = loop_.plant.delay_s;
    if (disturbed()) out = std::max(0.0, out + loop_.disturbance.more_delay_s);
    if (loop_.delay_jitter_s > 0.0) out += random_.uniform(0.0, loop_.delay_jitter_s);
    statistics_.delay_min = std::min(statistics_.delay_min, out);
    statistics_.delay_max = std::max(statistics_.delay_max, out);
    return out;
  }
  void move(double h, Stretch& out) noexcept {
    if (h > 0.0) plant_.advance(h, applied_);
    out.position.add(plant_.position());
  }
  void sample(Stretch& out) noexcept {
    measure();
    const double nominal = loop_.plant.period_s;
    const double effort = faded(law_.step(measured_, stiffness(), loop_.measured_period ? last_period_ : nominal));
    out.effort.add(effort);
    statistics_.saturated += law_.saturated() ? 1 : 0;
    statistics_.overtaken += under_way_.send(delay(), effort);
    const double period = loop_.jitter > 0.0 ? nominal * (1.0 + loop_.jitter * random_.uniform(-1.0, 1.0)) : nominal;
    double now = 0.0;
    while (under_way_.any_within(period)) {
      const EffortsUnderWay::Effort next = under_way_.take();
      const double at = std::max(now, next.in_s);
      move(at - now, out);
      now = at, applied_ = next.value;
    }
    move(period - now, out);
    under_way_.pass(period);
    most_work_ = std::max(most_work_, plant_.work());
    statistics_.period_min = std::min(statistics_.period_min, period);
    statistics_.period_max = std::max(statistics_.period_max, period);
    last_period_ = period, time_ += period;
  }

  const NonlinearLoop& loop_;
  LoopLaw law_;
  ExactPlant plant_;
  Random random_;
  EffortsUnderWay under_way_;
  LoopStatistics statistics_;
  double measured_ = 0.0, applied_ = 0.0, error_ = 0.0, weight_ = 1.0, most_work_ = 0.0, time_ = 0.0;
  double last_period_ = loop_.plant.period_s;
  int lost_in_a_row_ = 0;
};

void refuse_nonsense(const NonlinearLoop& l) {
  const auto need = [](bool kept, const char* sentence) {
    if (!kept) throw std::invalid_argument(std::string("Simulated loop: ") + sentence);
  };
  need(l.plant.mass + l.plant.hand_mass > 0.0, "the mass of device and hand together must be above 0.");
  need(l.plant.damping + l.plant.hand_damping >= 0.0, "the damping must not be below 0.");
  need(l.plant.period_s > 0.0 && l.duration_s > 0.0, "period and duration must be above 0.");
  need(l.jitter >= 0.0 && l.jitter < 1.0, "the jitter must be in [0, 1).");
  need(l.plant.delay_s >= 0.0 && l.delay_jitter_s >= 0.0, "delay and its jitter must not be below 0.");
  const double latest = l.plant.delay_s + l.delay_jitter_s + std::max(0.0, l.disturbance.more_delay_s);
  need(latest < 0.9 * EffortsUnderWay::kMost * l.plant.period_s * (1.0 - l.jitter), "the delay is beyond 200 periods.");
}

/// The rest that the quantiser may leave; the loop's linear response is only found where it decides.
class Rest {
 public:
  Rest(const NonlinearLoop& loop) : loop_(loop), amplitude_(loop.resolution) {}
  void seen(double amplitude) noexcept { largest_ = std::max(largest_, amplitude); }
  bool covers(double amplitude) {
    if (amplitude <= quiet()) return true;
    if (asked_ || loop_.resolution <= 0.0 || amplitude > kMostSteps * loop_.resolution) return false;
    asked_ = true;
    double gain = quantiser_gain(loop_, loop_.contact_stiffness);
    if (loop_.wall == WallLaw::kSoftening || loop_.wall == WallLaw::kHardening)
      gain = std::max(gain, quantiser_gain(loop_, 0.3 * loop_.contact_stiffness));
    amplitude_ = loop_.resolution * std::clamp(gain, 1.0, kMostSteps);
    return amplitude <= quiet();
  }
  double quiet() const noexcept { return std::max(amplitude_, 1e-4 * largest_); }

 private:
  static constexpr double kMostSteps = 30.0;
  const NonlinearLoop& loop_;
  double amplitude_, largest_ = 0.0;
  bool asked_ = false;
};

/// Peak to peak of the quarters of a run.
using Quarters = std::array<Stretch, 4>;

constexpr double kFalls = 0.9;  ///< a quarter this much smaller than the one before it: the run decays

double ratio(const Quarters& q, std::size_t i) { return q[i].position.width() / q[i - 1].position.width(); }

LoopOutcome outcome_at_the_end(const Quarters& q) {
  const double last = ratio(q, 3), before = ratio(q, 2);
  const bool flattens = std::log(last) > 0.5 * std::log(before);  // both below zero while it falls
  return last < kFalls && before < kFalls && !flattens ? LoopOutcome::kDecaying : LoopOutcome::kSustained;
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
  for (Stretch& s : q) s = run.run(quarter), rest.seen(s.position.width());
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
  for (const Stretch& s : q) v.deepest = std::max(v.deepest, s.position.high);
  v.simulated_s = run.time();
  v.statistics = run.statistics();
  return v;
}

double quantiser_gain(const NonlinearLoop& loop, double contact_stiffness) {
  constexpr int kMostSamples = 1'000'000;
  NonlinearLoop linear;
  linear.plant = loop.plant;
  linear.controller = loop.controller;
  linear.contact_stiffness = contact_stiffness;
  linear.wall = WallLaw::kBilateral;
  refuse_nonsense(linear);
  if (!(spectral_radius(linear.plant, linear.controller, contact_stiffness) < 1.0)) return 1.0;
  LoopRun run(linear);
  run.misread_once(1.0);
  double sum = 0.0;
  for (int length = 256; length < kMostSamples; length *= 2) {  // the run's length doubles with each block
    double part = 0.0;
    for (int i = 0; i < length; ++i) run.run(1), part += std::abs(run.position());
    sum += part;
    if (part <= 1e-2 * sum) break;
  }
  return sum;
}

double simulated_limit(NonlinearLoop loop, double stable, double highest, double accuracy) {
  const auto holds = [&](double stiffness) {
    loop.contact_stiffness = stiffness;
    return simulate(loop).stable;
  };
  if (!holds(stable)) return stable;
  double low = stable, high = 2.0 * stable;
  for (; high < highest && holds(high); high *= 2.0) low = high;
  if (high >= highest) {
    if (holds(highest)) return highest;
    high = highest;
  }
  while (high > low * (1.0 + accuracy)) {
    const double middle = std::sqrt(low * high);
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

double settling_time(const NonlinearLoop& loop) {
  const LoopPlant& p = loop.plant;
  const double mass = p.mass + p.hand_mass, damping = p.damping + p.hand_damping;
  double slowest = std::max(p.period_s, p.effort_lag_s);
  if (damping > 0.0) {
    const double rate = 0.5 * damping / mass, w2 = p.hand_stiffness / mass;
    // Two real poles of a held device: the slower one is near B / k_h. A free one has none of its own: its energy fades by B.
    const double slower = rate * rate > w2 && w2 > 0.0 ? rate + std::sqrt(rate * rate - w2) : 0.0;
    slowest = std::max({slowest, 1.0 / rate, slower > 0.0 ? slower / w2 : 0.0});
  }
  if (loop.controller.law == LoopController::Law::kShapingFilter)
    slowest = std::max(slowest, (loop.controller.damping_ratio + 1.0) / loop.controller.w0_rad_per_s);
  if (loop.controller.velocity_filter_rad_per_s > 0.0)
    slowest = std::max(slowest, 1.0 / loop.controller.velocity_filter_rad_per_s);
  return slowest;
}

}  // namespace voxtouch
