#include "devices/lwr/simulated/line.hpp"

#include <algorithm>
#include <limits>

namespace voxtouch::lwr_sim {
namespace {

constexpr std::size_t kCapacity = 2048;  // a second late at 1 kHz, twice

}  // namespace

Line::Line(FaultSchedule faults, double period_s, std::uint64_t seed)
    : faults_(std::move(faults)), period_s_(period_s) {
  for (std::size_t i = 0; i < kFaultKinds; ++i) {
    std::seed_seq mixed{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                        static_cast<std::uint32_t>(i)};
    dice_[i].seed(mixed);
  }
  waiting_.reserve(kCapacity);
}

double Line::uniform(FaultKind kind) noexcept {
  return static_cast<double>(dice_[static_cast<std::size_t>(kind)]() >> 11) * 0x1p-53;
}

bool Line::happens(FaultKind kind, double now_s) noexcept {
  const auto share = faults_.active(kind, now_s);
  return share && uniform(kind) < *share;
}

void Line::queue(const lwr::fri::MsrPacket& msr, double now_s, double delay_s) noexcept {
  if (waiting_.size() == kCapacity) waiting_.erase(waiting_.begin());
  const double due = now_s + delay_s;
  const auto later = std::find_if(waiting_.begin(), waiting_.end(), [due](const Packet& p) { return p.due_s > due; });
  waiting_.insert(later, Packet{due, now_s, msr});
}

void Line::put(const lwr::fri::MsrPacket& msr, double now_s) noexcept {
  if (happens(FaultKind::kLoss, now_s)) {
    ++counts_.lost;
    return;
  }
  double delay = faults_.active(FaultKind::kLate, now_s).value_or(0.0);
  if (const auto most = faults_.active(FaultKind::kJitter, now_s)) delay += *most * uniform(FaultKind::kJitter);
  if (delay > 0.0) ++counts_.delayed;
  reordering_ = !reordering_ && happens(FaultKind::kReorder, now_s);
  if (reordering_) {
    ++counts_.reordered;
    delay += 1.05 * period_s_;  // just after its successor
  }
  queue(msr, now_s, delay);
  if (!happens(FaultKind::kDuplicate, now_s)) return;
  ++counts_.duplicated;
  queue(msr, now_s, delay);
}

const Line::Packet* Line::take(double until_s) noexcept {
  if (waiting_.empty() || !(waiting_.front().due_s < until_s)) return nullptr;
  taken_ = waiting_.front();
  waiting_.erase(waiting_.begin());
  return &taken_;
}

double Line::next_due_s() const noexcept {
  return waiting_.empty() ? std::numeric_limits<double>::infinity() : waiting_.front().due_s;
}

bool Line::loses_answer(double now_s) noexcept {
  if (!happens(FaultKind::kAnswerLoss, now_s)) return false;
  ++counts_.answers_lost;
  return true;
}

}  // namespace voxtouch::lwr_sim
