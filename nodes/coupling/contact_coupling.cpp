#include "nodes/coupling/contact_coupling.hpp"

#include "core/device_fit/design_problem.hpp"
#include "nodes/coupling/ring_messages.hpp"

namespace voxtouch::coupling_node {

AdoptedCoupling adopted(const device_fit::FittedCoupling& fitted,
                        const scene::WorkspaceMapping& mapping,
                        const coupling::design::DeviceModel& device) {
  return {fitted.spec, device_fit::limits_W(mapping, device), fitted.refusal.empty()};
}

void ContactCoupling::begin_session(const coupling::design::LoopTiming& timing) noexcept {
  period_s_ = timing.period_s, network_s_ = timing.network_s;
  coupling_.reset();
  last_time_ns_.reset();
  clutch_ = {}, last_ = {};
}

void ContactCoupling::adopt(const AdoptedCoupling& next) {
  if (!next.runs || (coupling_ && !coupling_->redesign(next.spec))) {
    coupling_.reset();
  } else if (!coupling_) {
    coupling_.emplace(next.spec, next.limits, period_s_, coupling::kDefaultRampS, speed_limits());
  }
}

/// No operator moves a device faster than this. A larger change is a jump of the pose (clutch,
/// restart), not a velocity.
coupling::ToolSpeedLimits ContactCoupling::speed_limits() const noexcept {
  coupling::ToolSpeedLimits limits;
  limits.linear_m_per_s *= mapping_.position_scale;
  return limits;
}

msg::ForceCommand ContactCoupling::answer(const msg::ContactState& contact) noexcept {
  const double dt_s =
      last_time_ns_ ? runtime::seconds_between(*last_time_ns_, contact.sample_time_ns) : period_s_;
  last_time_ns_ = contact.sample_time_ns;
  follow_clutch((contact.flags & msg::contact_state::kFlagClutched) != 0, dt_s);
  const coupling::CouplingInput input = coupling_input(contact);
  const coupling::CouplingOutput out = coupling_->step(input, dt_s);
  last_ = out.wrench;
  const Wrench wrench_D = wrench_to_device_(clutch_.of(out.wrench), input.tool.orientation);
  return force_command(contact, out, wrench_D, kValidPeriods * period_s_ + network_s_);
}

/// While the clutch is pressed, the tool stays in place and the device moves freely. The force
/// fades out, and fades in again after the release.
void ContactCoupling::follow_clutch(bool pressed, double dt_s) noexcept {
  if (clutch_.advance(pressed, dt_s))
    coupling_->reset(clutch_.scaled(last_));
}

}  // namespace voxtouch::coupling_node
