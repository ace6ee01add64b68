#include "nodes/replay/coupling_replay.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "nodes/design_text/design_text.hpp"
#include "nodes/replay/flush_denormals_guard.hpp"

namespace voxtouch::replay {

device_fit::FittedCoupling CouplingReplay::fit(const rendering::StiffnessBounds& bounds,
                                               const device_fit::SceneRequirements& demand) const {
  const FlushDenormalsGuard arithmetic;
  return device_fit::fit_coupling(scene_, device_, bounds, demand);
}

void CouplingReplay::begin_session(const RecordedSession& session,
                                   const rendering::StiffnessBounds& bounds,
                                   const device_fit::SceneRequirements& demand) {
  session_ = &session;
  device_ = coupling::design::model_of(*session.device);
  bounds_ = bounds;
  next_design_ = 0;
  as_recorded_ = recorded_scene_ && !session.designs.empty();
  if (recorded_scene_ && !as_recorded_)
    notes_.push_back(fmt::format(
        "The recording has no coupling design of session {}: the coupling is designed again.",
        session.id));
  fits_.assign(1, fit(bounds, demand));
  coupling_.begin_session(device_.timing);
  if (!as_recorded_)
    adopt(fits_.back());
}

void CouplingReplay::contact_displays(const rendering::StiffnessBounds& bounds,
                                      const device_fit::SceneRequirements& demand) {
  device_fit::FittedCoupling next = fits_.back();
  if (bounds == bounds_) {
    next.refusal =
        device_fit::judge_again(next, scene_, device_, bounds.translation.one_point, demand);
    if (next.refusal.empty() == fits_.back().refusal.empty())
      return;
  } else {
    bounds_ = bounds;
    next = fit(bounds, demand);
  }
  fits_.push_back(std::move(next));
  if (!as_recorded_)
    adopt(fits_.back());
}

void CouplingReplay::adopt(const device_fit::FittedCoupling& fitted) {
  const FlushDenormalsGuard arithmetic;
  coupling_.adopt(coupling_node::adopted(fitted, scene_.device, device_));
  if (!coupling_.runs())
    notes_.push_back("No force is commanded: " + design_text::sentence_of(fitted.refusal));
}

void CouplingReplay::adopt(const coupling_node::Adoption& design) {
  if (design.starts_at_rest)
    coupling_.begin_session(device_.timing);
  coupling_.adopt(design.coupling);
  if (!session_->described_anew)
    compare(design.coupling);  // otherwise the bag does not contain what it was fitted to
}

/// This program must make the same of the recorded device and contact.
void CouplingReplay::compare(const coupling_node::AdoptedCoupling& recorded) {
  ++compared_;
  const auto made = std::ranges::find_if(fits_, [&](const device_fit::FittedCoupling& fitted) {
    const coupling_node::AdoptedCoupling now =
        coupling_node::adopted(fitted, scene_.device, device_);
    return (now.runs || !recorded.runs) && coupling_node::differences(recorded, now).empty();
  });
  if (made != fits_.end())
    return void(fits_.erase(fits_.begin(), made));
  ++differ_;
  if (!fits_.back().refusal.empty())
    notes_.push_back(fmt::format("Design {} was active in the recording and is refused now: {}",
                                 next_design_, design_text::sentence_of(fits_.back().refusal)));
  for (const std::string& difference : coupling_node::differences(
           recorded, coupling_node::adopted(fits_.back(), scene_.device, device_)))
    notes_.push_back(fmt::format("Design {}: {}", next_design_, difference));
}

std::optional<msg::ForceCommand> CouplingReplay::answer(const msg::ContactState& contact) {
  const auto& designs = session_->designs;
  while (as_recorded_ && next_design_ < designs.size() &&
         designs[next_design_].from_sample <= contact.sequence_number)
    adopt(designs[next_design_++]);
  if (!coupling_.runs())
    return std::nullopt;
  const FlushDenormalsGuard arithmetic;
  return coupling_.answer(contact);
}

}  // namespace voxtouch::replay
