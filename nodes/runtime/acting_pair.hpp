#pragma once
/// Whether one of two that play one role answers the next sample, by what it has heard of the other
/// one. No clock, thread or DDS.
#include <cstdint>
#include <optional>
#include <utility>

#include "nodes/runtime/failover.hpp"

namespace voxtouch::runtime {

/// The loop's, of one node. It goes by the rule that its readers go by, and by what it was given to
/// answer itself: where samples have not come to either of the two, nobody has left them out.
/// Real-time safe.
class ActingPair {
 public:
  /// What the node knows of the pair beside the answers.
  struct Known {
    bool entitled = false;  ///< to take over: it has acted, or the acting one has named it
    bool yields = false;    ///< at once, where both answer; of two exactly one does
  };
  /// Whoever does not yield at once does so where the other one goes on: then that one is followed,
  /// and this node was away.
  static constexpr int kMaxBeside = 3;

  explicit ActingPair(bool acts, std::uint64_t unanswered = Failover::kUnanswered) noexcept
      : failover_(acts ? kOwn : kOther, unanswered) {}

  /// Another session.
  void begin() noexcept {
    failover_.begin();
    ahead_.reset(), last_given_.reset(), beside_.reset();
  }
  /// The other one has answered `sequence`; `newest`: the last sample that this node has been
  /// given. What is ahead of it waits.
  void hear(std::uint64_t sequence, std::uint64_t newest, const Known& known) noexcept {
    heed_what_was_ahead(newest, known);
    if (sequence > newest)
      ahead_ = sequence;
    else
      heed(sequence, known);
  }
  /// Whether this node's answer to `sequence` is to be sent.
  bool answers(std::uint64_t sequence, const Known& known) noexcept {
    heed_what_was_ahead(sequence, known);
    const std::optional<std::uint64_t> given_before = std::exchange(last_given_, sequence);
    if (acts()) {
      failover_.hear(kOwn, sequence);
      return true;
    }
    // The other one has had at least one sample, and a period for it; and it has answered none that
    // is later.
    const bool waited =
        given_before && failover_.last() && *given_before > *failover_.last() && !ahead_;
    if (!known.entitled || !waited ||
        failover_.hear(kOwn, sequence) != Failover::Verdict::kTakenOver)
      return false;
    ++takeovers_;
    return true;
  }
  /// The other one acts, and this node stands by from `sequence` on.
  void step_back(std::uint64_t sequence) noexcept {
    failover_.step_back(sequence);
    beside_.reset();
    ++stepped_back_;
  }

  bool acts() const noexcept { return failover_.acting() == kOwn; }
  /// Whether a sample of this session has been answered, by whichever.
  bool has_begun() const noexcept { return failover_.last().has_value(); }
  std::uint64_t takeovers() const noexcept { return takeovers_; }
  std::uint64_t stepped_back() const noexcept { return stepped_back_; }

 private:
  /// It is of use once this node has been given its sample too.
  void heed_what_was_ahead(std::uint64_t newest, const Known& known) noexcept {
    if (ahead_ && *ahead_ <= newest)
      heed(*std::exchange(ahead_, std::nullopt), known);
  }
  void heed(std::uint64_t sequence, const Known& known) noexcept {
    if (failover_.hear(kOther, sequence) != Failover::Verdict::kFenced || !failover_.last() ||
        sequence + 1 < *failover_.last())
      return;
    // Both answer: after a false alarm, or where this node woke up and works off what has come
    // meanwhile.
    constexpr std::uint64_t kInARow = 8;
    times_beside_ = beside_ && sequence <= *beside_ + kInARow ? times_beside_ + 1 : 1;
    beside_ = sequence;
    if (known.yields || times_beside_ >= kMaxBeside)
      step_back(sequence);
  }

  static constexpr Failover::Place kOwn = Failover::Place::kFirst,
                                   kOther = Failover::Place::kSecond;
  Failover failover_;
  std::optional<std::uint64_t>
      ahead_;  ///< an answer of the other one's to a sample that this node has not been given yet
  std::optional<std::uint64_t> last_given_;  ///< to answer
  std::optional<std::uint64_t> beside_;      ///< the last sample that both answered
  int times_beside_ = 0;
  std::uint64_t takeovers_ = 0, stepped_back_ = 0;
};

}  // namespace voxtouch::runtime
