#pragma once
/// Finds new measurements by a wrapping 16-bit count, over a network that may lose, duplicate and
/// reorder.
#include <cstdint>

#include "devices/lwr/fri_codec.hpp"

namespace voxtouch::lwr::fri {

struct SequenceCounts {
  std::uint64_t accepted = 0;
  std::uint64_t lost = 0;       ///< skipped counts, including those that arrived late (`reordered`)
  std::uint64_t reordered = 0;  ///< older than the newest
  std::uint64_t duplicates = 0;  ///< equal to the newest
  std::uint64_t restarts = 0;    ///< the controller restarted its count
};

/// A pure function of its inputs; real-time safe.
class SequenceTracker {
 public:
  enum class Verdict : std::uint8_t { kNew, kDuplicate, kOld };

  /// An older count is outdated, unless `kRestartRun` of them arrive in one ascending run: the
  /// controller has then restarted its count.
  Verdict update(std::uint16_t sequence) noexcept {
    if (!started_)
      return accept(sequence, 1);
    const std::int32_t ahead = sequence_distance(newest_, sequence);
    if (ahead > 0) {
      counts_.lost += static_cast<std::uint64_t>(ahead - 1);
      return accept(sequence, static_cast<std::uint32_t>(ahead));
    }
    if (ahead == 0)
      return ++counts_.duplicates, Verdict::kDuplicate;
    ++counts_.reordered;
    run_ = run_ && sequence_distance(last_old_, sequence) == 1 ? run_ + 1 : 1;
    last_old_ = sequence;
    if (run_ < kRestartRun)
      return Verdict::kOld;
    ++counts_.restarts;
    return accept(sequence, 1);
  }
  /// After a silence any count is new, because it may have wrapped.
  void forget() noexcept { started_ = false; }

  /// Periods from the previous accepted measurement to the newest, at least 1.
  std::uint32_t steps() const noexcept { return steps_; }
  std::uint16_t newest() const noexcept { return newest_; }
  const SequenceCounts& counts() const noexcept { return counts_; }

  static constexpr std::uint32_t kRestartRun = 8;

 private:
  Verdict accept(std::uint16_t sequence, std::uint32_t steps) noexcept {
    started_ = true, newest_ = sequence, steps_ = steps, run_ = 0;
    ++counts_.accepted;
    return Verdict::kNew;
  }

  bool started_ = false;
  std::uint16_t newest_ = 0, last_old_ = 0;
  std::uint32_t steps_ = 1, run_ = 0;
  SequenceCounts counts_;
};

}  // namespace voxtouch::lwr::fri
