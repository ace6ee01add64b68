#pragma once
/// A time-domain simulation of the loop with what the linear model leaves out: a contact that only pushes, quantised position,
/// jitter, lost samples, saturation, dry friction. One axis. It runs the very filter of the ring (core/coupling/pt2.hpp).
#include <cstdint>
#include <vector>

#include "core/coupling/design/sampled_loop.hpp"

namespace voxtouch {

enum class WallLaw : std::uint8_t { kBilateral, kUnilateral, kSoftening, kHardening };

/// Everything of one run. Zero is "none" for all that can be none.
struct NonlinearLoop {
  LoopPlant plant;
  LoopController controller;
  double contact_stiffness = 0.0;       ///< steepest slope of the wall
  WallLaw wall = WallLaw::kUnilateral;
  double resolution = 0.0;
  double coulomb_friction = 0.0;
  double max_effort = 0.0;              ///< 0: no saturation
  double jitter = 0.0;                  ///< periods uniformly within (1 +- jitter) T
  double delay_jitter_s = 0.0;          ///< added to the delay, uniformly
  double loss = 0.0;                    ///< chance that a sample is lost; its input is held and the filter goes on
  int most_lost_in_a_row = 3;
  bool damping_only_in_contact = false; ///< injected damping as the ring does it: in contact, never pulling
  double push = 0.0;                    ///< constant effort of the hand into the wall
  double start_speed = 0.0;             ///< into the wall
  double duration_s = 10.0;
  std::uint64_t seed = 0;
};

struct NonlinearVerdict {
  bool stable = false;          ///< the oscillation decays or stays below `quiet`
  double early_amplitude = 0.0, late_amplitude = 0.0;  ///< peak to peak, third and last quarter of the run
  double energy_extracted_j = 0.0;  ///< largest energy that the coupling has given to the hand, net
  double quiet = 0.0;           ///< amplitude that counts as rest
};

/// The same loop and seed give the same bits.
NonlinearVerdict simulate(const NonlinearLoop& loop);

}  // namespace voxtouch
