#pragma once
/// The virtual coupling between contact and device (paper, section 3): its kinds, and what a step
/// is given.
#include <cstdint>
#include <string_view>

#include "core/coupling/coupling_spec.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::coupling {

enum class CouplingKind : std::uint8_t { kDirect = 0, kShapingFilter = 1, kSpringDamper = 2 };
/// "direct", "shaping_filter", "spring_damper"; and back (false where the word is unknown, `kind`
/// untouched).
std::string_view name_of(CouplingKind kind) noexcept;
/// The kind called `word`, as above. Real-time safe.
bool parse_coupling(std::string_view word, CouplingKind& kind) noexcept;

/// One sample's input: what the contact gives at the device's pose.
struct CouplingInput {
  Wrench contact;                        ///< W axes, torque about the tool's origin
  double contact_stiffness_n_per_m = 0;  ///< stiffness bound of this contact; 0 in free space
  /// -d(wrench)/d(pose) of this contact, W axes, about the tool's origin: symmetric, positive
  /// semidefinite, [N/m, N, Nm/rad].
  Mat6 contact_stiffness = Mat6::Zero();
  Pose tool = {};  ///< T in W at this sample
  /// What effects and moving objects may have given the tool so far [J]: the passivity observer
  /// allows their growth.
  double supplied_energy_j = 0.0;
  /// Depth of this contact's deepest point [m], as far as its model tells it; 0 or below: not told.
  double contact_depth_m = 0.0;
  bool depth_goes_on = false;  ///< that depth is held: how much deeper the tool goes from there the
                               ///< model does not tell
};

/// Seconds over which the input is faded in after a start in contact, a reset to a force or a gap.
inline constexpr double kDefaultRampS = 0.2;

}  // namespace voxtouch::coupling
