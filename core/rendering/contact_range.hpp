#pragma once
/// The stiffness that a tool's contact can show at most, before any coupling: what a coupling has
/// to be designed for.
#include "core/contact/contact_model.hpp"
#include "core/pointshell/shell_levels.hpp"
#include "core/rendering/plan.hpp"

namespace voxtouch::rendering {

/// Upper bounds for every pose, every contact model and every set S of points that push, whatever
/// unit directions u_i they push along (also those that the stage holds). With K_i = K w_i for
/// point i (its weight w_i is one, or its area) and arms r_i the contact is sum_S K_i J_i' J_i, J_i
/// = [u_i', (r_i x u_i)']:
///
///  - translation: a' (sum K_i u_i u_i') a <= sum_S K_i, so max K_i alone and sum K_i together.
///  `adapted` reaches it, since
///    its points share one direction, and points retained in a wall can be all of them: nothing
///    smaller holds for all poses.
///  - rotation about a unit axis a: sum K_i (a . (r_i x u_i))^2 = sum K_i (u_i . (a x r_i))^2 <=
///  sum K_i |a x r_i|^2
///    = a' I a, with I the inertia tensor of masses K_i at the points. So max K_i |r_i|^2 alone,
///    and the largest eigenvalue of I together; that is at most sum K_i |r_i|^2 (its trace is twice
///    that sum, and no eigenvalue exceeds the sum of the other two), and two thirds of it for a
///    ball.
///
/// `steepest`: largest rate at which the depths of the points change on their way, 1 where they are
/// depths below a plane; for `field` the largest gradient of its interpolation
/// (DistanceField::steepest_gradient). Its K_i |g_i| (Jn' Jn + Jh' Jh) / 2 (field_model.hpp) are
/// the sums above for two sets of unit directions, halved, with K_i |g_i| <= K_i steepest.
///
/// `levels`: of a shell whose points may be left out for a time budget; none: they are not. All
/// that are asked weigh together what all points weigh, so the first sum stays; one may weigh what
/// it does at the coarsest level. Where q stands for p, p's part of the inertia is that of q at
/// most: | |a x q|^2 - |a x p|^2 | <= |q - p| (|q| + |p|), the most of it over all that may stand
/// for p.
///
/// An empty shell gives zeros. Not for the loop.
StiffnessBounds contact_stiffness(const pointshell::Pointshell& shell,
                                  const contact::ContactParameters& parameters,
                                  double steepest = 1.0,
                                  const pointshell::ShellLevels& levels = {});

}  // namespace voxtouch::rendering
