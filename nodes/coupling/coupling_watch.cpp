#include "nodes/coupling/coupling_watch.hpp"

#include <algorithm>

#include "core/coupling/passivity.hpp"

namespace voxtouch::coupling_node {
namespace {

std::vector<faults::FaultMessage> messages_of(const std::vector<ContactSeen>& rows) {
  std::vector<faults::FaultMessage> messages;
  for (const ContactSeen& row : rows) {
    messages.push_back(faults::message_of(0, row.contact.sample_time_ns, row.contact));
    messages.push_back(faults::message_of(1, row.contact.sample_time_ns, row.command));
  }
  return messages;
}

}  // namespace

EnergyBounds energy_bounds(const coupling::CouplingCounters& c, double voxel_size_m) noexcept {
  return {coupling::energy_bound_j(c.most_force_n, c.longest_path_m, voxel_size_m),
          coupling::energy_bound_rotation_j(c.most_torque_nm, c.longest_rotation_rad,
                                            c.most_force_n, voxel_size_m)};
}

void count(CouplingCounters& counters, const coupling::CouplingCounters& c,
           const EnergyBounds& bounds, const msg::ContactState& contact) noexcept {
  using enum CouplingCounter;
  const auto set = [&](CouplingCounter counter, auto value) {
    counters.note(counter, static_cast<double>(value));
  };
  if (counters[kSamples] == 0.0)
    set(kFirstSample, contact.sequence_number);
  counters.note(kSamples);
  set(kClamped, c.clamped);
  set(kCapped, c.capped);
  set(kBounded, c.bounded);
  set(kSwings, c.swing.swings);
  set(kSwingHz, c.swing.frequency_hz);
  set(kSwingM, c.swing.amplitude_m);
  set(kSwingN, c.swing.force_n);
  set(kSwingS, c.swing.duration_s);
  set(kLowestEnergy, c.lowest_energy_j);
  set(kLowestRotation, c.lowest_energy_rotation_j);
  set(kEnergyBound, bounds.translation_j);
  set(kRotationBound, bounds.rotation_j);
  set(kFaults, c.faults);
  set(kStiffness, contact.stiffness_bound_n_per_m);
}

CouplingWatch::CouplingWatch(const bus::Participant& participant, const std::string& rig,
                             const std::filesystem::path& fault_records)
    : records_(fault_records, {"coupling", rig, {}},
               {faults::topic_of<msg::ContactState>("/" + rig + "/rendering/contact"),
                faults::topic_of<msg::ForceCommand>("/" + rig + "/coupling/command")},
               messages_of),
      reset_receiver_(participant, rig) {}

bool CouplingWatch::take_reset() noexcept {
  if (device_fault_.exchange(false, std::memory_order_relaxed))
    records_.keep_for_reported("a fault reported by the device");
  return latch_.take_reset();
}

/// Checks the energy of the whole port, because a coupled contact moves energy between translation
/// and rotation. A bouncing tool makes no cycle that the swing watch could follow; its energy
/// reveals it.
void CouplingWatch::end_sample(const ContactSeen& seen, const coupling::CouplingCounters& now,
                               const EnergyBounds& bounds) noexcept {
  constexpr double kUnstableRatio = 5.0;  // multiple of the energy of a stable contact
  constexpr double kNoticeableJ = 0.01;   // a stylus of 50 g at 0.6 m/s
  records_.push(seen);
  if (now.faults != before_.faults)
    keep("a late or unusable contact message");
  if (now.not_finite != before_.not_finite)
    keep("a command with NaN or infinity");
  if (now.swing.swings != before_.swing.swings)
    keep("a self-sustained oscillation of the device");
  if (now.growing && !before_.growing)
    latch_.latch("unstable contact: the force grew over three periods without work of the hand");
  const double energy_j = seen.command.energy_j + seen.command.energy_rotation_j;
  const double bound_j = bounds.translation_j + bounds.rotation_j;
  if (energy_j < -kNoticeableJ && energy_j < -kUnstableRatio * bound_j)
    latch_.latch(
        "unstable contact: the coupling generated five times the energy allowed for a stable "
        "contact");
}

/// A device that hangs, or has left without a final status, reports no fault.
bool CouplingWatch::device_has_failed(const runtime::NodeRegistry& registry,
                                      const runtime::RoleBinding& device) {
  bool failed = false;
  if (const auto& bound = device.participant()) {
    last_device_ = *bound;
    const runtime::NodeReport* report = registry.report_of(*bound);
    failed = report && device_faults_.is_new(*report);
  }
  const std::vector<runtime::Hung> hung = registry.hung();
  const bool silent =
      std::ranges::find(hung, last_device_, &runtime::Hung::participant) != hung.end();
  return (!std::exchange(device_silent_, silent) && silent) || failed;
}

void CouplingWatch::report_to(const runtime::NodeRegistry& registry,
                              const runtime::RoleBinding& device, bool runs,
                              runtime::NodeReport& report, runtime::StatusText& status) {
  if (device_has_failed(registry, device))
    device_fault_.store(true, std::memory_order_relaxed);
  records_.report_to(report);
  reset_receiver_.receive(device.session(), latch_);
  latch_.report_to(report, runs);
  status.set(runtime::StatusPriority::kFaultLatched, std::exchange(report.message, {}));
}

}  // namespace voxtouch::coupling_node
