#pragma once
/// How fast the loop comes to rest, which is another question than whether it does: least damping
/// ratios of its slowest swing.
///
/// A case is one device in one hand with one timing (`design_cases`); its floor stands in
/// `DesignCase::least_damping_ratio`. A hand of which only passivity is known has none: among those
/// are masses that swing as long as they like.
#include <string>

#include "core/coupling/design/axis_verdict.hpp"
#include "core/coupling/design/designer.hpp"

namespace voxtouch::coupling::design {

/// As `spec` (at the hand, as `Design::spec`) makes the loop, at the stiffness that it shows. Some
/// milliseconds.
DominantMode dominant_mode(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                           const CouplingSpec& spec);

/// Gives each case of `problems` its floor by the request's goals. Out of reach is the floor of a
/// case that swings with less even in the softest useful contact and with the most damping that may
/// be injected. Where that is so for one hand, none has a floor: stiffness given up for the others
/// would not make the worst swing shorter; of released devices likewise. Returns the worst
/// that is out of reach, "Translation: held (0.2 kg, ...) swings with a damping ratio of 0.2 at
/// best"; empty where there is none. Some milliseconds.
std::string set_floors(const DesignProblem& request, std::vector<AxisProblem>& problems);

/// Whether all cases with a floor keep it, at the contact stiffness `contact` before `law` (of unit
/// gain).
bool keeps_floors(const AxisProblem& problem, const LoopController& law, double contact);
/// The same; asks the case `first` first, and leaves there the one that does not keep its floor,
/// which is likely not to keep it next time.
bool keeps_floors(const AxisProblem& problem, const LoopController& law, double contact,
                  std::size_t& first);
/// The same for all axes of what `spec` shows, its fraction `fraction` of it: a spring-damper with
/// all of its law, another with the contact.
bool keeps_floors(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                  const CouplingSpec& spec, double fraction = 1.0);

/// The stiffest contact up to `most` at which all floors are kept, to a four-thousandth of it; 0
/// where none is. For filter and direct.
double damped_stiffness(const AxisProblem& problem, const LoopController& law, double most);
/// The largest fraction of a spring-damper at which all floors are kept; likewise.
double damped_fraction(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                       const CouplingSpec& spec);

}  // namespace voxtouch::coupling::design
