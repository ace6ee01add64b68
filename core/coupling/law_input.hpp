#pragma once
/// What a law of the coupling is given in one step, after input policy and stiffness cap.
#include "core/types/geometry.hpp"

namespace voxtouch::coupling {

struct LawInput {
  Wrench contact;                ///< finite, within what the device can give [N, Nm], W axes
  double stiffness_n_per_m = 0;  ///< finite, >= 0
  double dt_s = 1e-3;            ///< within the policy's band
  double weight = 1;  ///< fraction of `contact`; the rest belongs to the force of the start
};

}  // namespace voxtouch::coupling
