#include "nodes/runtime/role_binding.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace voxtouch::runtime {
namespace {

constexpr std::size_t kMaxOthers = 16;

}  // namespace

void RoleBinding::update(const NodeRegistry& registry, std::optional<std::uint64_t> session) {
  if (participant_ && !registry.is_here(*participant_)) {
    if (!registry.is_claimed())
      lost_session_ = session.value_or(session_.load(std::memory_order_relaxed));
    release();
  }
  conflicting_.clear();
  if (!participant_) {
    std::vector<bus::Guid> claiming = claimants(registry, session);
    if (claiming.size() == 1)
      bind(claiming.front());
    if (claiming.size() > 1)
      conflicting_ = std::move(claiming);
  }
  note_refused(registry);
  if (!participant_)
    return others_.clear();
  follow_again();
  if (const NodeReport* report = registry.report_of(*participant_);
      report && report->session_id != 0)
    session_.store(report->session_id, std::memory_order_release);
  note_others(registry);
}

/// A participant that DDS has discovered again has new writers.
void RoleBinding::follow_again() {
  for (bus::Following* input : inputs_)
    if (!input->has_writer())
      input->follow(*participant_);
}

bool RoleBinding::is_claimed_by(const NodeReport& report) const {
  const bool takes_part = report.state == NodeState::kStarting ||
                          report.state == NodeState::kReady || report.state == NodeState::kRunning;
  return report.node == role_ && report.session_id != 0 && takes_part;
}

std::vector<bus::Guid> RoleBinding::claimants(const NodeRegistry& registry,
                                              std::optional<std::uint64_t> session) const {
  std::vector<bus::Guid> found;
  for (const NodeReport& report : registry.reports())
    if (is_claimed_by(report) && (!session || report.session_id == *session) &&
        report.session_id != lost_session_ && registry.may_play(role_, report.participant) &&
        std::all_of(inputs_.begin(), inputs_.end(), [&](const bus::Following* input) {
          return input->has_matched(report.participant);
        }))
      found.push_back(report.participant);
  return found;
}

void RoleBinding::bind(const bus::Guid& participant) {
  binding_epoch_.fetch_add(1, std::memory_order_acq_rel);
  for (bus::Following* input : inputs_)
    input->follow(participant);
  participant_ = participant;
  lost_session_ = 0;
  bound_now_.store(true, std::memory_order_release);
}

void RoleBinding::release() {
  for (bus::Following* input : inputs_)
    input->follow_none();
  participant_.reset();
  session_.store(0, std::memory_order_release);
  bound_now_.store(false, std::memory_order_release);
}

void RoleBinding::note_refused(const NodeRegistry& registry) {
  for (bus::Following* input : inputs_)
    for (const bus::RefusedSamples& refused : input->take_refused()) {
      refused_from_.of(refused.participant) += refused.count;
      if (others_.size() < kMaxOthers && refused.participant != bus::Guid{})
        others_.insert(refused.participant);
    }
  refused_from_.name(registry);  // a new participant may give its name later
}

void RoleBinding::note_others(const NodeRegistry& registry) {
  for (const NodeReport& report : registry.reports())
    if (is_claimed_by(report) && others_.size() < kMaxOthers)
      others_.insert(report.participant);
  others_.erase(*participant_);
  std::erase_if(others_, [&](const bus::Guid& other) {
    return !registry.is_here(other) &&
           std::none_of(inputs_.begin(), inputs_.end(),
                        [&](const bus::Following* input) { return input->has_matched(other); });
  });
}

std::uint64_t RoleBinding::refused() const noexcept {
  std::uint64_t sum = 0;
  for (const bus::Following* input : inputs_)
    sum += input->refused();
  return sum;
}

std::string RoleBinding::diagnostic(const NodeRegistry& registry) const {
  const auto names = [&](const auto& participants) {
    std::string all;
    for (const bus::Guid& participant : participants)
      all += (all.empty() ? "" : " and ") + registry.name_of(participant);
    return all;
  };
  if (!conflicting_.empty())
    return fmt::format("two {} nodes claim this session, none is bound: {}. Stop one", role_,
                       names(conflicting_));
  if (lost_session_ != 0 && role_ != "device")  // without a device there is no session
    return fmt::format("the {} of this session has left: the session is over", role_);
  if (others_.empty() || !participant_)
    return {};
  return fmt::format("messages of {} are refused: the {} of this session is {}", names(others_),
                     role_, registry.name_of(*participant_));
}

}  // namespace voxtouch::runtime
