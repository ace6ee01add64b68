#pragma once
/// Fits the coupling to device, scene and contact, at the start of a session and when device or
/// contact change.
#include <cstdint>
#include <future>
#include <optional>
#include <utility>

#include "core/device_fit/fit_coupling.hpp"
#include "core/device_fit/force_preview.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::coupling_node {

/// Collects the inputs of a fit from the latched messages and computes it. One thread. The
/// rendering also fits; see device_fit::DeviceCompatibility for the reason.
class Fitting {
 public:
  explicit Fitting(const scene::Scene& scene) : scene_(scene) {}

  void set_device(const DeviceDescription& device, std::uint64_t session);
  void set_plan(const msg::ScenePlan& plan);
  /// Session of both messages, if they name the same.
  std::optional<std::uint64_t> session() const noexcept;
  /// Returns true once after either message has arrived.
  bool changed() noexcept { return std::exchange(changed_, false); }
  /// Whether device or contact differ from those of the last fit.
  bool outdated() const noexcept { return outdated_; }

  /// Fits in this thread; takes some tenths of a second at most.
  device_fit::FittedCoupling fit();
  /// Fits in another thread. A request during a fit is served after it.
  void begin();
  /// Returns the result of `begin` once, validated for the current device and contact. Never
  /// blocks.
  std::optional<device_fit::FittedCoupling> poll();
  /// Returns why `fitted` must not run on this device with these effects, or an empty text.
  device_fit::Refusal judge(const device_fit::FittedCoupling& fitted) const;
  std::optional<device_fit::ForcePreview> preview(const device_fit::FittedCoupling& fitted) const {
    return device_fit::force_preview(fitted, scene_, device_, bounds_);
  }

  const coupling::design::DeviceModel& device() const noexcept { return device_; }
  double voxel_size_m() const noexcept { return voxel_size_m_; }  ///< of the plan
  /// Name of the effect that no certificate covers; empty if there is none.
  const std::string& external() const noexcept { return demand_.external.name; }

 private:
  const scene::Scene& scene_;
  coupling::design::DeviceModel device_;
  rendering::StiffnessBounds bounds_;  ///< in W
  device_fit::SceneRequirements demand_;
  double voxel_size_m_ = 0.0;
  std::optional<std::uint64_t> device_session_, plan_session_;
  bool changed_ = false, outdated_ = false, again_ = false;
  std::future<device_fit::FittedCoupling> pending_;
};

}  // namespace voxtouch::coupling_node
