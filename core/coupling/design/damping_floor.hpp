#pragma once
/// How fast the loop comes to rest: stable is not yet damped.
#include <string>

#include "core/coupling/design/designer.hpp"

namespace voxtouch::coupling::design {

/// Least damping ratio that the slowest swing of the loop in contact is to have, with nobody holding the device and with a hand.
struct DampingFloors {
  double released = 0.1, held = 0.3;
};

/// The least damping ratio of the slowest swing (`slowest_damping_ratio`) over the cases of a design, both kinds of motion and both timings.
struct SlowestSwing {
  double released = 1.0, held = 1.0;         ///< 1 where no case is of that kind
  std::string released_where, held_where;  ///< "Translation: held (0.2 kg, 0.5 Ns/m, 800 N/m), 0.08 kg", for a person
};
/// As `spec` (at the hand, as `Design::spec`) makes the loop, at the stiffness that it shows. Some milliseconds; throws as `judge_coupling`.
SlowestSwing slowest_swing(const DesignProblem& request, const CouplingSpec& spec);

/// What the floors would leave of a design.
struct DampedDesign {
  Design design;            ///< the same coupling with less stiffness, or as it was
  double cost_n_per_m = 0;  ///< of translation, at the hand
  /// The hand that swings with less than the floor by itself, at a hundredth of the stiffness as well, where no coupling that is softer
  /// helps: it is left out. Empty: there is none.
  std::string out_of_reach;
};
/// The stiffest share of `design` at which every case keeps its floor, down to what is useful at all; below that the floors stay unmet and
/// the design is as it was. Injected damping, cut-off and kind stay. Some tens of milliseconds; throws as `judge_coupling`.
DampedDesign with_floors(const DesignProblem& request, const Design& design, const DampingFloors& floors = {});

}  // namespace voxtouch::coupling::design
