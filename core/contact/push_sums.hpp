#pragma once
/// What the force laws sum up over the hits of a frame: block by block, each product for all hits of a block at once, and then
/// added in the hits' order, so that the bits are those of a plain loop over the hits.
#include <cstddef>

#include "core/contact/contact_model.hpp"
#include "core/contact/stiffness_sum.hpp"

namespace voxtouch::contact {

/// The way a point pushes: u_i = s m + (1 - s) n_i, brought to unit length (contact_limits::kShortestDirection); n_i itself for
/// s = 0.
struct PushDirection {
  Vec3 mean = Vec3::Zero();  ///< m
  double mean_share = 0.0;   ///< s in [0, 1)
};

/// Adds the pushes of the hits [begin, end) along their own directions, d_i = max(0, u_i . (c_i - x_i)): to `result` the wrench,
/// the deepest point (the first of equals) and the stiffness bound, to `sum` those that push. `tool`: its origin in W.
void push_along_directions(const Hits& hits, std::size_t begin, std::size_t end, const PushDirection& direction, double stiffness,
                           const Vec3& tool, ContactResult& result, StiffnessSum& sum) noexcept;

/// All hits along the common direction `mean`; sets wrench and stiffness, and adds as above.
void push_along_mean(const Hits& hits, const Vec3& mean, double stiffness, const Vec3& tool, ContactResult& result) noexcept;

/// Goes on with sums of weight * normal and of weights.
void add_normals(const Hits& hits, Vec3& normals, double& weights) noexcept;

/// Begins a result with what every model tells alike: the counts, and whether the pose could be looked up.
void begin_result(const HitList& hits, ContactResult& result) noexcept;

/// Coherence and mean normal from such sums.
void tell_mean_normal(const Vec3& normals, double weights, ContactResult& result) noexcept;

}  // namespace voxtouch::contact
