#pragma once
/// The loop on walls in closed form instead of a scene: series spring, coupling, gate, guard,
/// device and hand are the classes that ship.
#include <memory>
#include <optional>
#include <vector>

#include "core/coupling/design/designer.hpp"
#include "core/coupling/running_coupling.hpp"
#include "core/rendering/series_spring.hpp"
#include "devices/force_guard.hpp"
#include "devices/sim/simulated_device.hpp"

namespace voxtouch::long_runs {

/// A half-space that repels a point of the tool along `normal` (unit, W).
struct LoopWall {
  Vec3 normal = Vec3::UnitZ();
  double at_m = 0.0;  ///< it begins at normal . x = at_m
  double n_per_m = 0.0;
  double knee_m = 1e9, beyond = 1.0;  ///< deeper than the knee the slope is so many times itself
  Vec3 arm = Vec3::Zero();            ///< of the point, in T [m]
  double texture_m = 0.0,
         texture_per_m = 0.0;  ///< height of waves along x, and 2 pi over their length
};

struct WallLoopOptions {
  sim::SimParameters device;       ///< simulation parameters
  DeviceDescription designed_for;  ///< as the coupling is designed for it
  sim::OperatorConfig hand;
  Motion motion;
  std::vector<LoopWall> walls;
  std::string kind = "auto";
  double times_promise = 1.0;  ///< the spring's stiffness divided by the certified one
  double loss = 0.0;           ///< chance that a command is lost
  bool late = false;           ///< a command may arrive a period late, at random
  bool virtual_tool = false;   ///< the spring alone: as if the walls were rigid
  std::uint64_t seed = 0;
};

/// The coupling for a device with contacts of any stiffness.
coupling::design::Design design_for(const DeviceDescription& device, const std::string& kind);

class WallLoop {
 public:
  /// `design`: of `design_for` these options.
  WallLoop(const WallLoopOptions& options, const coupling::design::Design& design);
  /// One period. Returns the force given to the device.
  const Wrench& step() noexcept;

  const sim::SimulatedDevice& device() const noexcept { return *device_; }
  const devices::ForceGuard& guard() const noexcept { return guard_; }
  const coupling::CouplingCounters& counters() const noexcept { return coupling_.counters(); }
  const rendering::SeriesSpring& spring() const noexcept { return spring_; }

 private:
  rendering::ContactAt contact_at(const Pose& tool) noexcept;

  WallLoopOptions options_;
  coupling::RunningCoupling coupling_;
  rendering::SeriesSpring spring_;
  std::unique_ptr<sim::SimulatedDevice> device_;
  devices::ForceGuard guard_;
  devices::CommandGate gate_{1};
  std::optional<std::pair<std::uint64_t, devices::GuardInput>> late_;
  std::uint64_t sequence_ = 0, random_;
  std::int64_t last_ns_ = 0;
  double period_s_;
  Wrench given_;
  double coherence_ = 1.0;
};

}  // namespace voxtouch::long_runs
