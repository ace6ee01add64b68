#pragma once
/// The steps of the designer, each in a source of its own: what can be designed for at all, one
/// proposal for each kind of coupling (certified and shrunk, if need be, by the designer), and what
/// a person reads of the result. For this folder's own functions.
#include "core/coupling/design/filter_search.hpp"

namespace voxtouch::coupling::design {

/// Throws std::invalid_argument with the first sentence about what is wrong with device, hands,
/// contact or goals.
void refuse_impossible(const DesignProblem& request);

struct Proposal {
  CouplingSpec spec;
  DesignStatus status = DesignStatus::kInfeasible;
  std::vector<WorstCase> worst;  ///< `critical_case` of each axis; none of a spring-damper
};

/// The filter of the search; gain and caps by what holds: gain kappa / all_points, or with a free
/// cap gain 1 as long as one point alone fits, and the cap at kappa. Without a free cap the caps
/// stand at what the contact promises: they do not act on force alone, but keep force and torque
/// together below both (see `axis_problems`).
Proposal propose_filter(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                        CandidateCache& cache);

/// No filter: the contact as it is, with a cap where one is free. It has no gain: without a cap
/// that is free, all or nothing.
Proposal propose_direct(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                        CandidateCache& cache);

/// The stiffer of two pairs (c, r): the discrete Llewellyn optimum, good for any passive hand and
/// world; and, where the range of hands is known, the stiffest that holds on all its cases for a
/// contact of any stiffness. What is shown stays below the device's limit. As requested where the
/// series shows nine tenths of the target.
Proposal propose_spring_damper(const DesignProblem& request,
                               const std::vector<AxisProblem>& problems, CandidateCache& cache);

/// `spec` with all that it shows times `factor`.
CouplingSpec shrunk(const DesignProblem& request, CouplingSpec spec, double factor);

/// What limits, one sentence each.
std::vector<std::string> reasons_of(const DesignProblem& request,
                                    const std::vector<AxisProblem>& problems, const Design& design);

/// What the floors of the damping ratio cost, and how to have it back; empty where they cost
/// nothing.
std::string floors_cost(const std::vector<AxisProblem>& problems, const Design& design);

/// What would give the goal as it is: device damping, a shorter delay, a cap, a grip. Each was
/// tried by the same certificates, with everything else unchanged. Empty where the goal is met.
std::vector<std::string> remedies_of(const DesignProblem& request,
                                     const std::vector<AxisProblem>& problems,
                                     const Design& design);

}  // namespace voxtouch::coupling::design
