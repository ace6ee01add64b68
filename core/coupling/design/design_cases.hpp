#pragma once
/// The cases that a design must be stable for: the ends of the ranges of device, hand and timing.
#include <memory>
#include <vector>

#include "core/coupling/design/loop_parts.hpp"
#include "core/coupling/design/sampled_loop.hpp"

namespace voxtouch::coupling::design {

/// Cache of the inner limits of a plant, since a search uses the same few repeatedly.
class InnerLimits {
 public:
  InnerLimit of(const LoopPlant& plant, double velocity_filter_rad_per_s, int velocity_window);

 private:
  struct Known {
    LoopPlant plant;
    double velocity_filter_rad_per_s;
    int velocity_window;
    InnerLimit limit;
  };
  std::vector<Known> known_;
};

struct DesignCase : LoopCase {
  /// Minimum damping ratio of the dominant mode in contact; 0: no minimum.
  double least_damping_ratio = 0.0;
  /// Of `plant`; shared by copies.
  std::shared_ptr<InnerLimits> inner = std::make_shared<InnerLimits>();
};

/// The slowest timing as a uniform one. Every period is (1 + jitter) T. The delay is longer by
/// (jitter + lost) T, the effect of jitter and lost samples. Its own jitter and losses are 0.
LoopTiming slowest(const LoopTiming& timing);
/// Time constant of the first-order lag [s]; 0 for infinite bandwidth.
double effort_lag_s(const AxisModel& axis);

/// {least, largest inertia} x {released if allowed, corners of the box, its centre} x {nominal,
/// slowest timing}, without duplicates. For a hand only known to be passive: the device alone,
/// since no list of hands would suffice.
std::vector<DesignCase> design_cases(const AxisModel& axis, const LoopTiming& timing,
                                     const HandRange& hand);

}  // namespace voxtouch::coupling::design
