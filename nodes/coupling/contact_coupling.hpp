#pragma once
/// Computes the command that answers a contact, in the node and in a replay.
#include <cstdint>
#include <optional>

#include "core/coupling/clutch_fade.hpp"
#include "core/coupling/running_coupling.hpp"
#include "core/device_fit/fit_coupling.hpp"
#include "core/rendering/device_mapping.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::coupling_node {

/// Everything needed to run a coupling again, except the period.
struct AdoptedCoupling {
  coupling::CouplingSpec spec;
  coupling::CouplingLimits limits;  ///< in W
  bool runs = false;                ///< false: no force may be commanded
};
AdoptedCoupling adopted(const device_fit::FittedCoupling& fitted,
                        const scene::WorkspaceMapping& mapping,
                        const coupling::design::DeviceModel& device);

/// Computes force commands from contacts. It uses no DDS, threads or clocks: equal contacts and
/// couplings give bit-identical commands.
class ContactCoupling {
 public:
  explicit ContactCoupling(const scene::WorkspaceMapping& device)
      : mapping_(device),
        wrench_to_device_(device) {}

  /// Starts another device session. No coupling runs until `adopt`.
  void begin_session(const coupling::design::LoopTiming& timing) noexcept;
  /// Replaces the coupling and keeps its state. If `next` must not run, no coupling runs
  /// afterwards. May allocate. Throws std::invalid_argument if no coupling runs yet and validate
  /// refuses the specification.
  void adopt(const AdoptedCoupling& next);
  bool runs() const noexcept { return coupling_.has_value(); }
  double period_s() const noexcept { return period_s_; }

  /// Requires a running coupling. Real-time safe.
  msg::ForceCommand answer(const msg::ContactState& contact) noexcept;
  const coupling::CouplingCounters& counters() const noexcept { return coupling_->counters(); }

 private:
  coupling::ToolSpeedLimits speed_limits() const noexcept;
  void follow_clutch(bool pressed, double dt_s) noexcept;

  /// Two periods for one pass of the ring, plus three for which a device holds a command.
  static constexpr double kValidPeriods = 5.0;
  scene::WorkspaceMapping mapping_;
  rendering::WrenchToDevice wrench_to_device_;
  std::optional<coupling::RunningCoupling> coupling_;  ///< empty: no force
  double period_s_ = 1e-3, network_s_ = 0.0;
  std::optional<std::int64_t> last_time_ns_;
  coupling::ClutchFade clutch_;
  Wrench last_;  ///< last wrench of the coupling, in W
};

}  // namespace voxtouch::coupling_node
