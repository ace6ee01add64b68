#pragma once
/// The device's process: samples out, commands in, the force guard between them and the hardware.
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
  std::filesystem::path device_file;  ///< measured figures of the device; empty: the driver's own
  std::string motion;       ///< of the scene; empty: the hand rests where the first motion starts
  double duration_s = 0.0;  ///< of the device's time; 0: until stopped
  HandChoice hand;          ///< of a simulated device
  std::vector<std::string> settings;  ///< KEY=VALUE, as the device knows them
  double network_delay_ms = 0.0;      ///< that the coupling is designed for, there and back
  std::filesystem::path
      fault_records;  ///< folder for what was seen before a fault; empty: nothing is kept
};

/// --device, --device-option, --motion, --duration [s] and how a simulated hand holds the device.
void add_device_options(CLI::App& app, Options& options);

/// The hand's motion, in W, as the scene gives it; rest at the first way point where `name` is
/// empty. Throws where the scene has no such motion, naming those it has.
Motion choose_motion(const scene::Scene& scene, const std::string& name);

/// Runs until `stop`, the duration's end or a fault; the device is at zero force when this returns.
/// 0 if all went well. Throws while starting only.
int run(const Options& options, const std::atomic<bool>& stop);

}  // namespace voxtouch::device_node
