#pragma once
/// Results of the experiments as values: the program writes them, the tests check them.
#include <string>
#include <vector>

#include "tests/experiments/paper/contact_cases.hpp"
#include "tests/experiments/paper/merits.hpp"

namespace voxtouch::paper {

struct Smoothness {
  double noise = 0.0;         ///< standard deviation over mean
  double largest_step = 0.0;  ///< between two milliseconds, over the mean
};

/// Figure 11. Forces over their raw mean.
struct FilterExperiment {
  double step_s = 0.0, rise_time_s = 0.0;
  std::vector<double> raw, spring_damper, shaping_filter;
  Smoothness of_raw, of_spring_damper, of_filter;
};
FilterExperiment filter_experiment();

/// Cases against the paper's claim: a concave corner and a symmetric slot with every contact model.
/// Means over random places and rotations; R / e = 10, 0.5 e deep.
struct CornerAndSlot {
  std::string contact_model;
  double corner_over_walls =
      0.0;  ///< |mean force in the corner| over |sum of the two walls' alone|
  double slot_over_wall =
      0.0;  ///< RMS of the net force over one wall's mean force; 0 would be right
};
std::vector<CornerAndSlot> corner_and_slot(std::uint64_t seed);

}  // namespace voxtouch::paper
