#pragma once
/// The device process: publishes samples, receives commands, and guards the force to the hardware.
#include <atomic>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "nodes/device/hand_options.hpp"
#include "nodes/runtime/options.hpp"

namespace CLI {
class App;
}

namespace voxtouch::device_node {

struct Options : runtime::NodeOptions {
  std::string device = "sim-phantom";
  /// Measured figures of the device; empty: those of the driver.
  std::filesystem::path device_file;
  /// Name of a motion in the scene; empty: rest at the start of the first motion.
  std::string motion;
  double duration_s = 0.0;              ///< in device time [s]; 0: until stopped
  HandChoice hand;                      ///< operator of a simulated device
  std::vector<std::string> settings;    ///< KEY=VALUE, as defined by the device
  double network_delay_ms = 0.0;        ///< round-trip delay that the coupling is designed for
  std::filesystem::path fault_records;  ///< folder for records of faults; empty: no records
};

/// Adds the options for the fields of Options.
void add_device_options(CLI::App& app, Options& options);

/// The operator's motion, in W, as the scene defines it. An empty `name` gives rest at the first
/// way point. Throws for an unknown motion, with the names of the scene's motions.
Motion choose_motion(const scene::Scene& scene, const std::string& name);

/// Runs until `stop`, the end of the duration or a fault. The device is at zero force on return.
/// Returns 0 on success. Throws only during start-up.
int run(const Options& options, const std::atomic<bool>& stop);

}  // namespace voxtouch::device_node
