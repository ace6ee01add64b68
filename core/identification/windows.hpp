#pragma once
/// Pieces of a record in which the axis moves in one direction.
#include <cstddef>
#include <vector>

#include "core/identification/axis_record.hpp"

namespace voxtouch::identification {

/// Entries [begin, end) of a record, of one segment.
struct Window {
  std::size_t begin = 0, end = 0;
  int direction = 1;
};

struct WindowRules {
  double skip_start = 0.28;  ///< ratio of each stroke that is left out: presliding and start
  double skip_end = 0.06;    ///< the same at the end
  double longest_s = 0.5;
  double shortest_s = 0.12;
  double encoder_step_m = 0.0;
};

/// Windows of the strokes of part `first` and all later parts. A window in which the smoothed
/// position stops or reverses is cut there: presliding spoils fits across reversals.
std::vector<Window> stroke_windows(const AxisRecord& record, Part first, const WindowRules& rules);

/// Windows of the pulses, from the start of each motion to its end.
std::vector<Window> pulse_windows(const AxisRecord& record, double encoder_step_m);

/// Smallest common increment of the positions [m]; 0: not found. Ignores rounding below 1e-10 m.
double encoder_step(const AxisRecord& record);

}  // namespace voxtouch::identification
