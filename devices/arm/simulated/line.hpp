#pragma once
/// The network between controller and remote side, with the scheduled faults. It uses no socket.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "devices/arm/simulated/faults.hpp"

namespace voxtouch::arm_sim {

/// Measurements in transit, ordered by their send time. Random decisions use one generator per kind
/// of fault, so that faults are independent; equal seeds and calls give equal decisions. Real-time
/// safe after construction.
template <class Payload>
class Line {
 public:
  Line(FaultSchedule faults, double period_s, std::uint64_t seed)
      : faults_(std::move(faults)),
        period_s_(period_s) {
    for (std::size_t i = 0; i < kFaultKinds; ++i) {
      std::seed_seq mixed{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                          static_cast<std::uint32_t>(i)};
      random_[i].seed(mixed);
    }
    waiting_.reserve(kCapacity);
  }

  struct Packet {
    double due_s = 0.0;
    double sent_s = 0.0;  ///< regular send time
    Payload msr{};
  };
  struct Counts {
    std::uint64_t lost = 0, delayed = 0, reordered = 0, duplicated = 0, answers_lost = 0;
  };

  /// Sends a measurement made at `now_s`. A full line drops its oldest packet.
  void put(const Payload& msr, double now_s) noexcept {
    if (happens(FaultKind::kLoss, now_s)) {
      ++counts_.lost;
      return;
    }
    double delay = faults_.active(FaultKind::kLate, now_s).value_or(0.0);
    if (const auto most = faults_.active(FaultKind::kJitter, now_s))
      delay += *most * uniform(FaultKind::kJitter);
    if (delay > 0.0)
      ++counts_.delayed;
    reordering_ = !reordering_ && happens(FaultKind::kReorder, now_s);
    if (reordering_) {
      ++counts_.reordered;
      delay += 1.05 * period_s_;  // just after its successor
    }
    queue(msr, now_s, delay);
    if (!happens(FaultKind::kDuplicate, now_s))
      return;
    ++counts_.duplicated;
    queue(msr, now_s, delay);
  }
  /// The next one with a send time below `until_s`; null without one. Valid until the next call.
  const Packet* take(double until_s) noexcept {
    if (waiting_.empty() || !(waiting_.front().due_s < until_s))
      return nullptr;
    taken_ = waiting_.front();
    waiting_.erase(waiting_.begin());
    return &taken_;
  }
  /// Send time of the next one; infinity if none waits.
  double next_due_s() const noexcept {
    return waiting_.empty() ? std::numeric_limits<double>::infinity() : waiting_.front().due_s;
  }
  /// Whether a reply that arrives now is lost.
  bool loses_answer(double now_s) noexcept {
    if (!happens(FaultKind::kAnswerLoss, now_s))
      return false;
    ++counts_.answers_lost;
    return true;
  }
  bool silent(double now_s) const noexcept {
    return faults_.active(FaultKind::kSilent, now_s).has_value();
  }
  const Counts& counts() const noexcept { return counts_; }

 private:
  static constexpr std::size_t kCapacity = 2048;  // a second late at 1 kHz, duplicated

  double uniform(FaultKind kind) noexcept {
    return static_cast<double>(random_[static_cast<std::size_t>(kind)]() >> 11) * 0x1p-53;
  }
  bool happens(FaultKind kind, double now_s) noexcept {
    const auto fraction = faults_.active(kind, now_s);
    return fraction && uniform(kind) < *fraction;
  }
  void queue(const Payload& msr, double now_s, double delay_s) noexcept {
    if (waiting_.size() == kCapacity)
      waiting_.erase(waiting_.begin());
    const double due = now_s + delay_s;
    const auto later = std::find_if(waiting_.begin(), waiting_.end(),
                                    [due](const Packet& p) { return p.due_s > due; });
    waiting_.insert(later, Packet{due, now_s, msr});
  }

  FaultSchedule faults_;
  double period_s_;
  std::array<std::mt19937_64, kFaultKinds> random_;
  std::vector<Packet> waiting_;  // by due time; capacity fixed
  Packet taken_;
  bool reordering_ = false;
  Counts counts_;
};

}  // namespace voxtouch::arm_sim
