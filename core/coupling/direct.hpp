#pragma once
/// The coupling that is none: what the other two are measured against.
#include "core/coupling/input_policy.hpp"

namespace voxtouch {

/// Contact straight to the device, under the same input policies.
class DirectCoupling final : public Coupling {
 public:
  DirectCoupling(const CouplingLimits& limits, double sample_time_s, double ramp_s = kDefaultRampS) noexcept
      : policy_(limits, sample_time_s, ramp_s) {}

  CouplingKind kind() const noexcept override { return CouplingKind::kDirect; }
  Wrench step(const CouplingInput& input, double dt_s) noexcept override;
  void reset(const Wrench& held) noexcept override;
  std::uint64_t faults() const noexcept override { return policy_.faults(); }
  CouplingStatus status() const noexcept override { return policy_.status(); }

 private:
  InputPolicy policy_;
  Wrench held_, given_;
};

}  // namespace voxtouch
