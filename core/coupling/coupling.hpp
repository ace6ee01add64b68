#pragma once
/// The virtual coupling between contact and device (paper, section 3): its kinds and the input of a
/// step.
#include <cstdint>
#include <string_view>

#include "core/coupling/coupling_spec.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::coupling {

/// The three coupling laws; direct.hpp, shaping_filter.hpp and spring_damper.hpp.
enum class CouplingKind : std::uint8_t { kDirect = 0, kShapingFilter = 1, kSpringDamper = 2 };
/// "direct", "shaping_filter" or "spring_damper". `parse_coupling` leaves `kind` unchanged and
/// returns false for another name. Real-time safe.
std::string_view name_of(CouplingKind kind) noexcept;
bool parse_coupling(std::string_view word, CouplingKind& kind) noexcept;

/// Input of one sample: the contact at the pose of the device.
struct CouplingInput {
  Wrench contact;  ///< W axes, torque about the tool's origin
  /// Upper bound of the contact stiffness [N/m]; 0 in free space.
  double contact_stiffness_n_per_m = 0;
  /// -d(wrench)/d(pose) of this contact, W axes, about the tool's origin: symmetric, positive
  /// semidefinite, [N/m, N, Nm/rad].
  Mat6 contact_stiffness = Mat6::Zero();
  Pose tool = {};  ///< T in W at this sample
  /// |sum of the normals| over their number: 1 if all contact forces are parallel, 0 if opposite
  /// walls cancel.
  double coherence = 1.0;
  /// Upper bound of the energy that effects and moving objects have given the tool so far [J]. The
  /// passivity observer allows its growth.
  double supplied_energy_j = 0.0;
};

/// Coherence of touching points; 1 without contact. Real-time safe.
constexpr double coherence_of(std::uint32_t surface_hits, double coherence) noexcept {
  return surface_hits > 0 ? coherence : 1.0;
}

/// Duration of the fade-in of the input after a start in contact, a reset to a force or a gap [s].
inline constexpr double kDefaultRampS = 0.2;

}  // namespace voxtouch::coupling
