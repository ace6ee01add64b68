#include "nodes/runtime/duty.hpp"

#include <fmt/format.h>

namespace voxtouch::runtime {
namespace {

constexpr int kUnlikeLooks =
    100;  ///< about 2 s: what is changed in one of the two is changed in the other soon

}  // namespace

void DutyBase::begin(std::uint64_t session) noexcept {
  session_ = session;
  pair_.begin();
  answers_.store(0, std::memory_order_relaxed);
}

bool DutyBase::decide(std::uint64_t sequence, bool fit) noexcept {
  if (stand_back_.exchange(false, std::memory_order_relaxed) && pair_.acts() && !pair_.has_begun())
    pair_.step_back(sequence);
  ActingPair::Known known = known_of_pair();
  known.entitled = known.entitled && fit;
  const bool acted = pair_.acts(), answers = pair_.answers(sequence, known);
  if (answers && !acted)
    taken_over_at_.store(sequence, std::memory_order_relaxed);
  takeovers_.store(pair_.takeovers(), std::memory_order_relaxed);
  stepped_back_.store(pair_.stepped_back(), std::memory_order_relaxed);
  acts_now_.store(pair_.acts(), std::memory_order_release);
  if (answers)
    count_answer();
  return answers;
}

void DutyBase::follow(const bus::Guid& other) {
  bus::Following& following = others();
  if (other_ != other || !following.has_writer())
    following.follow(other);
  other_ = other;
}

/// The place belongs to the session: to who has it when that begins, and then to whoever takes it
/// up from him.
bool DutyBase::may_take_another() const noexcept {
  const bool was_taken = options_.is_standby || place_session_ != 0;
  return options_.takes == TakesStandby::kAny || was_taken ||
         (options_.takes == TakesStandby::kFromStart &&
          answers_.load(std::memory_order_relaxed) < kFirstAnswers);
}

std::string DutyBase::look(const NodeRegistry& registry, NodeReport& report) {
  const bool plain = !options_.is_standby && options_.takes == TakesStandby::kNever;
  if (plain)
    return {};
  std::string said;
  if (!report.final())
    said = acts_now() ? look_as_acting(registry, report) : look_as_standby(registry, report);
  if (!reads_others())
    return said;
  report.values[kDuty] =
      acts_now() && !stand_back_.load(std::memory_order_relaxed) ? kActs : kStandsBy;
  report.figures["took_over"] = {takeovers_.load(), "times"};
  if (takeovers_.load() > 0)
    report.figures["took_over_at"] = {taken_over_at_.load(), "sample number"};
  report.figures["stepped_back"] = {stepped_back_.load(), "times"};
  return said;
}

/// The one that was started as a standby; of two alike the one with the larger GUID. Both know the
/// same.
bool DutyBase::yields_to(const NodeReport& other) const {
  const bool other_is_standby = other.node != role_;
  return options_.is_standby != other_is_standby ? options_.is_standby
                                                 : other.participant < participant_.guid();
}

std::string DutyBase::look_as_acting(const NodeRegistry& registry, NodeReport& report) {
  if (other_ && !registry.is_here(*other_))
    other_.reset();
  const std::vector<NodeReport> reports = registry.reports();
  const auto acting = who_acts(reports, role_, participant_.guid());
  const NodeReport* in_pair = acting ? registry.report_of(*acting) : nullptr;
  const bool is_fresh = !options_.is_standby && answers_.load() == 0 && place_session_ == 0;
  if (is_fresh && in_pair && says_that_it_acts_in_a_pair(*in_pair, role_)) {
    // Started again while its standby acts: this node stands by from here on, before its first
    // answer.
    follow(*acting);
    stand_back_.store(true, std::memory_order_release);
    return {};
  }
  const std::vector<bus::Guid> candidates =
      who_could_stand_by(reports, role_, report, participant_.guid(), same_);
  const bool is_candidate = other_ && std::ranges::find(candidates, *other_) != candidates.end();
  std::string said;
  if (!other_ && may_take_another() && candidates.size() == 1) {
    follow(candidates.front());
  } else if (!other_ && may_take_another() && candidates.size() > 1) {
    said = fmt::format("two nodes want to stand by for {}, and none is taken: {} and {}; stop one",
                       role_, registry.name_of(candidates[0]), registry.name_of(candidates[1]));
  } else if (other_) {
    follow(*other_);
    // Who has just been replaced still says that it acts, and what is changed is not changed in
    // both at once.
    unlike_looks_ = is_candidate ? 0 : unlike_looks_ + 1;
  }
  const bool stands_by = other_ && unlike_looks_ < kUnlikeLooks;
  if (stands_by)
    place_session_ = report.session_id;
  if (const NodeReport* other = other_ ? registry.report_of(*other_) : nullptr)
    yields_.store(yields_to(*other), std::memory_order_release);
  if (reads_others())
    report.values[kStandby] = stands_by ? to_hex(*other_) : kNoStandby;
  if (other_ && !stands_by)
    said = fmt::format("{} does not stand by any more: it is not as this node is",
                       registry.name_of(*other_));
  return said;
}

std::string DutyBase::look_as_standby(const NodeRegistry& registry, NodeReport& report) {
  unlike_looks_ = 0;
  if (other_ && !registry.is_here(*other_))
    other_.reset();
  if (const auto acting = who_acts(registry.reports(), role_, participant_.guid()))
    follow(*acting);
  const NodeReport* acting = other_ ? registry.report_of(*other_) : nullptr;
  // What an acting one has said last holds when it has gone: it is then that it is needed.
  if (acting && says_that_it_acts(*acting, role_)) {
    const NamedStandby named = named_standby(*acting);
    const bool is_named = named.participant == participant_.guid();
    if (is_named)
      place_session_ = acting->session_id;
    entitled_.store(is_named, std::memory_order_release);
    yields_.store(yields_to(*acting), std::memory_order_release);
    if (is_named)
      return fmt::format("stands by for {}", registry.name_of(*other_));
    const std::string unlike = same_.difference(report, *acting);
    return fmt::format("{} has not taken this node as its standby{}", registry.name_of(*other_),
                       unlike.empty() ? "" : fmt::format(": '{}' differs", unlike));
  }
  return acting ? std::string() : fmt::format("stands by, and no {} acts", role_);
}

}  // namespace voxtouch::runtime
