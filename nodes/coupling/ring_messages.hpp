#pragma once
/// Converts between messages of the ring and values of the coupling, which validates them.
/// Real-time safe.
#include <cmath>
#include <cstdint>

#include "core/coupling/running_coupling.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/stamps.hpp"

namespace voxtouch::coupling_node {

/// The wrench acts on the operator, in W axes, about the origin of the tool.
inline coupling::CouplingInput coupling_input(const msg::ContactState& contact) noexcept {
  coupling::CouplingInput input;
  input.contact = runtime::from_msg(contact.wrench);
  input.contact_stiffness_n_per_m = contact.stiffness_bound_n_per_m;
  input.contact_stiffness = runtime::from_msg(contact.stiffness);
  input.tool = runtime::from_msg(contact.tool_pose);
  input.coherence = coupling::coherence_of(contact.surface_hits, contact.coherence);
  input.supplied_energy_j = contact.supplied_energy_j;
  return input;
}

/// STATUS_* bits of ForceCommand.
inline std::uint32_t status_bits(const coupling::CouplingOutput& out) noexcept {
  using namespace msg::force_command;
  return (out.ramping ? kStatusRamping : 0U) | (out.repeated_input ? kStatusLatchedInput : 0U) |
         (out.clamped ? kStatusClamped : 0U) | (out.capped ? kStatusCapped : 0U) |
         (out.growing ? kStatusGrowing : 0U) | (out.bounded ? kStatusBounded : 0U);
}

/// The command for the sample of `contact`. `wrench_D` is the force of `out` in the device frame;
/// it is valid for `valid_s` [s].
inline msg::ForceCommand force_command(const msg::ContactState& contact,
                                       const coupling::CouplingOutput& out, const Wrench& wrench_D,
                                       double valid_s) noexcept {
  msg::ForceCommand m{};
  m.session_id = contact.session_id;
  m.sequence_number = contact.sequence_number;
  m.sample_time_ns = contact.sample_time_ns;
  m.valid_until_ns = runtime::ns_after(contact.sample_time_ns, std::llround(valid_s * 1e9));
  m.wrench = runtime::to_msg(wrench_D);
  m.energy_j = out.energy_j;
  m.energy_rotation_j = out.energy_rotation_j;
  m.status = status_bits(out);
  m.injected_n = static_cast<float>(out.injected_n);
  return m;
}

}  // namespace voxtouch::coupling_node
