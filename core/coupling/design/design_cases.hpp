#pragma once
/// The cases that a design has to hold in: the ends of device, hand and timing.
#include <memory>
#include <string>
#include <vector>

#include "core/coupling/design/loop_parts.hpp"
#include "core/coupling/design/sampled_loop.hpp"

namespace voxtouch::coupling::design {

/// The inner limits of a plant that were asked for, since a search asks for the same few again and
/// again.
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

/// One vertex of the box of what may be.
struct DesignCase {
  LoopPlant plant;
  bool held = false;                 ///< false: the device is released
  bool slow = false;                 ///< the slowest timing instead of the nominal one
  double least_damping_ratio = 0.0;  ///< that the slowest swing in contact is to have; 0: any
  std::shared_ptr<InnerLimits> inner =
      std::make_shared<InnerLimits>();  ///< of `plant`; copies share it
};

/// Words of one kind of motion.
struct AxisUnits {
  const char* name;       ///< "Translation", "Rotation"
  const char* stiffness;  ///< "N/m", "Nm/rad"
  const char* damping;
  const char* inertia;
  const char* effort;
  const char* position;
};
extern const AxisUnits kTranslationUnits, kRotationUnits;

/// The slowest that the timing may be, as a uniform one: every period (1 + jitter) T, and a delay
/// longer by what jitter and lost samples can add, (jitter + lost) T. Its own jitter and losses are
/// 0.
LoopTiming slowest(const LoopTiming& timing);
/// Time constant of the first-order lag [s]; 0 where the bandwidth is infinite.
double effort_lag_s(const AxisModel& axis);

/// {least, largest inertia} x {released if it may be, the box's corners, its centre} x {nominal,
/// slowest timing}; corners that coincide once. For a hand of which only passivity is known: the
/// device alone, since no list of hands would do.
std::vector<DesignCase> design_cases(const AxisModel& axis, const LoopTiming& timing,
                                     const HandRange& hand);

/// "released, 0.2 kg, slowest timing"; "held (0.1 kg, 3 Ns/m, 200 N/m), 0.08 kg".
std::string describe(const DesignCase& one, const AxisUnits& units);

}  // namespace voxtouch::coupling::design
