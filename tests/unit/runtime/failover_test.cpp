// Which of two that play one role is followed: every order of arrival, and two that fail, wake up
// and lose messages at random.
#include "nodes/runtime/failover.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <deque>
#include <numeric>
#include <optional>
#include <random>
#include <vector>

#include "nodes/runtime/acting_pair.hpp"
#include "tests/support/seed.hpp"

namespace voxtouch::runtime {
namespace {

using Place = Failover::Place;
using Verdict = Failover::Verdict;

TEST(FailoverRule, TakesTheActingOneAloneWhileItAnswers) {
  Failover rule;
  for (std::uint64_t n = 0; n < 100; ++n) {
    EXPECT_EQ(rule.hear(Place::kSecond, n), Verdict::kFenced)
        << "nobody takes over before the first answer, or beside it";
    EXPECT_EQ(rule.hear(Place::kFirst, n), Verdict::kTaken);
    EXPECT_EQ(rule.hear(Place::kSecond, n), Verdict::kFenced);
    EXPECT_EQ(rule.hear(Place::kFirst, n), Verdict::kOld);
  }
  EXPECT_EQ(rule.acting(), Place::kFirst);
}

TEST(FailoverRule, LetsTheOtherOneTakeOverWithTheFourthSampleAndFencesTheFirst) {
  Failover rule;
  rule.hear(Place::kFirst, 10);
  for (std::uint64_t n = 11; n <= 13; ++n)
    EXPECT_EQ(rule.hear(Place::kSecond, n), Verdict::kFenced);
  EXPECT_EQ(rule.hear(Place::kSecond, 14), Verdict::kTakenOver);
  EXPECT_EQ(rule.acting(), Place::kSecond);
  for (std::uint64_t n = 11; n <= 17; ++n)
    EXPECT_EQ(rule.hear(Place::kFirst, n), Verdict::kFenced) << n;
  EXPECT_EQ(rule.hear(Place::kSecond, 15), Verdict::kTaken);
}

TEST(FailoverRule, BeginsAnewInAnotherSessionWithWhoActs) {
  Failover rule;
  rule.hear(Place::kFirst, 1000);
  rule.hear(Place::kSecond, 2000);
  rule.begin();
  EXPECT_EQ(rule.hear(Place::kFirst, 500), Verdict::kFenced);
  EXPECT_EQ(rule.hear(Place::kSecond, 0), Verdict::kTaken);
}

TEST(FailoverRule, TakesNumbersAtTheEndOfTheirRange) {
  Failover rule;
  const std::uint64_t most = ~std::uint64_t{0};
  rule.hear(Place::kFirst, most - 1);
  EXPECT_EQ(rule.hear(Place::kSecond, most), Verdict::kFenced);
  EXPECT_EQ(rule.hear(Place::kFirst, most), Verdict::kTaken);
  EXPECT_EQ(rule.hear(Place::kFirst, 0), Verdict::kOld);
  EXPECT_EQ(rule.hear(Place::kSecond, 0), Verdict::kFenced);
}

struct Answer {
  Place place;
  std::uint64_t sequence;
};

/// What holds of any reader, whatever comes.
void expect_sound(const std::vector<Answer>& arrivals) {
  Failover rule;
  std::optional<std::uint64_t> last;
  std::optional<Place> last_place;
  for (const Answer& a : arrivals) {
    const Verdict verdict = rule.hear(a.place, a.sequence);
    if (verdict == Verdict::kFenced || verdict == Verdict::kOld)
      continue;
    if (last) {
      ASSERT_GT(a.sequence, *last) << "answered twice, or backwards";
    }
    if (last && last_place != a.place) {
      ASSERT_GT(a.sequence - *last, Failover::kUnanswered) << "taken over from one that answers";
    }
    ASSERT_EQ(verdict == Verdict::kTakenOver, last_place.value_or(Place::kFirst) != a.place);
    last = a.sequence, last_place = a.place;
  }
}

/// The first answers 1, 2 and 4, wakes up with 5 and 12; the second takes over with 8. All 362,880
/// orders of the nine arrivals.
TEST(FailoverRule, AnswersNoSampleTwiceInAnyOrderOfArrival) {
  const std::vector<Answer> all{{Place::kFirst, 1},  {Place::kFirst, 2},   {Place::kFirst, 4},
                                {Place::kFirst, 5},  {Place::kFirst, 12},  {Place::kSecond, 8},
                                {Place::kSecond, 9}, {Place::kSecond, 12}, {Place::kSecond, 13}};
  std::vector<std::size_t> order(all.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<Answer> arrivals(all.size(), all.front());
  do {
    for (std::size_t i = 0; i < order.size(); ++i)
      arrivals[i] = all[order[i]];
    expect_sound(arrivals);
    if (HasFatalFailure())
      return;
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(FailoverRule, AnswersNoSampleTwiceOfNumbersAtRandom) {
  const std::uint64_t seed = testing::seed(20261124);
  SCOPED_TRACE(testing::seed_trace(seed));
  std::mt19937_64 random(seed);
  for (int run = 0; run < 20'000; ++run) {
    std::vector<Answer> arrivals;
    std::uint64_t now = random() % 10;
    for (int n = 0; n < 60; ++n) {
      now += random() % 3;
      const std::uint64_t far =
          random() % 50 == 0 ? random() : now - std::min<std::uint64_t>(now, random() % 8);
      arrivals.push_back({random() % 2 ? Place::kFirst : Place::kSecond, far});
    }
    expect_sound(arrivals);
    if (HasFatalFailure())
      return;
  }
}

/// Two nodes, two readers, and what is between them: messages are late, lost, or overtaken by newer
/// ones, nodes stand still and wake up.
class Ring {
 public:
  explicit Ring(std::uint64_t seed) : random_(seed) {}

  /// One sample of the device. `lossy`: messages may be lost and late.
  void step(bool lossy) {
    ++sample_;
    for (int n = 0; n < 2; ++n)
      if (lossy && random_() % 40 == 0)
        still_[n] = still_[n] ? 0 : 1 + random_() % 30;
    for (int n : {random_() % 2 ? 0 : 1, 2}) {
      const int who = n == 2 ? last_who_ ^ 1 : (last_who_ = n);
      if (still_[who] > 0) {
        if (lossy || still_[who] < 1'000'000)
          --still_[who];
        continue;
      }
      if (withheld_ || (lossy && random_() % 20 == 0))
        continue;  // the sample was lost
      hear(who);
      if (!node_[who].answers(sample_, {.entitled = true, .yields = who == 1}))
        continue;
      ++sent_[who];
      for (auto* way : {&to_node_[who ^ 1], &to_reader_[0], &to_reader_[1]})
        if (!lossy || random_() % 20 != 0)
          way->push_back({who == 0 ? Place::kFirst : Place::kSecond, sample_});
    }
    for (int r = 0; r < 2; ++r) {
      if (lossy && random_() % 4 == 0)
        continue;  // later
      if (lossy && random_() % 4 == 0)
        std::ranges::shuffle(to_reader_[r], random_);
      for (; !to_reader_[r].empty(); to_reader_[r].pop_front())
        take(r, to_reader_[r].front());
    }
  }

  /// Samples come to neither, or again to both.
  void withhold(bool withheld) { withheld_ = withheld; }
  void stop(int who) { still_[who] = 1'000'000; }
  void wake(int who) { still_[who] = 0; }
  void wake_all() { still_ = {}; }
  std::uint64_t sample() const { return sample_; }
  const std::vector<std::uint64_t>& taken(int reader) const { return taken_[reader]; }
  Place followed(int reader) const { return reader_[reader].acting(); }
  bool acts(int who) const { return node_[who].acts(); }
  std::uint64_t sent(int who) const { return sent_[who]; }

 private:
  void hear(int who) {
    for (; !to_node_[who].empty(); to_node_[who].pop_front())
      node_[who].hear(to_node_[who].front().sequence, sample_,
                      {.entitled = true, .yields = who == 1});
  }
  void take(int r, const Answer& a) {
    const Verdict verdict = reader_[r].hear(a.place, a.sequence);
    if (verdict == Verdict::kTaken || verdict == Verdict::kTakenOver)
      taken_[r].push_back(a.sequence);
  }

  std::mt19937_64 random_;
  std::uint64_t sample_ = 0;
  int last_who_ = 0;
  bool withheld_ = false;
  std::array<std::uint64_t, 2> still_{}, sent_{};
  std::array<ActingPair, 2> node_{ActingPair(true), ActingPair(false)};
  std::array<Failover, 2> reader_;
  std::array<std::deque<Answer>, 2> to_node_, to_reader_;
  std::array<std::vector<std::uint64_t>, 2> taken_;
};

void expect_rising(const std::vector<std::uint64_t>& taken) {
  for (std::size_t i = 1; i < taken.size(); ++i)
    ASSERT_LT(taken[i - 1], taken[i]);
}

std::uint64_t longest_gap(const std::vector<std::uint64_t>& taken, std::uint64_t from) {
  std::uint64_t longest = 0;
  for (std::size_t i = 1; i < taken.size(); ++i)
    if (taken[i] > from)
      longest = std::max(longest, taken[i] - taken[i - 1]);
  return longest;
}

TEST(Pairs, TakeOverWithinFivePeriodsAndWhoReturnsStandsBy) {
  Ring ring(1);
  for (int n = 0; n < 50; ++n)
    ring.step(false);
  ring.stop(0);
  for (int n = 0; n < 50; ++n)
    ring.step(false);
  EXPECT_TRUE(ring.acts(1));
  EXPECT_LE(longest_gap(ring.taken(0), 0), 5U);
  ring.wake(0);
  const std::uint64_t sent = ring.sent(0);
  for (int n = 0; n < 50; ++n)
    ring.step(false);
  EXPECT_FALSE(ring.acts(0));
  EXPECT_EQ(ring.sent(0), sent)
      << "who returns hears that the other one answers, and sends nothing";
  ring.stop(1);
  for (int n = 0; n < 50; ++n)
    ring.step(false);
  EXPECT_TRUE(ring.acts(0)) << "and back";
  for (int r = 0; r < 2; ++r) {
    EXPECT_EQ(ring.followed(r), Place::kFirst);
    EXPECT_LE(longest_gap(ring.taken(r), 0), 5U);
    expect_rising(ring.taken(r));
  }
}

TEST(Pairs, DoNotChangeWhereSamplesComeToNeither) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {  // whichever of the two gets the next one first
    Ring ring(seed);
    for (int n = 0; n < 50; ++n)
      ring.step(false);
    ring.withhold(true);
    for (int n = 0; n < 10; ++n)
      ring.step(false);
    ring.withhold(false);
    for (int n = 0; n < 50; ++n)
      ring.step(false);
    ASSERT_TRUE(ring.acts(0));
    ASSERT_EQ(ring.sent(1), 0U);
  }
}

TEST(Pairs, HearTheOtherOneAlsoWhereTheyAreAlwaysLaterThanIt) {
  ActingPair slow(false);
  const ActingPair::Known pair{.entitled = true, .yields = true};
  for (std::uint64_t n = 1; n < 200; n += 2) {  // of two samples it gets the later one, and when
                                                // that is computed the next has been answered
    slow.hear(n + 1, n, pair);
    ASSERT_FALSE(slow.answers(n, pair)) << n;
  }
}

TEST(Pairs, FallSilentWhereTheyWorkOffWhatCameWhileTheyStoodStill) {
  ActingPair first(true), second(false);
  const ActingPair::Known stays{.entitled = true, .yields = false},
      yields{.entitled = true, .yields = true};
  for (std::uint64_t n = 0; n <= 10; ++n) {
    ASSERT_TRUE(first.answers(n, stays));
    second.hear(n, n, yields);
    ASSERT_FALSE(second.answers(n, yields));
  }
  std::uint64_t n = 11;
  while (!second.answers(n, yields))
    ++n;
  EXPECT_EQ(n, 14U);
  for (++n; n < 100; ++n)
    EXPECT_TRUE(second.answers(n, yields));
  // The first wakes up, and is given each sample since with the answer of the other one behind it.
  int stale = 0;
  for (std::uint64_t k = 11; k < 100; ++k) {
    if (first.answers(k, stays))
      ++stale, second.hear(k, 99, yields);
    if (k >= 14)
      first.hear(k, k, stays);
  }
  EXPECT_LE(stale, 6);
  EXPECT_FALSE(first.acts());
  EXPECT_TRUE(second.acts()) << "what is over does not make it step back";
}

TEST(Pairs, AnswerNoSampleTwiceAndEndWithOneThatActsWhateverIsLost) {
  const std::uint64_t seed = testing::seed(16);
  SCOPED_TRACE(testing::seed_trace(seed));
  std::mt19937_64 random(seed);
  for (int run = 0; run < 3'000; ++run) {
    SCOPED_TRACE(run);
    Ring ring(random());
    for (int n = 0; n < 20; ++n)
      ring.step(false);
    for (int n = 0; n < 200; ++n)
      ring.step(true);
    ring.wake_all();
    for (int n = 0; n < 40; ++n)
      ring.step(false);
    ASSERT_NE(ring.acts(0), ring.acts(1)) << "one acts";
    const Place acting = ring.acts(0) ? Place::kFirst : Place::kSecond;
    const std::uint64_t settled = ring.sample();
    for (int n = 0; n < 20; ++n)
      ring.step(false);
    for (int r = 0; r < 2; ++r) {
      expect_rising(ring.taken(r));
      ASSERT_FALSE(HasFatalFailure());
      ASSERT_EQ(ring.followed(r), acting);
      ASSERT_LE(longest_gap(ring.taken(r), settled), 1U) << "and each sample is answered";
    }
    // Whoever of the two is lost now, the other one goes on.
    ring.stop(ring.acts(0) ? 0 : 1);
    const std::uint64_t lost = ring.sample();
    for (int n = 0; n < 20; ++n)
      ring.step(false);
    for (int r = 0; r < 2; ++r)
      ASSERT_LE(longest_gap(ring.taken(r), lost), 5U);
  }
}

}  // namespace
}  // namespace voxtouch::runtime
