#pragma once
/// From a contact to the command that answers it: what the node does to each contact, and a replay
/// once more.
#include <cstdint>
#include <optional>

#include "core/coupling/running_coupling.hpp"
#include "core/fitting/fit_coupling.hpp"
#include "core/rendering/device_mapping.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::coupling_node {

/// No DDS, thread or clock: the same contacts and couplings give the same bits. A copy goes on from
/// where it was made.
class ContactCoupling {
 public:
  /// How the tool's world is mapped to the device.
  explicit ContactCoupling(const scene::WorkspaceMapping& device)
      : mapping_(device),
        wrench_to_device_(device) {}

  /// Another device session: nothing runs before `adopt`.
  void begin_session(const coupling::design::LoopTiming& timing) noexcept;
  /// From here on this coupling runs, going on from the one that ran; one that must not run leaves
  /// none. Not for the loop: it may allocate.
  void adopt(const fitting::FittedCoupling& fitted, const coupling::design::DeviceModel& device);
  bool runs() const noexcept { return coupling_.has_value(); }
  double period_s() const noexcept { return period_s_; }

  /// Only while one runs. Real-time safe.
  msg::ForceCommand answer(const msg::ContactState& contact) noexcept;
  const coupling::CouplingCounters& counters() const noexcept { return coupling_->counters(); }

 private:
  coupling::ToolSpeedLimits speed_limits() const noexcept;
  void follow_clutch(bool pressed) noexcept;

  /// Two periods for the way round the ring, three that a device holds a command for.
  static constexpr double kValidPeriods = 5.0;
  scene::WorkspaceMapping mapping_;
  rendering::WrenchToDevice wrench_to_device_;
  std::optional<coupling::RunningCoupling>
      coupling_;  ///< none before the first fit and while what was found must not run
  double period_s_ = 1e-3, network_s_ = 0.0;
  std::optional<std::int64_t> last_time_ns_;
  bool clutched_ = false;
};

}  // namespace voxtouch::coupling_node
