#pragma once
/// Stability region for plots: contact stiffness over the cut-off of the filter.
#include <vector>

#include "core/coupling/design/loop_parts.hpp"
#include "core/coupling/design/sampled_loop.hpp"

namespace voxtouch::coupling::design {

/// Curves over one list of cut-offs; stiffness at the hand [N/m] or [Nm/rad].
struct StableRegion {
  std::vector<double> cutoff_hz;
  std::vector<double> critical;  ///< the worst case becomes unstable, with the injected damping
  std::vector<double> critical_undamped;  ///< the same without injected damping
  std::vector<double>
      passive;  ///< rule P: stable with any passive hand below; 0 with injected damping
};

/// Damping ratio and injected damping of `chosen` are kept; its cut-off runs from `low_hz` to
/// `high_hz` in `count` equal ratios. Takes some tens of milliseconds.
StableRegion stable_region(const AxisModel& axis, const LoopTiming& timing, const HandRange& hand,
                           const LoopController& chosen, double low_hz, double high_hz, int count);

}  // namespace voxtouch::coupling::design
