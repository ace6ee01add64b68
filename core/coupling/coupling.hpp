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
  /// |sum of the normals| over their number: 1 where all push the same way, 0 where walls push
  /// against each other.
  double coherence = 1.0;
  /// What effects and moving objects may have given the tool so far [J]: the passivity observer
  /// allows their growth.
  double supplied_energy_j = 0.0;
};

/// Of points that touch; nothing that touches, and a virtual tool, which has one spring, push one
/// way. Real-time safe.
constexpr double coherence_of(std::uint32_t surface_hits, std::uint32_t tool_queries,
                              double coherence) noexcept {
  return surface_hits > 0 && tool_queries == 0 ? coherence : 1.0;
}

/// Seconds over which the input is faded in after a start in contact, a reset to a force or a gap.
inline constexpr double kDefaultRampS = 0.2;

}  // namespace voxtouch::coupling
