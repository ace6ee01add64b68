#pragma once
/// The virtual coupling between contact and device: one interface, one sample a step (paper, section 3).
#include <cstdint>
#include <memory>
#include <string_view>

#include "core/coupling/coupling_spec.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch {

enum class CouplingKind : std::uint8_t { kDirect = 0, kShapingFilter = 1, kSpringDamper = 2 };
/// "direct", "shaping_filter", "spring_damper"; and back (false where the word is unknown, `kind` untouched).
std::string_view name_of(CouplingKind kind) noexcept;
bool parse_coupling(std::string_view word, CouplingKind& kind) noexcept;

/// One sample's input: what the contact gives at the device's pose.
struct CouplingInput {
  Wrench contact;                        ///< W axes, torque about the tool's origin
  double contact_stiffness_n_per_m = 0;  ///< stiffness bound of this contact; 0 in free space
  /// -d(wrench)/d(pose) of this contact, W axes, about the tool's origin: symmetric, positive semidefinite, [N/m, N, Nm/rad].
  Mat6 contact_stiffness = Mat6::Zero();
  Pose tool = {};                        ///< T in W at this sample
  /// What effects and moving objects may have given the tool so far [J]: the passivity observer allows their growth.
  double supplied_energy_j = 0.0;
};

/// What happened in the last step, for the command's status bits.
struct CouplingStatus {
  bool ramping = false;     ///< the input is still being faded in after a start in contact, a reset or a gap
  bool held_input = false;  ///< the input was not usable; the last good one was held
  bool clamped = false;     ///< the input was over the device's range and was cut
};

/// A coupling is stepped once for each device sample. Real-time safe.
class Coupling {
 public:
  virtual ~Coupling() = default;
  virtual CouplingKind kind() const noexcept = 0;
  /// The wrench for the device, W axes. `dt_s` as measured between samples; out of [T/5, 5T] or not finite: the nominal
  /// period is used and counted. A gap of more than 10 T starts again at the force given last and fades the new input in. A
  /// non-finite input holds the last good one and is counted.
  virtual Wrench step(const CouplingInput& input, double dt_s) noexcept = 0;
  /// Starts again at rest, giving `held` without a jump and fading from it to the contact. With `held` zero the contact is
  /// faded in only if the first good sample is in contact already: a contact that begins later begins at depth zero by
  /// itself, and fading it would let the tool sink below the layer that pushes.
  virtual void reset(const Wrench& held) noexcept = 0;
  virtual std::uint64_t faults() const noexcept = 0;  ///< bad periods and bad inputs so far
  virtual CouplingStatus status() const noexcept = 0; ///< of the last step
};

/// Seconds over which the input is faded in after a start in contact, a reset to a force or a gap.
inline constexpr double kDefaultRampS = 0.2;

/// The coupling for `spec` in a loop with period `sample_time_s`. Throws std::invalid_argument with the first refusal of
/// `validate`.
std::unique_ptr<Coupling> make_coupling(const CouplingSpec& spec, const CouplingLimits& limits, double sample_time_s,
                                        double ramp_s = kDefaultRampS);

}  // namespace voxtouch
