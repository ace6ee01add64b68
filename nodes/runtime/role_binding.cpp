#include "nodes/runtime/role_binding.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace voxtouch::runtime {
namespace {

constexpr std::size_t kMaxOthers = 16;

bool takes_part(const NodeReport& report) {
  return report.session_id != 0 && (report.state == NodeState::kStarting || report.state == NodeState::kReady ||
                                    report.state == NodeState::kRunning);
}

}  // namespace

void RoleBinding::update(const NodeRegistry& registry, std::optional<std::uint64_t> session) {
  if (bound_ && !registry.is_here(*bound_)) let_go();
  rivals_.clear();
  if (!bound_) {
    std::vector<bus::Guid> claiming = claimants(registry, session);
    if (claiming.size() == 1) bind(claiming.front());
    if (claiming.size() > 1) rivals_ = std::move(claiming);
  }
  if (!bound_) return others_.clear();
  for (bus::Following* input : inputs_)
    if (!input->has_writer()) input->follow(*bound_);
  if (const NodeReport* report = registry.report_of(*bound_); report && report->session_id != 0)
    session_.store(report->session_id, std::memory_order_release);
  note_others(registry);
}

std::vector<bus::Guid> RoleBinding::claimants(const NodeRegistry& registry, std::optional<std::uint64_t> session) const {
  std::vector<bus::Guid> found;
  for (const NodeReport& report : registry.reports())
    if (report.node == role_ && takes_part(report) && (!session || report.session_id == *session) &&
        std::all_of(inputs_.begin(), inputs_.end(),
                    [&](const bus::Following* input) { return input->has_matched(report.participant); }))
      found.push_back(report.participant);
  return found;
}

void RoleBinding::bind(const bus::Guid& participant) {
  for (bus::Following* input : inputs_) input->follow(participant);
  bound_ = participant;
  bound_now_.store(true, std::memory_order_release);
}

void RoleBinding::let_go() {
  for (bus::Following* input : inputs_) input->follow_nobody();
  bound_.reset();
  session_.store(0, std::memory_order_release);
  bound_now_.store(false, std::memory_order_release);
}

void RoleBinding::note_others(const NodeRegistry& registry) {
  for (bus::Following* input : inputs_)
    for (const bus::Guid& other : input->take_refused())
      if (others_.size() < kMaxOthers) others_.insert(other);
  for (const NodeReport& report : registry.reports())
    if (report.node == role_ && takes_part(report) && others_.size() < kMaxOthers) others_.insert(report.participant);
  others_.erase(*bound_);
  std::erase_if(others_, [&](const bus::Guid& other) {
    return !registry.is_here(other) && std::none_of(inputs_.begin(), inputs_.end(), [&](const bus::Following* input) {
      return input->has_matched(other);
    });
  });
}

std::uint64_t RoleBinding::refused() const noexcept {
  std::uint64_t sum = 0;
  for (const bus::Following* input : inputs_) sum += input->refused();
  return sum;
}

std::string RoleBinding::trouble(const NodeRegistry& registry) const {
  const auto names = [&](const auto& participants) {
    std::string all;
    for (const bus::Guid& participant : participants) all += (all.empty() ? "" : " and ") + registry.name_of(participant);
    return all;
  };
  if (!rivals_.empty())
    return fmt::format("two {} nodes claim this session, and none is followed: {}; stop one", role_, names(rivals_));
  if (others_.empty()) return {};
  return fmt::format("what {} sends is refused: the {} of this session is {}", names(others_), role_,
                     registry.name_of(*bound_));
}

}  // namespace voxtouch::runtime
