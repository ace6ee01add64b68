#pragma once
/// How far a measurement of several steps is, and so how long the rest takes.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace voxtouch::accuracy {

/// Kinds of steps; steps of one kind take similar times.
enum class Step : std::uint8_t { kPlaces, kBuild, kTruth, kToolTruth, kJudge, kPhase, kCount };

/// Each step is planned with its estimated time. The ratio of measured to estimated time of a kind
/// corrects its other steps, so an estimate that is wrong by a factor of ten costs at most one
/// step. Without a clock the estimates are used.
class MeasuredProgress {
 public:
  /// `left_s`: estimated time left on the clock.
  using Report = std::function<void(const std::string& what, double fraction, double left_s)>;

  /// `now_s`: a clock, or none.
  MeasuredProgress(std::function<double()> now_s, Report report)
      : now_s_(std::move(now_s)),
        report_(std::move(report)) {}

  void plan(Step kind, double estimate_s) { of(kind).planned_s += estimate_s; }
  /// The step before has ended, and the next of `kind` begins.
  void begin(Step kind, std::string what, double estimate_s) {
    end();
    kind_ = kind, what_ = std::move(what), estimate_s_ = estimate_s, begun_s_ = now();
    of(kind).planned_s = std::max(0.0, of(kind).planned_s - estimate_s);
    at(0.0);
  }
  /// `fraction` of the present step is done.
  void at(double fraction) {
    if (!report_)
      return;
    const double gone = now_s_ ? now() - begun_s_ : fraction * estimate_s_;
    const bool reports_itself = now_s_ && fraction > kReportedRatio &&
                                estimate_s_ > 0.0;  // the present step, of itself and of its kind
    double left =
        (1.0 - fraction) *
        (reports_itself ? gone / fraction : std::max(estimate_s_ * correction(kind_), gone));
    for (std::size_t k = 0; k < kinds_.size(); ++k) {
      const bool present = reports_itself && static_cast<Step>(k) == kind_;
      left += kinds_[k].planned_s * (present ? (kinds_[k].took_s + gone) /
                                                   (kinds_[k].estimated_s + fraction * estimate_s_)
                                             : correction(static_cast<Step>(k)));
    }
    const double done = done_s_ + gone;
    if (done + left > 0.0)
      last_ = std::max(last_, std::clamp(done / (done + left), 0.0, 1.0));
    report_(what_, last_, left);
  }

 private:
  struct Kind {
    double planned_s = 0.0;                  ///< estimates of the remaining steps
    double estimated_s = 0.0, took_s = 0.0;  ///< of those done
  };
  static constexpr double kReportedRatio =
      0.05;  ///< from this fraction on a step reports its progress

  Kind& of(Step kind) { return kinds_[static_cast<std::size_t>(kind)]; }
  double now() const { return now_s_ ? now_s_() : 0.0; }
  double correction(Step kind) const {
    const Kind& k = kinds_[static_cast<std::size_t>(kind)];
    if (k.estimated_s > 0.0)
      return k.took_s / k.estimated_s;
    return estimated_s_ > 0.0 ? took_s_ / estimated_s_ : 1.0;
  }
  void end() {
    const double took = now_s_ ? now() - begun_s_ : estimate_s_;
    if (estimate_s_ > 0.0) {
      of(kind_).estimated_s += estimate_s_, of(kind_).took_s += took;
      estimated_s_ += estimate_s_, took_s_ += took;
    }
    if (estimate_s_ > 0.0 || !what_.empty())
      done_s_ += took;
  }

  std::array<Kind, static_cast<std::size_t>(Step::kCount)> kinds_;
  std::function<double()> now_s_;
  Report report_;
  Step kind_ = Step::kPlaces;
  std::string what_;
  double estimate_s_ = 0.0, begun_s_ = 0.0, done_s_ = 0.0, estimated_s_ = 0.0, took_s_ = 0.0,
         last_ = 0.0;
};

}  // namespace voxtouch::accuracy
