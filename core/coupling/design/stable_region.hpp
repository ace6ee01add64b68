#pragma once
/// Where the loop is stable: contact stiffness over the filter's cut-off, for a picture.
#include <vector>

#include "core/coupling/design/loop_parts.hpp"
#include "core/coupling/design/sampled_loop.hpp"

namespace voxtouch::coupling::design {

/// Curves over one list of cut-offs; stiffness at the hand [N/m] or [Nm/rad].
struct StableRegion {
  std::vector<double> cutoff_hz;
  std::vector<double>
      critical;  ///< the worst case becomes unstable here, with the injected damping
  std::vector<double> critical_undamped;  ///< likewise, without it
  std::vector<double>
      passive;  ///< rule P: stable with any passive hand below; 0 with injected damping
};

/// `chosen`: its damping ratio and injected damping are kept, its cut-off runs from `low_hz` to
/// `high_hz` in `count` equal ratios. Pure arithmetic; some tens of milliseconds.
StableRegion stable_region(const AxisModel& axis, const LoopTiming& timing, const HandRange& hand,
                           const LoopController& chosen, double low_hz, double high_hz, int count);

/// The critical stiffness of the worst of all cases for one controller.
double worst_critical_stiffness(const AxisModel& axis, const LoopTiming& timing,
                                const HandRange& hand, const LoopController& controller);

}  // namespace voxtouch::coupling::design
