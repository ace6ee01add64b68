#pragma once
/// The whole ring as function calls: device, scene, coupling, gate and guard, one sample after the
/// other, without DDS, clock or thread. The caller simulates the wire.
#include <filesystem>
#include <memory>
#include <optional>

#include "core/coupling/clutch_fade.hpp"
#include "core/coupling/running_coupling.hpp"
#include "core/rendering/live_scene.hpp"
#include "devices/force_guard.hpp"
#include "devices/sim/simulated_device.hpp"

namespace voxtouch::long_runs {

struct RigOptions {
  std::filesystem::path scene;                     ///< a scene file
  std::optional<contact::ContactModelKind> model;  ///< instead of the scene's
  sim::SimParameters device = sim::sim_phantom();
  std::optional<DeviceDescription> designed_for =
      {};  ///< replaces the device's description: the coupling is fitted to it
  std::optional<sim::OperatorConfig> hand;  ///< instead of the device's usual one
  std::string motion;                       ///< of the scene
  std::optional<Motion> path;               ///< in W, instead of a motion of the scene
  double stiffness_times = 1.0;             ///< of the scene's contact
  std::uint64_t seed = 0;
};

/// A scene and the coupling designed for it: the state of rendering and coupling node.
class RigFront {
 public:
  RigFront(const scene::Scene& scene, std::unique_ptr<rendering::BuiltScene> built,
           const coupling::CouplingSpec& spec, const coupling::CouplingLimits& limits,
           double period_s, double spring_n_per_m, const rendering::Compliance& series);
  /// One sample of the device answered, in D. Real-time safe.
  Wrench answer(const devices::DeviceSample& sample) noexcept;

  const coupling::CouplingOutput& out() const noexcept { return out_; }  ///< of the last sample
  const rendering::SceneFrame& frame() const noexcept { return frame_; }
  const coupling::CouplingCounters& counters() const noexcept { return coupling_.counters(); }
  const coupling::EnergyAccounts& energy() const noexcept { return coupling_.energy(); }
  /// Replaces the running scene, as a reload does. Not during a fade.
  void swap_to(std::unique_ptr<rendering::BuiltScene> next);

 private:
  scene::WorkspaceMapping device_;
  std::unique_ptr<rendering::BuiltScene> built_, old_;
  rendering::LiveScene live_;
  coupling::RunningCoupling coupling_;
  rendering::DeviceMapping mapping_;
  double period_s_;
  std::optional<std::int64_t> begin_ns_, last_ns_;
  rendering::SceneFrame frame_;
  coupling::CouplingOutput out_;
  coupling::ClutchFade clutch_;
};

class LoopRig {
 public:
  /// A command in transit.
  struct Command {
    std::uint64_t sequence = 0;
    devices::GuardInput input;
  };
  /// Throws as loading, building and designing do.
  explicit LoopRig(const RigOptions& ask);

  /// The device's next sample, and its number.
  const devices::DeviceSample& read() noexcept;
  std::uint64_t sequence() const noexcept { return sequence_; }
  Command answer(const devices::DeviceSample& sample, std::uint64_t sequence) noexcept;
  /// A command reaches the device: the newest one accepted by the gate is used in the next
  /// `finish`.
  devices::GateVerdict arrive(const Command& command) noexcept;
  /// Ends the period: guard, driver. Returns the force given to the device.
  const Wrench& finish() noexcept;
  /// A period on a wire that does nothing.
  const Wrench& step() noexcept;

  RigFront& front() noexcept { return *front_; }
  const RigFront& front() const noexcept { return *front_; }
  /// Another front with the same scene and design, as new.
  std::unique_ptr<RigFront> fresh_front() const;
  /// The scene once more, its contact `stiffness_times` as stiff as in the file.
  std::unique_ptr<rendering::BuiltScene> build_again(double stiffness_times) const;
  sim::SimulatedDevice& device() noexcept { return *device_; }
  const devices::ForceGuard& guard() const noexcept { return guard_; }
  const coupling::CouplingSpec& spec() const noexcept { return spec_; }
  const DeviceDescription& device_description() const noexcept { return ask_.device.description; }
  const rendering::Compliance& series_spring() const noexcept { return series_; }
  double spring_n_per_m() const noexcept {
    return spring_n_per_m_;
  }  ///< of a virtual tool, in W; 0 without one
  std::uint64_t refused_writes() const noexcept { return refused_writes_; }

 private:
  RigOptions ask_;
  scene::Scene scene_;
  coupling::CouplingSpec spec_;
  coupling::CouplingLimits limits_;
  double spring_n_per_m_ = 0.0;
  rendering::Compliance series_;
  std::unique_ptr<RigFront> front_;
  std::unique_ptr<sim::SimulatedDevice> device_;
  devices::ForceGuard guard_;
  devices::CommandGate gate_{1};
  devices::DeviceSample sample_;
  std::optional<devices::GuardInput> arrived_;
  Wrench given_;
  std::uint64_t sequence_ = 0, next_ = 0, refused_writes_ = 0;
};

/// Resident memory of this process, and the used part of its heap [bytes]: memory freed while
/// building stays resident and would hide a small leak. The second is zero under a sanitiser with
/// its own heap.
struct Memory {
  std::int64_t resident = 0, heap = 0;
};
Memory memory_in_use();
/// CPU time of this thread [s].
double thread_seconds();

}  // namespace voxtouch::long_runs
