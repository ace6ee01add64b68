#pragma once
/// Sums of the force laws over the hits of a frame: block by block, in lanes (penalty_kernel.hpp),
/// bit-identical on every processor.
#include <cstddef>

#include "core/contact/contact_model.hpp"
#include "core/contact/penalty_kernel.hpp"
#include "core/contact/stiffness_sum.hpp"

namespace voxtouch::contact {

/// Adds the forces of all hits along their own directions, d_i = max(0, u_i . (c_i - x_i)).
/// `result` receives the wrench, the deepest point (the first of equals) and the stiffness bound,
/// `sum` the stiffness of the hits with force. `tool`: its origin in W.
void add_forces_along_directions(const Hits& hits, const ForceDirection& direction,
                                 double stiffness, const Vec3& tool, ContactResult& result,
                                 StiffnessSum& sum) noexcept;

/// All hits along the common direction `mean`; sets wrench and stiffness, and adds the rest as
/// above.
void add_forces_along_mean(const Hits& hits, const Vec3& mean, double stiffness, const Vec3& tool,
                           ContactResult& result) noexcept;

/// For other laws: the hits of a list from `begin` on, as many as fit into a block.
void fill_block(const PenaltyKernel& kernel, const Hits& hits, std::size_t begin,
                HitBlock& block) noexcept;
/// Sum of all eight lanes, combined in halves as wide registers are.
inline double combined(const double (&lanes)[kLanes]) noexcept {
  return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) +
         ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}
/// Adds the lane sums of `hits` to the result and to `sum`.
void add_lanes(const Hits& hits, const PenaltyLanes& lanes, double stiffness, const Vec3& tool,
               ContactResult& result, StiffnessSum& sum) noexcept;

/// Initialises a result with the values common to all models: counts and pose status.
void begin_result(const HitList& hits, ContactResult& result) noexcept;

/// Sets coherence and mean normal from these sums.
void set_mean_normal(const Vec3& normals, double weights, ContactResult& result) noexcept;

}  // namespace voxtouch::contact
