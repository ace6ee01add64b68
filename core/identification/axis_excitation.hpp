#pragma once
/// The force of each sample while one axis is measured: hold, break-away, pulses, strokes, tones.
#include <algorithm>
#include <array>
#include <optional>

#include "core/identification/axis_record.hpp"
#include "core/identification/holding_spring.hpp"
#include "core/identification/safety_rules.hpp"
#include "core/identification/stroke_plan.hpp"

namespace voxtouch::identification {

/// A step kFit... holds the axis until `resume`.
enum class Step : std::uint8_t {
  kHold,
  kBreakAwayForward,
  kRestForward,
  kBreakAwayBackward,
  kRestBackward,
  kPulses,
  kPulseRest,
  kFitPulses,
  kProbeStroke,
  kFitProbe,
  kSecondProbe,
  kFitSecondProbe,
  kStrokes,
  kDenseTones,
  kFitAll,
  kFinished
};

/// The last pulse: force over friction, length of its first part and the path that it made.
struct PulseResult {
  double force_n = 0.0, length_s = 0.0, path_m = 0.0;
};

/// Input of a fit. The record does not change while the axis waits.
struct FitInput {
  const AxisRecord* record = nullptr;
  Step step = Step::kFinished;
  AxisModel model;
  AxisLimits limits;
  PulseResult pulse;
  double encoder_step_m = 0.0, break_away_n = 0.0;
};

/// The encoder step of a moving axis. The tip of an arm has no common step: its joints add small
/// increments to the usual ones, so the smallest increment is meaningless. Real-time safe.
class EncoderIncrements {
 public:
  void add(double increment_m) noexcept {
    if (increment_m < 1e-9)
      return;
    smallest_ = smallest_ == 0.0 ? increment_m : std::min(smallest_, increment_m);
    block_[count_++] = increment_m;
    if (count_ < block_.size())
      return;
    count_ = 0;
    std::ranges::nth_element(block_, block_.begin() + kQuartile);
    step_ = step_ == 0.0 ? block_[kQuartile] : std::min(step_, block_[kQuartile]);
  }
  /// Smallest lower quartile of a block; the smallest increment until a block is full.
  double step_m() const noexcept { return step_ > 0.0 ? step_ : smallest_; }

 private:
  static constexpr std::size_t kQuartile = 4;
  std::array<double, 16> block_{};
  std::size_t count_ = 0;
  double smallest_ = 0.0, step_ = 0.0;
};

/// `step` is real-time safe and does not allocate after `start`. The axis waits in a hold while a
/// fit runs elsewhere: the caller fits when `waiting()` and then calls `resume`.
class AxisExcitation {
 public:
  /// Reserves the record. Allocates.
  void start(const AxisLimits& limits);

  /// Continues with the spring that held the axis, and with the forces of the other axes.
  void take_over(const HoldingSpring& spring, double force_n) noexcept {
    spring_ = spring;
    model_.bias_n = -force_n;
  }

  /// The force in reply to a sample [N]; always 0 after an outcome.
  double step(double time_s, double position_m) noexcept;
  /// The force after a guard, if it differs.
  void applied(double force_n, const CrossAxis& cross_axis = {}) noexcept {
    if (!waiting())
      record_.set_last(force_n, cross_axis);
  }
  FitInput fit_input() const noexcept;

  bool waiting() const noexcept {
    return step_ == Step::kFitPulses || step_ == Step::kFitProbe ||
           step_ == Step::kFitSecondProbe || step_ == Step::kFitAll;
  }
  /// Continues with the result of the fit. Real-time safe.
  void resume(const AxisModel& model) noexcept;
  /// Ends at zero force.
  void stop(Outcome outcome) noexcept;

  Step current() const noexcept { return step_; }
  bool finished() const noexcept { return step_ == Step::kFinished; }
  std::optional<Outcome> outcome() const noexcept { return outcome_; }
  const AxisRecord& record() const noexcept { return record_; }
  const AxisModel& model() const noexcept { return model_; }
  /// Mean of both break-away forces, or the largest force without motion.
  double break_away_n() const noexcept;
  /// Encoder step as the slowest motion so far shows it [m]; 0: none.
  double encoder_step_m() const noexcept { return increments_.step_m(); }
  double origin_m() const noexcept { return safety_.origin_m(); }

 private:
  struct Stroke {
    StrokePlan plan;
    double start_s = 0.0, path_m = 0.0, tone_scale = 1.0, late_m = 0.0, until_s = 0.0;
    int index = 0, direction = 0;
  };
  double break_away(double time_s, double position_m, int direction) noexcept;
  double pulse(double time_s, double position_m) noexcept;
  double stroke(double time_s, double position_m) noexcept;
  double dispatch(double time_s, double position_m) noexcept;
  void next(Step step, double time_s) noexcept;
  void begin_strokes(double time_s, double position_m) noexcept;
  void begin_stroke(double time_s, double position_m) noexcept;
  double limited(double force_n) const noexcept;
  void finish_break_away() noexcept;

  AxisLimits limits_;
  SafetyRules safety_;
  HoldingSpring spring_;
  AxisRecord record_;
  AxisModel model_;
  Stroke stroke_;
  Step step_ = Step::kHold;
  std::optional<Outcome> outcome_;
  struct Ramp {
    double force_n = 0.0, first_s = 0.0, first_m = 0.0;
    bool moved = false, wrong_direction = false;
  };
  Ramp forward_, backward_;
  double step_start_s_ = 0.0, last_time_s_ = 0.0, last_position_m_ = 0.0, base_force_n_ = 0.0;
  double start_position_m_ = 0.0;
  struct Pulse {
    double force_n = 0.0, length_s = 0.0, start_s = 0.0, least_m = 0.0, most_m = 0.0, end_s = 0.0;
  };
  Pulse pulse_;
  PulseResult last_pulse_;
  bool first_ = true;
  EncoderIncrements increments_;
  RecordEntry entry_;
};

}  // namespace voxtouch::identification
