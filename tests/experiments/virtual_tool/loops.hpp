#pragma once
/// The virtual tool in a sampled loop, and its torques: pegs and levers.
#include <string>

#include "rig.hpp"

namespace voxtouch::virtual_tool {

/// A mass that is pulled against a wall by a constant force and feels k d, a sample of 1 kHz late
/// by `delay_s`.
struct LoopOptions {
  std::string scene = "plane";  ///< "linear": a wall in one dimension, k times depth
  double mass_kg = 0.045, damping_ns_per_m = 1.0, delay_s = 1e-3, pull_n = 0.8;
};
/// The largest k [N/m] for which a kick dies out, to 3 %.
double largest_stable_stiffness(const LoopOptions& options);

/// A round block with a round hole from above, mouth at z = 0: one closed mesh.
mesh::TriangleMesh hole_mesh(double radius_m, double deep_m);
inline constexpr double kPegRadius = 0.005, kPegHole = 0.02, kPegLong = 0.03;
/// So many that the facets of peg and hole lack 0.2 um of the exact ones' radius: 96 lack 2.7 um
/// each, which is play.
inline constexpr int kPegSides = 384;
mesh::TriangleMesh peg_mesh();

/// A tool's pose in the plane of x and z: displacement [m], and rotation about y [rad].
struct PlanePose {
  double x = 0.0, z = 0.0, turn = 0.0;
};
/// The exact bar. Its lower face, `below_m` under its origin, must be over the edge of a block at
/// `edge_at`. Of these poses it is the nearest to the hand: least displacement^2 + (lever angle)^2.
PlanePose exact_lever(const PlanePose& hand, const Vec3& edge_at, double below_m, double lever_m);
/// The same for the exact peg: its side is off the mouth's edge of a hole along z, and its lower
/// rim off the wall, at a positive angle.
PlanePose exact_pin(const PlanePose& hand, double hole_radius, double lever_m);

/// A bar pressed with its end on a block, the hand at its middle: torque over the exact one of
/// force times arm.
struct LeverFigures {
  double torque_error = 0.0;  ///< worst, over the torque
  double step_over_torque = 0.0;
};
LeverFigures lever(double edge, std::uint64_t seed);

/// A peg of 10 mm lowered 20 mm into a hole, aligned; then the hand moves 1.7 mm aside or rotates
/// by 2.9 degrees, and continues to 4 mm below the floor.
struct PegFigures {
  double short_m = 0.0;  ///< of the floor
  double drag_n = 0.0;   ///< along the hole during insertion
  bool entered = false;
};
PegFigures peg(double edge, double clearance_m, bool turned);

/// The same peg 15 mm deep in its hole, the hand rotated slowly across the hole's axis until the
/// peg touches mouth and wall: torque divided by that of the exact peg, which has its play and then
/// the spring.
struct PinFigures {
  double torque_error = 0.0;      ///< worst once the torque is a fifth of its last, over the torque
  double step_over_torque = 0.0;  ///< from frame to frame, over the last torque
  double torque_nm = 0.0;         ///< the exact one in the end
};
PinFigures pin(double edge, double clearance_m, double rotation_rad, std::uint64_t seed);

}  // namespace voxtouch::virtual_tool
