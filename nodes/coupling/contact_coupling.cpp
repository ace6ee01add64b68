#include "nodes/coupling/contact_coupling.hpp"

#include "core/fitting/design_problem.hpp"
#include "nodes/coupling/ring_messages.hpp"

namespace voxtouch::coupling_node {

void ContactCoupling::begin_session(const coupling::design::LoopTiming& timing) noexcept {
  period_s_ = timing.period_s, network_s_ = timing.network_s;
  coupling_.reset();
  last_time_ns_.reset();
  clutched_ = false;
}

void ContactCoupling::adopt(const fitting::FittedCoupling& fitted,
                            const coupling::design::DeviceModel& device) {
  if (!fitted.refusal.empty() || (coupling_ && !coupling_->redesign(fitted.spec))) {
    coupling_.reset();
  } else if (!coupling_) {
    coupling_.emplace(fitted.spec, fitting::limits_W(mapping_, device), period_s_,
                      coupling::kDefaultRampS, speed_limits());
  }
}

/// Faster than this no hand moves a device: the pose has jumped (a clutch, a restart), and that is
/// no velocity.
coupling::ToolSpeedLimits ContactCoupling::speed_limits() const noexcept {
  coupling::ToolSpeedLimits limits;
  limits.linear_m_per_s *= mapping_.position_scale;
  return limits;
}

msg::ForceCommand ContactCoupling::answer(const msg::ContactState& contact) noexcept {
  const double dt_s =
      last_time_ns_ ? runtime::seconds_between(*last_time_ns_, contact.sample_time_ns) : period_s_;
  last_time_ns_ = contact.sample_time_ns;
  follow_clutch((contact.flags & msg::contact_state::kFlagClutched) != 0);
  const coupling::CouplingInput input = coupling_input(contact);
  const coupling::CouplingOutput out = coupling_->step(input, dt_s);
  const Wrench wrench_D =
      clutched_ ? Wrench{} : wrench_to_device_(out.wrench, input.tool.orientation);
  return force_command(contact, out, wrench_D, kValidPeriods * period_s_ + network_s_);
}

/// While the clutch is pressed the tool stays and the device moves free: no force; the contact
/// fades in again afterwards.
void ContactCoupling::follow_clutch(bool pressed) noexcept {
  if (pressed != clutched_)
    coupling_->reset({});
  clutched_ = pressed;
}

}  // namespace voxtouch::coupling_node
