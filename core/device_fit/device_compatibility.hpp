#pragma once
/// The certificate of a scene that runs on a device, and what every change of it is judged by.
#include <optional>
#include <span>
#include <string>

#include "core/device_fit/fit_coupling.hpp"

namespace voxtouch::device_fit {

/// Fitted next to the coupling, by the same function and numbers, since a change is judged before a
/// coupling for it exists, and the spring must be known with the plan that the coupling's fit waits
/// for. One thread; a change of stiffness takes as long as a fit.
class DeviceCompatibility {
 public:
  /// A device has described itself, perhaps anew. `runs` follows: nothing is judged by the fit for
  /// another device.
  void set_device(const coupling::design::DeviceModel& device);
  /// What is rendered from now on: `bounds` in W, `contact_alone` without effects, and `displayed`,
  /// what it demands wherever its effects are on their way.
  void runs(const scene::Scene& scene, const rendering::StiffnessBounds& contact_alone,
            const rendering::StiffnessBounds& bounds, const SceneRequirements& displayed);
  /// Why what runs must not be displayed; empty: it may, or no device is known.
  const std::string& refusal() const noexcept { return refusal_; }

  /// Of a virtual tool, in W, under the coupling that runs [N/m]; 0 where no device is known.
  double spring_n_per_m() const noexcept { return spring_n_per_m_; }
  /// In series with a penalty contact, likewise; rigid where no device is known.
  const rendering::Compliance& series_spring() const noexcept { return series_; }

  /// Why `scene` with these effects must not follow what runs, the sentence of the start; empty: it
  /// may. Judged are the end and all states on the way there, on the coupling that runs and on the
  /// one that will be fitted. Where no force is commanded already, a change that demands no more
  /// than what runs may be made. Before a device is known everything may: `runs` reports then.
  std::string check(const scene::Scene& scene, const rendering::StiffnessBounds& contact_alone,
                    std::span<const effects::EffectReach> effects);

  /// Period of the device's samples [s]; nominally 1 ms where none is known.
  double period_s() const noexcept { return device_ ? device_->timing.period_s : 1e-3; }

 private:
  const FittedCoupling& fitted_for(const scene::Scene& scene,
                                   const rendering::StiffnessBounds& bounds);
  std::string judged(const FittedCoupling& fitted, const scene::Scene& scene,
                     const rendering::StiffnessBounds& bounds,
                     const SceneRequirements& demand) const;

  struct Fit {
    rendering::StiffnessBounds bounds;
    FittedCoupling coupling;
  };
  std::optional<coupling::design::DeviceModel> device_;
  std::optional<Fit> running_, next_;
  SceneRequirements displayed_;
  std::string refusal_;
  double spring_n_per_m_ = 0.0;
  rendering::Compliance series_;
};

}  // namespace voxtouch::device_fit
