#pragma once
/// Input of a coupling law in one step, after input policy and stiffness cap.
#include "core/types/geometry.hpp"

namespace voxtouch::coupling {

struct LawInput {
  Wrench contact;                ///< finite, within the limits of the device [N, Nm], W axes
  double stiffness_n_per_m = 0;  ///< finite, >= 0
  double dt_s = 1e-3;            ///< within the band of the policy
  double weight = 1;             ///< fraction of `contact`; the rest is the start force
};

}  // namespace voxtouch::coupling
