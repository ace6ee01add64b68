#include "nodes/replay/coupling_replay.hpp"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "nodes/coupling/design_message.hpp"
#include "nodes/replay/loop_arithmetic.hpp"

namespace voxtouch::replay {
namespace {

/// The recorder takes design and commands in turns: a design may be used so long after it was told,
/// and no longer.
constexpr std::int64_t kLatestUseNs = 500'000'000;
/// After that all ramps of a design are over: what its beginning does has shown by then, if the
/// hand is in contact.
constexpr std::int64_t kShownNs = 2'500'000'000;
/// A fit takes some tenths of a second. More samples than this lie between plan and design only
/// where the ring stood still.
constexpr std::size_t kMaxCandidates = 2000;

bool same_bits(const msg::ForceCommand& a, const msg::ForceCommand& b) noexcept {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

}  // namespace

fitting::FittedCoupling CouplingReplay::fit(const rendering::StiffnessBounds& bounds,
                                            const fitting::DeviceDemand& demand) const {
  const LoopArithmetic arithmetic;
  return fitting::fit_coupling(scene_, device_, bounds, demand);
}

void CouplingReplay::begin_session(const RecordedSession& session,
                                   const rendering::StiffnessBounds& bounds,
                                   const fitting::DeviceDemand& demand) {
  session_ = &session;
  device_ = coupling::design::model_of(*session.device);
  bounds_ = bounds;
  wanted_.clear(), open_ = false, next_design_ = 0;
  running_ = fit(bounds, demand);
  free_.begin_session(device_.timing);
  candidates_.assign(1, Candidate{free_, 0});
  adopt(running_);
  check(running_, next_design_++);
}

/// At once, in all that goes on.
void CouplingReplay::adopt(const fitting::FittedCoupling& fitted) {
  const LoopArithmetic arithmetic;
  running_ = fitted;
  if (candidates_.empty())
    candidates_.assign(1, Candidate{free_, 0});
  for (Candidate& one : candidates_)
    one.coupling.adopt(fitted, device_);
  if (candidates_.front().coupling.runs())
    return;
  notes_.push_back("No force is commanded: " + fitted.refusal);
  candidates_.clear();
}

void CouplingReplay::contact_shows(std::uint64_t from_sample,
                                   const rendering::StiffnessBounds& bounds,
                                   const fitting::DeviceDemand& demand) {
  if (bounds == bounds_) {
    fitting::FittedCoupling judged = running_;
    judged.refusal =
        fitting::judge_again(running_, scene_, device_, bounds.translation.one_point, demand);
    if (judged.refusal.empty() == running_.refusal.empty())
      return;
    ++next_design_;
    return adopt(judged);
  }
  bounds_ = bounds;
  fitting::FittedCoupling fitted = fit(bounds, demand);
  if (search_ && runs() && fitted.refusal.empty())
    return wanted_.push_back({from_sample, std::move(fitted)});
  adopt(fitted);
  check(fitted, next_design_++);
}

/// The recorded design must be what this program makes of the same device and contact.
void CouplingReplay::check(const fitting::FittedCoupling& fitted, std::size_t design) {
  if (design >= session_->designs.size())
    return notes_.push_back(
        fmt::format("Design {} of session {} is not in the bag.", design + 1, session_->id));
  const RecordedDesign& told = session_->designs[design];
  const auto made = numbers_of(coupling_node::design_numbers(fitted, device_.timing.period_s));
  constexpr std::string_view kNames[] = {"cutoff_hz",
                                         "damping_ratio",
                                         "gain",
                                         "stiffness_n_per_m",
                                         "damping_ns_per_m",
                                         "stiffness_cap_n_per_m",
                                         "stiffness_cap_nm_per_rad",
                                         "injected_damping_ns_per_m",
                                         "injected_damping_nms_per_rad",
                                         "velocity_filter_hz",
                                         "velocity_window",
                                         "sample_time_s"};
  if (told.kind != fitted.spec.kind)
    return notes_.push_back(fmt::format("Design {} was a {}, and is a {} now.", design + 1,
                                        told.kind, fitted.spec.kind));
  for (std::size_t n = 0; n < made.size(); ++n)
    if (std::memcmp(&made[n], &told.numbers[n], sizeof made[n]) != 0)
      notes_.push_back(fmt::format("Design {} had {} {}, and has {} now.", design + 1, kNames[n],
                                   told.numbers[n], made[n]));
}

/// Which of those that were called for the next one in the bag is: of two that came quickly one
/// after the other only the last may have been made.
void CouplingReplay::open_next() {
  if (open_ || wanted_.empty() || next_design_ >= session_->designs.size())
    return;
  const RecordedDesign& told = session_->designs[next_design_];
  const auto made = std::ranges::find_if(wanted_, [&](const Wanted& one) {
    const auto numbers =
        numbers_of(coupling_node::design_numbers(one.fitted, device_.timing.period_s));
    return std::memcmp(numbers.data(), told.numbers.data(), sizeof numbers) == 0;
  });
  if (made != wanted_.end())
    wanted_.erase(wanted_.begin(), made);
  open_ = true;
}

/// One more that takes the design up at this sample; where it is too late for that, all do.
void CouplingReplay::spawn(std::uint64_t sample, std::int64_t taken_ns) {
  if (!open_ || sample < wanted_.front().from_sample || candidates_.front().began != 0 ||
      candidates_.size() > kMaxCandidates)
    return;
  Candidate next = candidates_.front();
  next.coupling.adopt(wanted_.front().fitted, device_);
  next.began = sample;
  if (!next.coupling.runs())
    return;
  const bool late = taken_ns > session_->designs[next_design_].taken_ns + kLatestUseNs;
  if (late)
    candidates_.clear();
  candidates_.push_back(std::move(next));
  if (late)
    keep(0);
}

msg::ForceCommand CouplingReplay::answer(const msg::ContactState& contact,
                                         const msg::ForceCommand& recorded, std::int64_t taken_ns) {
  const LoopArithmetic arithmetic;
  open_next();
  if (candidates_.size() == 1 ||
      taken_ns <= session_->designs[next_design_].taken_ns + kLatestUseNs)
    spawn(contact.sequence_number, taken_ns);
  std::vector<msg::ForceCommand> commands;
  for (Candidate& one : candidates_)
    commands.push_back(one.coupling.answer(contact));
  if (candidates_.size() == 1)
    return commands.front();
  std::size_t kept = 0, last = 0;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (!same_bits(commands[i], recorded))
      continue;
    last = i;
    if (kept != i)
      candidates_[kept] = std::move(candidates_[i]);
    ++kept;
  }
  if (kept == 0) {  // nothing of this gives the recorded command: what differs is something else
    keep(candidates_.size() - 1);
    return commands.back();
  }
  candidates_.resize(kept, candidates_.front());
  close(taken_ns);
  return commands[last];
}

/// Once the design must run, who does not run it is none; once it must have shown, those that are
/// left give the same commands.
void CouplingReplay::close(std::int64_t taken_ns) {
  if (!open_)
    return;
  const std::int64_t told_ns = session_->designs[next_design_].taken_ns;
  if (candidates_.size() > 1 && candidates_.front().began == 0 && taken_ns > told_ns + kLatestUseNs)
    candidates_.erase(candidates_.begin());
  if (candidates_.front().began == 0)
    return;
  if (candidates_.size() == 1 || taken_ns > told_ns + kShownNs)
    keep(0);
}

/// This one goes on as the only one.
void CouplingReplay::keep(std::size_t index) {
  const std::uint64_t first = candidates_.front().began, last = candidates_.back().began;
  const bool told = candidates_.size() == 1;
  if (candidates_[index].began != 0) {
    notes_.push_back(
        told ? fmt::format("Design {} began at sample {}: its commands tell.", next_design_ + 1,
                           candidates_[index].began)
             : fmt::format("Design {} began between samples {} and {}: no command tells where, and "
                           "what follows is compared as if it were {}.",
                           next_design_ + 1, first, last, candidates_[index].began));
    running_ = wanted_.front().fitted;
    check(running_, next_design_++);
    wanted_.pop_front();
    open_ = false;
  }
  candidates_ = std::vector(1, Candidate{candidates_[index].coupling, 0});
}

}  // namespace voxtouch::replay
