#pragma once
/// Which of two that play one role is followed, by the numbers of the samples that they answer. No
/// clock, thread or DDS.
#include <cstdint>
#include <optional>

namespace voxtouch::runtime {

/// Of the two, as one reader, or one of the two itself, knows them. One of them acts; the other's
/// answers are fenced until the acting one has left kUnanswered samples in a row without an answer.
/// So no sample is answered twice, and the numbers of what is taken only rise, whatever comes in
/// whatever order. Before the acting one's first answer nobody takes over. Real-time safe.
class Failover {
 public:
  enum class Place : std::uint8_t { kFirst, kSecond };
  enum class Verdict : std::uint8_t {
    kTaken,      ///< the acting one's next answer
    kTakenOver,  ///< the other's, and from here on the other acts
    kOld,  ///< the acting one's, to a sample that has an answer, or that a later one was answered
           ///< before
    kFenced,  ///< the other's, while the acting one answers
  };
  /// As long as a device holds a command: with the way of the next answer a takeover is within five
  /// periods.
  static constexpr std::uint64_t kUnanswered = 3;

  explicit Failover(Place acting = Place::kFirst, std::uint64_t unanswered = kUnanswered) noexcept
      : acting_(acting),
        unanswered_(unanswered) {}

  /// Another session: no sample of it has been answered. Who acts goes on.
  void begin() noexcept { last_.reset(); }

  /// An answer of `place` to the sample `sequence` has come.
  Verdict hear(Place place, std::uint64_t sequence) noexcept {
    if (place == acting_) {
      if (last_ && sequence <= *last_)
        return Verdict::kOld;
      last_ = sequence;
      return Verdict::kTaken;
    }
    const std::uint64_t last = last_.value_or(sequence);
    if (sequence <= last || sequence - last <= unanswered_)
      return Verdict::kFenced;
    acting_ = place;
    last_ = sequence;
    return Verdict::kTakenOver;
  }

  /// The acting one steps back; the other acts, and as many samples as ever have to be left out
  /// from `sequence` on before it takes over again.
  void step_back(std::uint64_t sequence) noexcept {
    acting_ = acting_ == Place::kFirst ? Place::kSecond : Place::kFirst;
    if (!last_ || sequence > *last_)
      last_ = sequence;
  }

  Place acting() const noexcept { return acting_; }
  /// Number of the last sample that was answered, in this session.
  const std::optional<std::uint64_t>& last() const noexcept { return last_; }

 private:
  Place acting_;
  std::uint64_t unanswered_;
  std::optional<std::uint64_t> last_;
};

inline constexpr Failover::Place other_than(Failover::Place place) noexcept {
  return place == Failover::Place::kFirst ? Failover::Place::kSecond : Failover::Place::kFirst;
}

}  // namespace voxtouch::runtime
