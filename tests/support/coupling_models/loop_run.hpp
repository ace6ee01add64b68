#pragma once
/// One simulated run, sample by sample; nonlinear_loop.cpp sets its duration and evaluates it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "tests/support/coupling_models/exact_plant.hpp"
#include "tests/support/coupling_models/loop_law.hpp"
#include "tests/support/coupling_models/random.hpp"

namespace voxtouch::coupling_models {

/// Pending efforts, by time of arrival at the device, counted from the current sample.
class PendingEfforts {
 public:
  struct Effort {
    double in_s, value;
  };
  static constexpr std::size_t kMaxEfforts = 256;

  /// Adds the newest effort; drops those that would arrive after it, and returns their number.
  std::uint64_t send(double in_s, double value) noexcept {
    std::uint64_t dropped = 0;
    for (; size_ > 0 && at(size_ - 1).in_s >= in_s; --size_)
      ++dropped;
    if (size_ < kMaxEfforts)
      at(size_++) = {in_s, value};
    return dropped;
  }
  bool any_within(double period_s) noexcept { return size_ > 0 && at(0).in_s < period_s; }
  Effort take() noexcept {
    const Effort first = at(0);
    first_ = (first_ + 1) % kMaxEfforts, --size_;
    return first;
  }
  void pass(double period_s) noexcept {
    for (std::size_t i = 0; i < size_; ++i)
      at(i).in_s -= period_s;
  }

 private:
  Effort& at(std::size_t i) noexcept { return ring_[(first_ + i) % kMaxEfforts]; }
  std::array<Effort, kMaxEfforts> ring_{};
  std::size_t first_ = 0, size_ = 0;
};

struct Range {
  double low = INFINITY, high = -INFINITY;
  void add(double x) noexcept { low = std::min(low, x), high = std::max(high, x); }
  void add(const Range& r) noexcept { low = std::min(low, r.low), high = std::max(high, r.high); }
  double width() const noexcept { return high > low ? high - low : 0.0; }
};

/// Figures of a stretch of the run.
struct Stretch {
  Range position, effort;
  void add(const Stretch& s) noexcept { position.add(s.position), effort.add(s.effort); }
};

/// The loop in motion: measures, steps the law, sends its effort, moves the plant from event to
/// event.
class LoopRun {
 public:
  /// `loop` must outlive the run.
  explicit LoopRun(const NonlinearLoop& loop)
      : loop_(loop),
        law_(loop),
        plant_(loop.plant, loop.coulomb_friction, loop.push),
        random_(loop.seed, 0) {
    plant_.set(loop.start_position, loop.start_speed);
    statistics_.period_min = statistics_.delay_min = INFINITY;
    measured_ = quantised(loop.start_position);
  }

  /// So many samples, fewer if it runs away.
  Stretch run(std::uint64_t samples) noexcept {
    Stretch out;
    for (std::uint64_t i = 0; i < samples && !ran_away(); ++i)
      sample(out);
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
  /// The next sample is measured this much too large.
  void misread_once(double error) noexcept { error_ = error; }

 private:
  double quantised(double x) const noexcept {
    return loop_.resolution > 0.0 ? loop_.resolution * std::floor(x / loop_.resolution + 0.5) : x;
  }
  bool disturbed() const noexcept { return time_ >= loop_.disturbance.at_s; }
  double stiffness() const noexcept {
    const LoopDisturbance& d = loop_.disturbance;
    if (d.stiffness_factor == 1.0 || !disturbed())
      return loop_.contact_stiffness;
    const double fraction =
        d.stiffness_ramp_s > 0.0 ? std::min(1.0, (time_ - d.at_s) / d.stiffness_ramp_s) : 1.0;
    return loop_.contact_stiffness * (1.0 + fraction * (d.stiffness_factor - 1.0));
  }
  bool loses() noexcept {
    const LoopDisturbance& d = loop_.disturbance;
    if (d.silence_s > 0.0 && disturbed() && time_ < d.at_s + d.silence_s)
      return true;
    return loop_.loss > 0.0 && random_.chance(loop_.loss) &&
           consecutive_losses_ < loop_.most_consecutive_losses;
  }
  void measure() noexcept {
    ++statistics_.samples;
    if (loses()) {
      ++statistics_.lost, ++consecutive_losses_;
      statistics_.longest_loss =
          std::max(statistics_.longest_loss, static_cast<std::uint64_t>(consecutive_losses_));
      return;
    }
    consecutive_losses_ = 0;
    const double noise = loop_.measurement_noise > 0.0
                             ? random_.uniform(-loop_.measurement_noise, loop_.measurement_noise)
                             : 0.0;
    measured_ = quantised(plant_.position() + noise) + std::exchange(error_, 0.0);
  }
  double faded(double effort) noexcept {
    if (loop_.fade_after_lost <= 0)
      return effort;
    const double step =
        consecutive_losses_ > loop_.fade_after_lost ? -1.0 / kFadeOutS : 1.0 / kFadeInS;
    weight_ = std::clamp(weight_ + step * loop_.plant.period_s, 0.0, 1.0);
    return weight_ * effort;
  }
  double delay() noexcept {
    double out = loop_.plant.delay_s;
    if (disturbed())
      out = std::max(0.0, out + loop_.disturbance.more_delay_s);
    if (loop_.delay_jitter_s > 0.0)
      out += random_.uniform(0.0, loop_.delay_jitter_s);
    statistics_.delay_min = std::min(statistics_.delay_min, out);
    statistics_.delay_max = std::max(statistics_.delay_max, out);
    return out;
  }
  void move(double h, Stretch& out) noexcept {
    if (h > 0.0)
      plant_.advance(h, applied_);
    out.position.add(plant_.position());
  }
  void sample(Stretch& out) noexcept {
    measure();
    const double nominal = loop_.plant.period_s;
    const double effort =
        faded(law_.step(measured_, stiffness(), loop_.measured_period ? last_period_ : nominal));
    out.effort.add(effort);
    statistics_.saturated += law_.saturated() ? 1 : 0;
    statistics_.overtaken += pending_.send(delay(), effort);
    const double period =
        loop_.jitter > 0.0 ? nominal * (1.0 + loop_.jitter * random_.uniform(-1.0, 1.0)) : nominal;
    double now = 0.0;
    while (pending_.any_within(period)) {
      const PendingEfforts::Effort next = pending_.take();
      const double at = std::max(now, next.in_s);
      move(at - now, out);
      now = at, applied_ = next.value;
    }
    move(period - now, out);
    pending_.pass(period);
    most_work_ = std::max(most_work_, plant_.work());
    statistics_.period_min = std::min(statistics_.period_min, period);
    statistics_.period_max = std::max(statistics_.period_max, period);
    last_period_ = period, time_ += period;
  }

  const NonlinearLoop& loop_;
  LoopLaw law_;
  ExactPlant plant_;
  Random random_;
  PendingEfforts pending_;
  LoopStatistics statistics_;
  double measured_ = 0.0, applied_ = 0.0, error_ = 0.0, weight_ = 1.0, most_work_ = 0.0,
         time_ = 0.0;
  double last_period_ = loop_.plant.period_s;
  int consecutive_losses_ = 0;
};

}  // namespace voxtouch::coupling_models
