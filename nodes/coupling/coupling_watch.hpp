#pragma once
/// What goes wrong around the coupling: records of it, and the lock at zero force.
#include <atomic>
#include <optional>

#include "core/coupling/running_coupling.hpp"
#include "nodes/faults/fault_recorder.hpp"
#include "nodes/faults/force_lock.hpp"
#include "nodes/runtime/counters.hpp"
#include "nodes/runtime/role_binding.hpp"
#include "nodes/runtime/status_text.hpp"

namespace voxtouch::coupling_node {

enum class CouplingCounter : std::uint8_t {
  kSamples,
  kFirstSample,
  kClamped,
  kCapped,
  kBounded,
  kSwings,
  kSwingHz,
  kSwingM,
  kSwingN,
  kSwingS,
  kLowestEnergy,
  kLowestRotation,
  kEnergyBound,
  kRotationBound,
  kFaults,
  kStiffness
};
inline constexpr auto kCouplingTable = [] {
  using enum CouplingCounter;
  using enum runtime::Counting;
  return std::to_array<runtime::CounterRow<CouplingCounter>>({
      {kSamples, "samples", "samples"},
      {kFirstSample, "first_sample", "sample number", kLast},
      {kClamped, "clamped_inputs", "samples", kLast},
      {kCapped, "capped_samples", "samples", kLast},
      {kBounded, "bounded_samples", "samples", kLast},
      {kSwings, "swings", "swings", kLast},
      {kSwingHz, "swing_hz", "Hz", kLast},
      {kSwingM, "swing_m", "m", kLast},
      {kSwingN, "swing_n", "N", kLast},
      {kSwingS, "swing_s", "s", kLast},
      {kLowestEnergy, "lowest_energy_j", "J", kLast},
      {kLowestRotation, "lowest_energy_rotation_j", "J", kLast},
      {kEnergyBound, "energy_bound_j", "J", kLast},
      {kRotationBound, "energy_bound_rotation_j", "J", kLast},
      {kFaults, "faults", "samples", kLast},
      {kStiffness, "stiffness_bound_max_n_per_m", "N/m", kMaximum},
  });
}();
using CouplingCounters = runtime::Counters<kCouplingTable>;

/// What a sound contact may show of energy at most, after what the coupling has commanded [J].
struct EnergyBounds {
  double translation_j = 0.0, rotation_j = 0.0;
};
EnergyBounds energy_bounds(const coupling::CouplingCounters& counters,
                           double voxel_size_m) noexcept;

/// Takes over what the coupling has counted since its session began, and one contact's stiffness.
/// Real-time safe.
void count(CouplingCounters& counters, const coupling::CouplingCounters& coupling,
           const EnergyBounds& bounds, const msg::ContactState& contact) noexcept;

/// One contact and its answer, for the record of a fault.
struct ContactSeen {
  msg::ContactState contact;
  msg::ForceCommand command;
};

class CouplingWatch {
 public:
  CouplingWatch(const bus::Participant& participant, const std::string& rig,
                const std::filesystem::path& fault_records);

  // The loop. All but `reserve` are real-time safe.
  void reserve(double rate_hz) { records_.reserve(rate_hz); }
  void keep(const char* reason) noexcept { records_.keep(reason); }
  bool locked() const noexcept { return lock_.engaged(); }
  /// True once, where the lock has been opened. Keeps a record where the device saw a fault.
  bool opened() noexcept;
  /// Before a contact is answered.
  void begin_sample(const coupling::CouplingCounters& counters) noexcept { before_ = counters; }
  /// After: records what went wrong, and locks where the contact is unstable.
  void end_sample(const ContactSeen& seen, const coupling::CouplingCounters& now,
                  const EnergyBounds& bounds) noexcept;

  /// The monitor.
  void report_to(const runtime::NodeRegistry& registry, const runtime::RoleBinding& device,
                 bool runs, runtime::NodeReport& report, runtime::StatusText& status);

 private:
  bool device_has_failed(const runtime::NodeRegistry& registry, const runtime::RoleBinding& device);

  faults::FaultRecorder<ContactSeen> records_;
  faults::OthersFaults device_faults_;
  faults::ForceLock lock_;
  faults::LockKeeper keeper_;
  std::optional<bus::Guid> last_device_;  ///< that was bound
  bool device_silent_ = false;            ///< at the last look
  std::atomic<bool> device_fault_{false};
  coupling::CouplingCounters before_;
};

}  // namespace voxtouch::coupling_node
