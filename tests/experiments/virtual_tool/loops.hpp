#pragma once
/// The virtual tool in a sampled loop, and what it says of torques: pegs and levers.
#include <string>

#include "rig.hpp"

namespace voxtouch::virtual_tool {

/// A mass that is pulled against a wall by a constant force and feels k d, a sample of 1 kHz late by `delay_s`.
struct LoopOptions {
  std::string scene = "plane";  ///< "linear": a wall in one dimension, k times depth
  double mass_kg = 0.045, damping_ns_per_m = 1.0, delay_s = 1e-3, pull_n = 0.8;
};
/// The largest k [N/m] for which a kick dies out, to 3 %.
double largest_stable_stiffness(const LoopOptions& options);

/// A bar pressed with its end on a block, the hand at its middle: torque over the exact one of force times arm.
struct LeverFigures {
  double torque_error = 0.0;  ///< worst, over the torque
  double step_over_torque = 0.0;
};
LeverFigures lever(double edge, std::uint64_t seed);

/// A peg of 10 mm let into a hole 20 mm deep, in line; then the hand goes 1.7 mm aside or turns by 2.9 degrees, and on 4 mm past the floor.
struct PegFigures {
  double short_m = 0.0;      ///< of the floor
  double drag_n = 0.0;       ///< along the hole on the way in
  double torque_error = 0.0; ///< hand turned about the hole's axis: torque there, which should be none [N m]
  bool entered = false;
};
PegFigures peg(double edge, double clearance_m, bool turned);

}  // namespace voxtouch::virtual_tool
