#pragma once
/// The coupling that a scene runs with on a device: designed where the scene asks for that, set by hand and judged where not.
#include <string>

#include "core/coupling/design/designer.hpp"
#include "core/scene/hand_ranges.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch {

struct FittedCoupling {
  CouplingSpec spec;      ///< what to run, in W
  Design design;          ///< at the hand: what was found, or the judgement of what was set by hand
  bool designed = false;  ///< false: set by hand in the scene
  std::string refusal;    ///< why it must not run, a sentence with what to do; empty: it may
};

/// `translation` [N/m] and `rotation` [Nm/rad about the tool's origin]: what the scene's contact can show, in W. The same arguments
/// give the same bits. Some milliseconds to some tenths of a second; not for the loop. Numbers that nothing can be designed for (a
/// device without mass, say) come back as a refusal.
FittedCoupling fit_coupling(const Scene& scene, const DeviceModel& device, Grip grip, const ContactRange& translation,
                            const ContactRange& rotation);

/// Stiffness [N/m] at the hand where the contact's bound is `bound_n_per_m` in W: what the coupling lets through, times both scales.
double stiffness_at_hand_n_per_m(const FittedCoupling& fitted, const DeviceSpec& device, double bound_n_per_m) noexcept;

}  // namespace voxtouch
