#pragma once
/// The paper's coupling: each component of the contact's wrench through the same second-order low-pass (pt2.hpp).
#include <array>

#include "core/coupling/input_policy.hpp"
#include "core/coupling/pt2.hpp"

namespace voxtouch {

/// Fastest change of the gain at run time [1/s], counted in nominal periods.
inline constexpr double kGainSlewPerS = 1.0;

/// Force in, force out; K dimensionless, so that a held contact is given back times K exactly. Works in W: the axes of the
/// six components do not turn with the tool.
class ShapingFilter final : public Coupling {
 public:
  /// `spec` as `validate` accepts it; make_coupling checks.
  ShapingFilter(const CouplingSpec& spec, const CouplingLimits& limits, double sample_time_s,
                double ramp_s = kDefaultRampS) noexcept;

  CouplingKind kind() const noexcept override { return CouplingKind::kShapingFilter; }
  Wrench step(const CouplingInput& input, double dt_s) noexcept override;
  void reset(const Wrench& held) noexcept override;
  std::uint64_t faults() const noexcept override { return policy_.faults(); }
  CouplingStatus status() const noexcept override { return policy_.status(); }

  /// New parameters while running: cut-off and damping at once (the state cannot grow by it), the gain no faster than
  /// kGainSlewPerS. False, and nothing changed, for NaN, Inf, cutoff_hz or damping_ratio <= 0, gain < 0. Real-time safe.
  bool set(double cutoff_hz, double damping_ratio, double gain) noexcept;
  double gain() const noexcept { return gain_; }  ///< as it is now, on its way to the one that was set

 private:
  void rest_at(const Wrench& held) noexcept;

  InputPolicy policy_;
  double w0_, d_, gain_, gain_wanted_;
  std::array<Pt2State, 6> states_{};  // force x y z, torque x y z
  Wrench held_, given_;
};

}  // namespace voxtouch
