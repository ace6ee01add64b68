#include "nodes/runtime/role_binding.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "nodes/runtime/standby.hpp"

namespace voxtouch::runtime {
namespace {

constexpr std::size_t kMaxOthers = 16;

}  // namespace

void RoleBinding::update(const NodeRegistry& registry, std::optional<std::uint64_t> session) {
  follow_failover();
  if (at(acting_) && !registry.is_here(*at(acting_)) && !stands_in(registry))
    let_go();
  rivals_.clear();
  if (!at(acting_)) {
    std::vector<bus::Guid> claiming = claimants(registry, session);
    if (claiming.size() == 1)
      bind(claiming.front());
    if (claiming.size() > 1)
      rivals_ = std::move(claiming);
  }
  if (!at(acting_))
    return others_.clear();
  if (registry.is_here(*at(acting_)))
    follow_again();
  if (const NodeReport* report = registry.report_of(*at(acting_));
      report && report->session_id != 0)
    session_.store(report->session_id, std::memory_order_release);
  if (pair_)
    look_for_standby(registry);
  note_others(registry);
}

/// The loop has seen the other one take over: it is the one that is bound. What is latched is
/// followed once it has said its own.
void RoleBinding::follow_failover() {
  if (!pair_ || pair_->acting() == acting_)
    return;
  acting_ = pair_->acting();
  for (bus::Following* input : inputs_)
    input->follow_kept();
}

bool RoleBinding::stands_in(const NodeRegistry& registry) const {
  const auto& other = at(other_than(acting_));
  const NodeReport* report = other ? registry.report_of(*other) : nullptr;
  return report && registry.is_here(*other) && takes_part(*report);
}

void RoleBinding::follow_again() {
  for (bus::Following* input : inputs_)
    if (!input->has_writer() && input->awaited() == 0)
      input->follow(*at(acting_));
  if (!pair_)
    return;
  if (bus::Following& own = pair_->place(acting_); !own.has_writer())
    own.follow(*at(acting_));
}

void RoleBinding::look_for_standby(const NodeRegistry& registry) {
  const auto& other = at(other_than(acting_));
  if (other && !registry.is_here(*other))
    clear_other_place();
  const NodeReport* report = registry.report_of(*at(acting_));
  const NamedStandby named = report ? named_standby(*report) : NamedStandby{};
  if (!named.says)
    return;
  if (!named.participant)
    return clear_other_place();
  const NodeReport* standby = registry.report_of(*named.participant);
  if (*named.participant == *at(acting_) || !standby || !registry.is_here(*named.participant) ||
      !plays(*standby, role_))
    return;
  bus::Following* place = pair_->place_if_made(other_than(acting_));
  if (other != named.participant || !place || !place->has_writer())
    return fill_other_place(*named.participant);
  // Under DDS Security a writer is matched by one reader after the other.
  place->pass_over(*at(acting_));
  pair_->place(acting_).pass_over(*named.participant);
}

/// Each of the two readers passes over what the other one takes in, from its first sample on: not
/// before both have matched both.
void RoleBinding::fill_other_place(const bus::Guid& participant) {
  bus::Following &own = pair_->place(acting_), &other = pair_->place(other_than(acting_));
  if (!own.has_matched(participant) || !other.has_matched(*at(acting_)))
    return;
  // Before it follows: the acting one writes all the while, and a reader that follows somebody
  // counts all others as strangers.
  other.pass_over(*at(acting_));
  own.pass_over(participant);
  if (!other.follow(participant))
    return;
  for (bus::Following* input : inputs_)
    input->keep_also(participant);
  at(other_than(acting_)) = participant;
}

void RoleBinding::clear_other_place() {
  if (!at(other_than(acting_)))
    return;
  if (bus::Following* other = pair_->place_if_made(other_than(acting_)))
    other->follow_nobody();
  pair_->place(acting_).pass_over({});
  for (bus::Following* input : inputs_)
    if (input->awaited() == 0)
      input->keep_nobody_also();
  at(other_than(acting_)).reset();
}

std::vector<bus::Following*> RoleBinding::all_inputs() const {
  std::vector<bus::Following*> all = inputs_;
  for (const Place place : {Place::kFirst, Place::kSecond})
    if (bus::Following* input = pair_ ? pair_->place_if_made(place) : nullptr)
      all.push_back(input);
  return all;
}

std::vector<bus::Guid> RoleBinding::claimants(const NodeRegistry& registry,
                                              std::optional<std::uint64_t> session) const {
  std::vector<bus::Guid> found;
  const std::vector<bus::Following*> inputs = all_inputs();
  for (const NodeReport& report : registry.reports())
    if (says_that_it_acts(report, role_) && takes_part(report) &&
        (!session || report.session_id == *session) &&
        std::all_of(inputs.begin(), inputs.end(), [&](const bus::Following* input) {
          return input->has_matched(report.participant);
        }))
      found.push_back(report.participant);
  return found;
}

void RoleBinding::bind(const bus::Guid& participant) {
  tenure_.fetch_add(1, std::memory_order_acq_rel);
  for (bus::Following* input : inputs_)
    input->follow(participant);
  if (pair_)
    pair_->place(acting_).follow(participant);
  at(acting_) = participant;
  bound_now_.store(true, std::memory_order_release);
}

void RoleBinding::let_go() {
  for (bus::Following* input : all_inputs())
    input->follow_nobody(), input->keep_nobody_also();
  places_ = {};
  session_.store(0, std::memory_order_release);
  bound_now_.store(false, std::memory_order_release);
}

void RoleBinding::note_others(const NodeRegistry& registry) {
  const std::vector<bus::Following*> inputs = all_inputs();
  for (bus::Following* input : inputs)
    for (const bus::Guid& other : input->take_refused())
      if (others_.size() < kMaxOthers)
        others_.insert(other);
  for (const NodeReport& report : registry.reports())
    if (says_that_it_acts(report, role_) && takes_part(report) && others_.size() < kMaxOthers)
      others_.insert(report.participant);
  for (const auto& own : places_)
    if (own)
      others_.erase(*own);
  std::erase_if(others_, [&](const bus::Guid& other) {
    return !registry.is_here(other) &&
           std::none_of(inputs.begin(), inputs.end(),
                        [&](const bus::Following* input) { return input->has_matched(other); });
  });
}

/// Both readers of a pair refuse a stranger's samples: they count once.
std::uint64_t RoleBinding::refused() const noexcept {
  std::uint64_t sum = 0, of_pair = 0;
  for (const bus::Following* input : inputs_)
    sum += input->refused();
  for (const Place place : {Place::kFirst, Place::kSecond})
    if (const bus::Following* input = pair_ ? pair_->place_if_made(place) : nullptr)
      of_pair = std::max(of_pair, input->refused());
  return sum + of_pair;
}

std::string RoleBinding::trouble(const NodeRegistry& registry) const {
  const auto names = [&](const auto& participants) {
    std::string all;
    for (const bus::Guid& participant : participants)
      all += (all.empty() ? "" : " and ") + registry.name_of(participant);
    return all;
  };
  if (!rivals_.empty())
    return fmt::format("two {} nodes claim this session, and none is followed: {}; stop one", role_,
                       names(rivals_));
  if (others_.empty() || !at(acting_))
    return {};
  return fmt::format("what {} sends is refused: the {} of this session is {}", names(others_),
                     role_, registry.name_of(*at(acting_)));
}

void RoleBinding::report_to(NodeReport& report, const NodeRegistry& registry) const {
  if (!pair_ || !pair_->place_if_made(Place::kSecond))
    return;
  report.figures[role_ + "_fenced_answers"] = {pair_->fenced(), "samples"};
  report.figures[role_ + "_takeovers"] = {pair_->takeovers(), "times"};
  if (pair_->takeovers() > 0)
    report.figures[role_ + "_taken_over_at"] = {pair_->last_takeover(), "sample number"};
  if (pair_->fenced() > 0 && standby())
    report.values["fenced"] = registry.name_of(*standby());
}

}  // namespace voxtouch::runtime
