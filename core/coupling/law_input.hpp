#pragma once
/// Input of a coupling law in one step, after input policy and stiffness cap.
#include "core/types/geometry.hpp"

namespace voxtouch::coupling {

/// Input of `step` of DirectCoupling, ShapingFilter and SpringDamper.
struct LawInput {
  Wrench contact;                ///< finite, within the limits of the device [N, Nm], W axes
  double stiffness_n_per_m = 0;  ///< bound of the contact stiffness [N/m]: finite, >= 0
  double dt_s = 1e-3;            ///< period [s], within kPeriodBand of the nominal one
  double weight = 1;             ///< fraction of `contact`; the rest is the start force
};

}  // namespace voxtouch::coupling
