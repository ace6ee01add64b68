#pragma once
/// The steps of the designer, each in a source file of its own: validation, one proposal for each
/// kind of coupling, and the reasons of the result. The designer certifies a proposal and, if
/// needed, reduces it. Internal to this folder.
#include "core/coupling/design/filter_search.hpp"

namespace voxtouch::coupling::design {

/// Throws std::invalid_argument with the first error in device, hands, contact or goals.
void refuse_impossible(const DesignProblem& request);

struct Proposal {
  CouplingSpec spec;
  DesignStatus status = DesignStatus::kInfeasible;
  std::vector<WorstCase> worst;  ///< `critical_case` of each axis; empty for a spring-damper
};

/// Proposes the filter found by the search. The gain is kappa / all_points. With a free cap it is 1
/// as long as a single point fits, and the cap is kappa. Without a free cap, the caps are the
/// contact's own bounds. They do not act on force alone, but keep force and torque together below
/// both (see `axis_problems`).
Proposal propose_filter(const DesignProblem& request, const std::vector<AxisProblem>& problems);

/// Proposes no filter: the unchanged contact, with a cap if it is free. There is no gain, so
/// without a free cap the contact is displayed in full or not at all.
Proposal propose_direct(const DesignProblem& request, const std::vector<AxisProblem>& problems);

/// Proposes the stiffer of two pairs (c, r). One is the discrete Llewellyn optimum, valid for any
/// passive hand and environment. The other, if the range of hands is known, is the stiffest that is
/// stable in all its cases for a contact of any stiffness. The displayed stiffness stays below the
/// device's limit. The status is "as requested" if the series displays nine tenths of the target.
Proposal propose_spring_damper(const DesignProblem& request,
                               const std::vector<AxisProblem>& problems);

/// `spec` with its displayed stiffness times `factor`.
CouplingSpec shrunk(const DesignProblem& request, CouplingSpec spec, double factor);

/// The limiting factors.
std::vector<DesignReason> reasons_of(const DesignProblem& request,
                                     const std::vector<AxisProblem>& problems,
                                     const Design& design);

}  // namespace voxtouch::coupling::design
