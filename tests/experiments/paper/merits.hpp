#pragma once
/// The experiments' figures of merit, each next to the value of the reference implementation.
#include <string>
#include <vector>

namespace voxtouch::paper {

struct Merit {
  std::string what;
  double ours = 0.0;               ///< median over the settings
  double least = 0.0, most = 0.0;  ///< over the settings
  double reference = 0.0;
  std::string conditions;  ///< and, if the two differ by more than a tenth, the reason
  double difference() const noexcept { return reference != 0.0 ? ours / reference - 1.0 : ours; }
};

/// Experiments 1 and 2 and the pointshells: ratios of tangential RMS. `steps` poses a slide.
std::vector<Merit> contact_merits(int steps);
/// Figure 11: the shaping filter on the sphere round the cylinder.
std::vector<Merit> filter_merits();

}  // namespace voxtouch::paper
