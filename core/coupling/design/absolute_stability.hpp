#pragma once
/// Certifies the contacts of a finished design: every contact whose force never decreases with
/// penetration, or only linear ones.
///
/// One multiplier (multiplier.hpp) covers all cases of device, hand and timing, on the velocity of
/// the injected damping and on the slow one, in translation and in rotation. A contact with several
/// axes must be the gradient of a convex potential with a stiffness matrix of at most diag(K). This
/// case requires one common M for all axes (Safonov, Kulkarni 2000).
/// For design time only.
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/coupling/design/designer.hpp"
#include "core/coupling/design/multiplier.hpp"

namespace voxtouch::coupling::design {

enum class ContactClass : std::uint8_t { kNone, kLinear, kMonotone };
std::string_view name_of(ContactClass contact) noexcept;

/// Proof for monotone contacts: a multiplier, or the rule for any passive hand (rule P or
/// Llewellyn's condition).
enum class MonotoneProof : std::uint8_t { kNone, kMultiplier, kPassivity };
std::string_view name_of(MonotoneProof proof) noexcept;

/// Differences between the running loop and the certified one, which no multiplier covers.
enum class CertificateGap : std::uint8_t {
  /// Injected damping acts along the contact and during contact only; in the loop transfer function
  /// L (multiplier.hpp) it always acts.
  kDamperGate,
  kDamperBound,   ///< it adds no more than a ratio of the contact force
  kVelocityBand,  ///< damping blends between two velocity estimates; each alone is certified
  /// Nominal and slowest constant timing are certified; jitter and losses are not.
  kVaryingTiming,
  /// The ends of the ranges of device and hand are certified, not their interior.
  kBetweenCorners,
  kReleasedFrictionless,  ///< out of contact, a device without viscous damping is not slowed
  /// With a force-only device, a contact at a lever to the hand is not a gradient.
  kForceOnlyLever,
  kCurvedContact,  ///< a force that rotates with the surface: a stiffness of -F/R across it
  kVoxelSteps,     ///< a force that steps when a point enters another voxel
  kEncoderSteps,
  kForceLimit,  ///< of the device
};
/// For example "damper_gate".
std::string_view name_of(CertificateGap gap) noexcept;

struct ContactCertificate {
  ContactClass contact = ContactClass::kNone;
  MonotoneProof proof = MonotoneProof::kNone;
  struct Axis {
    /// K [N/m; Nm/rad]: any contact with slopes in [0, K]; infinity: any slope.
    double stiffness = 0.0;
    /// K over the largest slope that the design allows. Below 1 the certificate covers only a part.
    double margin = 0.0;
  };
  std::vector<Axis> axes;  ///< translation; rotation if the device gives torque
  /// K over the stiffness at which the same loops become unstable; 0: no multiplier.
  double ratio_of_linear = 0.0;
  int loops = 0;  ///< number of loops that the multiplier covers
  Multiplier multiplier;
  std::vector<CertificateGap> gaps;
};

/// The certificate of `design`, which was made or evaluated for `request`. An infeasible design has
/// none. Takes 20 ms to 2 s, too long for the start of a ring.
ContactCertificate certify_contacts(const DesignProblem& request, const Design& design);

/// Stiffness of each axis at which the first of the loops becomes unstable, with the full injected
/// damping. The whole law of a spring-damper scales with it.
std::vector<double> linear_limits(const DesignProblem& request, const CouplingSpec& spec);
/// The same loops, each with contacts of up to the `stiffness` of its axis.
std::vector<ContactLoop> contact_loops(const DesignProblem& request, const CouplingSpec& spec,
                                       std::span<const double> stiffness);

}  // namespace voxtouch::coupling::design
