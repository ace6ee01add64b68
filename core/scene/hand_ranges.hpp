#pragma once
/// What a hand may be, by the way it holds a device.
#include "core/coupling/design/loop_parts.hpp"

namespace voxtouch {

/// The range of hands for a grip; letting go is one of its cases. Apparent at the device, so that they add to its own
/// mass, damping and stiffness.
///
/// Translation: engineering ranges. Arm: round published fits of its end point (0.55 kg, 6.5 Ns/m, 135 N/m; 1.3 kg).
/// Pen: no published coefficients could be confirmed. Both are opened towards the light and soft end, the hard one.
///
/// Rotation: ASSUMPTIONS; no published ranges were found. Each is the translational one times the square of a lever at
/// which the grip takes hold. Pen: the fingers' mass sits 3 cm from the tool's origin (2e-5 to 2e-4 kg m^2); they hold
/// it at two places, tip and the fold of the thumb, 5 to 7 cm apart (0.1 to 2 Nm/rad, 2e-3 to 0.03 Nms/rad). Arm: fist
/// and forearm at 8 to 10 cm (2e-3 to 2e-2 kg m^2), held by wrist and elbow through 13 to 16 cm (1 to 15 Nm/rad, 0.05
/// to 0.6 Nms/rad).
OperatorRange hand_range(Grip grip) noexcept;

}  // namespace voxtouch
