#pragma once
/// Which contacts a finished design is certified for: any whose force never falls with the
/// penetration, or linear ones.
///
/// One multiplier (multiplier.hpp) for all cases of device, hand and timing, on the velocity of the
/// injected damping and on the slow one, in translation and in rotation. A contact with several
/// axes has to be the gradient of a convex potential with a stiffness matrix of at most diag(K);
/// one M for all axes is what this case needs (Safonov, Kulkarni 2000).
///
/// Arithmetic for the time of designing: it allocates. The same input gives the same result.
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/coupling/design/designer.hpp"
#include "core/coupling/design/multiplier.hpp"

namespace voxtouch::coupling::design {

enum class ContactClass : std::uint8_t { kNone, kLinear, kMonotone };
/// "none", "linear", "monotone".
std::string_view name_of(ContactClass contact) noexcept;

/// What proves it for monotone contacts: a multiplier, or the rule for any passive hand (rule P, or
/// Llewellyn's condition).
enum class MonotoneProof : std::uint8_t { kNone, kMultiplier, kPassivity };
/// "none", "multiplier", "passivity".
std::string_view name_of(MonotoneProof proof) noexcept;

/// What is in the loop that runs and not in the one that is certified.
enum class CertificateGap : std::uint8_t {
  kDamperGate,      ///< injected damping acts in contact only and along it; in L it always acts
  kDamperBound,     ///< and adds no more than a ratio of the contact force
  kVelocityBand,    ///< damping goes over from one velocity estimate to the other; each alone is
                    ///< certified
  kVaryingTiming,   ///< the nominal and the slowest constant timing are certified, not jitter and
                    ///< losses
  kBetweenCorners,  ///< the ends of the ranges of device and hand are certified, not all between
  kReleasedFrictionless,  ///< out of contact nothing stops a device without viscous damping
  kForceOnlyLever,  ///< a contact next to the hand of a device without torque is no gradient for it
  kCurvedContact,   ///< a force that turns with the surface: a stiffness of -F/R across it
  kVoxelSteps,      ///< a force that steps where a point crosses into a voxel
  kEncoderSteps,
  kForceLimit,  ///< of the device
};
/// "damper_gate", "damper_bound", "velocity_band", "varying_timing", "between_corners",
/// "released_frictionless", "force_only_lever", "curved_contact", "voxel_steps", "encoder_steps",
/// "force_limit".
std::string_view name_of(CertificateGap gap) noexcept;

struct ContactCertificate {
  ContactClass contact = ContactClass::kNone;
  MonotoneProof proof = MonotoneProof::kNone;
  struct Axis {
    double stiffness = 0.0;  ///< K [N/m; Nm/rad]: any contact whose slope stays within [0, K];
                             ///< infinity: of any slope
    double margin = 0.0;  ///< K over what the design lets the contact have. Below 1 the certificate
                          ///< is not for all of that
  };
  std::vector<Axis> axes;  ///< translation; rotation, where the device gives torque
  double ratio_of_linear =
      0.0;  ///< K over the stiffness at which the same loops become unstable. 0: no multiplier
  int loops = 0;  ///< that the one multiplier serves
  Multiplier multiplier;
  std::vector<CertificateGap> gaps;
};

/// The certificate of `design`, which was made or judged for `request`. A design that is infeasible
/// has none. It takes 20 ms to 2 s, too long for the start of a ring.
ContactCertificate certify_contacts(const DesignProblem& request, const Design& design);

/// Stiffness of each axis at which the first of the loops becomes unstable, with all of the
/// injected damping. For a spring-damper all of its law grows with it.
std::vector<double> linear_limits(const DesignProblem& request, const CouplingSpec& spec);
/// The same loops, each with contacts of up to `stiffness` of its axis.
std::vector<ContactLoop> contact_loops(const DesignProblem& request, const CouplingSpec& spec,
                                       std::span<const double> stiffness);

}  // namespace voxtouch::coupling::design
