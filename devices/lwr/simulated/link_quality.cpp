#include "devices/lwr/simulated/link_quality.hpp"

#include <algorithm>

namespace voxtouch::lwr_sim {

namespace {

// The thresholds of the real controller are not published: all of these are assumed.
constexpr int kOkAfter = 10;         // consecutive replies in time
constexpr int kPerfectAfter = 20;    // consecutive replies in time
constexpr int kMissesInARow = 5;     // consecutive misses that make the link UNACCEPTABLE
constexpr int kMissesInWindow = 10;  // more misses than this in the last 100 make it BAD

}  // namespace

void LinkQuality::push(bool in_time, double latency_s) noexcept {
  missed_in_window_ += (in_time ? 0 : 1) - (was_missed_[next_] ? 1 : 0);
  latency_[next_] = in_time ? std::max(latency_s, 0.0) : -1.0;
  was_missed_[next_] = !in_time;
  next_ = (next_ + 1) % kWindow;
  count_ = std::min(count_ + 1, kWindow);
}

void LinkQuality::answered(double latency_s) noexcept {
  push(true, latency_s);
  ++answered_run_;
  missed_run_ = 0;
  lwr::fri::Quality earned = lwr::fri::Quality::kBad;
  if (answered_run_ >= kOkAfter)
    earned = lwr::fri::Quality::kOk;
  if (answered_run_ >= kPerfectAfter)
    earned = lwr::fri::Quality::kPerfect;
  if (earned <= quality_)
    return;
  quality_ = earned;
  if (earned != lwr::fri::Quality::kPerfect)
    return;
  was_missed_.fill(false);
  missed_in_window_ = 0;
}

void LinkQuality::missed() noexcept {
  push(false, 0.0);
  answered_run_ = 0;
  ++missed_run_;
  ++misses_;
  lwr::fri::Quality most = lwr::fri::Quality::kPerfect;
  if (missed_run_ >= 2)
    most = lwr::fri::Quality::kOk;
  if (missed_in_window_ > kMissesInWindow)
    most = lwr::fri::Quality::kBad;
  if (missed_run_ >= kMissesInARow)
    most = lwr::fri::Quality::kUnacceptable;
  quality_ = std::min(quality_, most);
}

lwr::fri::Statistics LinkQuality::statistics() const noexcept {
  lwr::fri::Statistics out{};
  out.miss_counter = misses_;
  if (count_ == 0)
    return out;
  double sum = 0.0, least = 1e300, most = 0.0;
  int answers = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    if (latency_[i] < 0.0)
      continue;
    ++answers;
    sum += latency_[i];
    least = std::min(least, latency_[i]);
    most = std::max(most, latency_[i]);
  }
  const double all = static_cast<double>(count_);
  out.answer_rate = static_cast<float>(answers / all);
  out.miss_rate = static_cast<float>((all - answers) / all);
  if (answers == 0)
    return out;
  out.latency_s = static_cast<float>(sum / answers);
  out.jitter_s = static_cast<float>(most - least);
  return out;
}

}  // namespace voxtouch::lwr_sim
