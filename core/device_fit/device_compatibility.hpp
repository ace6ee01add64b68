#pragma once
/// The certificate of a running scene on a device, and the check of each change.
#include <optional>
#include <span>

#include "core/device_fit/fit_coupling.hpp"

namespace voxtouch::device_fit {

/// The rendering fits the coupling by the same function and values as the coupling node: it checks
/// a change before the coupling node receives it, and needs the spring for its plan. One thread; a
/// change of stiffness takes as long as a fit.
class DeviceCompatibility {
 public:
  /// Sets a new description of the device. Call `runs` next: the fit for another device is not
  /// used.
  void set_device(const coupling::design::DeviceModel& device);
  /// Sets the running scene: `bounds` in W, `contact_alone` without effects, and `displayed`, its
  /// largest requirements while effects change.
  void runs(const scene::Scene& scene, const rendering::StiffnessBounds& contact_alone,
            const rendering::StiffnessBounds& bounds, const SceneRequirements& displayed);
  /// The reason if the running scene must not be displayed; empty if it may, or without a device.
  const Refusal& refusal() const noexcept { return refusal_; }

  /// Spring of a virtual tool in W with the running coupling [N/m]; 0 without a device.
  double spring_n_per_m() const noexcept { return spring_n_per_m_; }
  /// Spring in series with a penalty contact; rigid without a device.
  const rendering::Compliance& series_spring() const noexcept { return series_; }

  /// The reason if `scene` with these effects must not replace the running one; else empty. Checks
  /// the end state and all states on the path to it, with the running coupling and with the one
  /// that will be fitted. If no force is commanded, a change with smaller requirements is accepted.
  /// Without a device all changes are accepted; `runs` checks later.
  Refusal check(const scene::Scene& scene, const rendering::StiffnessBounds& contact_alone,
                std::span<const effects::EffectReach> effects);

  /// Period of the device's samples [s]; 1 ms without a device.
  double period_s() const noexcept { return device_ ? device_->timing.period_s : 1e-3; }

 private:
  const FittedCoupling& fitted_for(const scene::Scene& scene,
                                   const rendering::StiffnessBounds& bounds);
  Refusal judged(const FittedCoupling& fitted, const scene::Scene& scene,
                 const rendering::StiffnessBounds& bounds, const SceneRequirements& demand) const;

  struct Fit {
    rendering::StiffnessBounds bounds;
    FittedCoupling coupling;
  };
  std::optional<coupling::design::DeviceModel> device_;
  std::optional<Fit> running_, next_;
  SceneRequirements displayed_;
  Refusal refusal_;
  double spring_n_per_m_ = 0.0;
  rendering::Compliance series_;
};

}  // namespace voxtouch::device_fit
