#pragma once
/// A law with its input policy, for tests that need nothing else.
#include "core/coupling/running_coupling.hpp"

namespace voxtouch::coupling {

class LawAlone {
 public:
  LawAlone(const CouplingSpec& spec, const CouplingLimits& limits, double sample_time_s)
      : coupling_(spec, limits, sample_time_s),
        spec_(spec) {}

  Wrench step(const CouplingInput& input, double dt_s) noexcept {
    return (last_ = coupling_.step(input, dt_s)).wrench;
  }
  void reset(const Wrench& start) noexcept { coupling_.reset(start); }
  bool set(double cutoff_hz, double damping_ratio, double gain) {
    spec_.cutoff_hz = cutoff_hz, spec_.damping_ratio = damping_ratio, spec_.gain = gain;
    return coupling_.redesign(spec_);
  }
  double gain() const noexcept { return coupling_.gain(); }
  CouplingKind kind() const noexcept { return coupling_.kind(); }
  const CouplingOutput& status() const noexcept { return last_; }
  std::uint64_t faults() const noexcept { return coupling_.counters().faults; }

 private:
  RunningCoupling coupling_;
  CouplingSpec spec_;
  CouplingOutput last_;
};

}  // namespace voxtouch::coupling
