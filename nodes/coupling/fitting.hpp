#pragma once
/// Which coupling runs: fitted to device, scene and contact when a session begins, and again when
/// device or contact change.
#include <cstdint>
#include <future>
#include <optional>
#include <utility>

#include "core/fitting/fit_coupling.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::coupling_node {

/// Collects from the latched messages what a fit needs, and makes it. One thread owns it.
class Fitting {
 public:
  explicit Fitting(const scene::Scene& scene) : scene_(scene) {}

  /// As it was told for this session.
  void set_device(const DeviceDescription& device, std::uint64_t session);
  /// As the rendering has told it.
  void set_plan(const msg::ScenePlan& plan);
  /// The device's session, once device and rendering both have spoken of it.
  std::optional<std::uint64_t> session() const noexcept;
  /// True once after either message came.
  bool changed() noexcept { return std::exchange(changed_, false); }
  /// Whether what came calls for another fit: another device or contact, not only other effects.
  bool outdated() const noexcept { return outdated_; }

  /// Takes up to some tenths of a second.
  fitting::FittedCoupling fit();
  /// The same in a thread of ordinary priority, while the ring runs. A request that comes during a
  /// fit is made after it.
  void begin();
  /// The result of `begin`, once, judged for what has come meanwhile; never waits.
  std::optional<fitting::FittedCoupling> poll();
  /// Why `fitted` must not run (any more) on the device and for the effects as they were last told;
  /// empty: it may.
  std::string judge(const fitting::FittedCoupling& fitted) const;

  const coupling::design::DeviceModel& device() const noexcept { return device_; }
  /// Name of the effect that no certificate covers, as the plan was last told; empty: there is
  /// none.
  const std::string& external() const noexcept { return demand_.external.name; }

 private:
  const scene::Scene& scene_;
  coupling::design::DeviceModel device_;
  rendering::StiffnessBounds bounds_;  ///< in W
  fitting::DeviceDemand demand_;
  std::optional<std::uint64_t> device_session_, plan_session_;
  bool changed_ = false, outdated_ = false, again_ = false;
  std::future<fitting::FittedCoupling> under_way_;
};

}  // namespace voxtouch::coupling_node
