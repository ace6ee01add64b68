#pragma once
/// How much energy a source that no certificate covers may give the hand: a store that is emptied by what it gives.
#include <algorithm>

namespace voxtouch::effects {

/// A store of energy as two-layer teleoperation has it (Franken et al. 2011), for a source that may react to the pose. It gives at most
/// what is in the store, which holds `most_j`, and gets `refill_w` back in time, and what the hand puts in. So in any time t it gives the hand at most
/// most_j + refill_w t. Energies are those of forces in W along ways in W [J]. Real-time safe.
class EnergyBudget {
 public:
  /// `given_j`: what the source has given since the last call, below 0: what it took. `most_j` > 0.
  void book(double given_j, double most_j, double refill_w, double dt_s) noexcept {
    if (!begun_) level_j_ = most_j, begun_ = true;
    level_j_ = std::min(most_j, level_j_ - given_j + refill_w * dt_s);
  }
  /// Share of its force that the source may have: 1 down to half of the store, then falling to 0 with what is left, so that no period takes
  /// more than there is while its way is shorter than most_j / (2 force).
  double share(double most_j) const noexcept {
    if (!begun_) return 1.0;
    return std::clamp(level_j_ / (kFullAbove * most_j), 0.0, 1.0);
  }

 private:
  static constexpr double kFullAbove = 0.5;
  double level_j_ = 0.0;
  bool begun_ = false;
};

}  // namespace voxtouch::effects
