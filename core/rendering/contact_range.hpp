#pragma once
/// Upper bounds of the contact stiffness of a tool ahead of any coupling: the range that a coupling
/// is designed for.
#include "core/contact/contact_model.hpp"
#include "core/rendering/plan.hpp"

namespace voxtouch::rendering {

/// Upper bounds for every pose, every contact model and every set S of points with force, along any
/// unit directions u_i. Not for the loop.
///
/// With K_i = K w_i and arms r_i the contact stiffness is
///
///     sum over S of K_i J_i' J_i,   J_i = [u_i', (r_i x u_i)']
///
/// Translation: max K_i for one point, sum K_i for all. `adapted` reaches it, since its points
/// share one direction.
///
/// Rotation about a unit axis a, with I the inertia tensor of masses K_i at the points:
///
///     sum K_i (u_i . (a x r_i))^2 <= sum K_i |a x r_i|^2 = a' I a
///
/// This gives max K_i |r_i|^2 for one point, and the largest eigenvalue of I for all.
///
/// `steepest`: largest rate at which depths change along a point's displacement. It is 1 for depths
/// below a plane. For `field` it is the largest gradient of its interpolation
/// (DistanceField::steepest_gradient). Its terms K_i |g_i| (Jn' Jn + Jh' Jh) / 2 (laws.md of
/// core/contact) are halves of such sums. An empty shell gives zeros.
StiffnessBounds contact_stiffness(const pointshell::Pointshell& shell,
                                  const contact::ContactParameters& parameters,
                                  double steepest = 1.0);

}  // namespace voxtouch::rendering
