#include "core/scene/hand_ranges.hpp"

namespace voxtouch {
namespace {

HandRange range(double mass_min, double mass_max, double damping_min, double damping_max, double stiffness_min,
                double stiffness_max) noexcept {
  HandRange out;
  out.mass_min = mass_min, out.mass_max = mass_max;
  out.damping_min = damping_min, out.damping_max = damping_max;
  out.stiffness_min = stiffness_min, out.stiffness_max = stiffness_max;
  return out;
}

}  // namespace

OperatorRange hand_range(Grip grip) noexcept {
  if (grip == Grip::kPen) return {range(0.02, 0.2, 0.5, 8.0, 20.0, 800.0), range(2e-5, 2e-4, 2e-3, 0.03, 0.1, 2.0)};
  return {range(0.3, 2.0, 3.0, 30.0, 50.0, 600.0), range(2e-3, 2e-2, 0.05, 0.6, 1.0, 15.0)};
}

}  // namespace voxtouch
