#pragma once
/// The stiffness that a tool's contact can show at most, before any coupling: what a coupling has
/// to be designed for.
#include "core/contact/contact_model.hpp"
#include "core/rendering/plan.hpp"

namespace voxtouch::rendering {

/// Upper bounds for every pose, every contact model and every set S of points that push, whatever
/// unit directions u_i they push along. With K_i = K w_i and arms r_i the contact is sum_S K_i J_i'
/// J_i, J_i = [u_i', (r_i x u_i)']:
///
///  - translation: max K_i by one point, sum K_i by all. `adapted` reaches it, since its points
///  share one direction.
///  - rotation about a unit axis a: sum K_i (u_i . (a x r_i))^2 <= sum K_i |a x r_i|^2 = a' I a,
///  with I the inertia tensor of masses K_i at the
///    points: max K_i |r_i|^2 by one point, the largest eigenvalue of I by all.
///
/// `steepest`: largest rate at which depths change along a point's displacement: 1 for depths below
/// a plane, for `field` the largest gradient of its interpolation
/// (DistanceField::steepest_gradient), whose K_i |g_i| (Jn' Jn + Jh' Jh) / 2 (laws.md of
/// core/contact) are halves of such sums.
///
/// An empty shell gives zeros. Not for the loop.
StiffnessBounds contact_stiffness(const pointshell::Pointshell& shell,
                                  const contact::ContactParameters& parameters,
                                  double steepest = 1.0);

}  // namespace voxtouch::rendering
