#pragma once
/// Initial settings of the simulated library, from its hooks or an environment variable.
#include <cstdint>
#include <string_view>

#include "core/types/motion.hpp"
#include "devices/phantom/simulated/models.hpp"
#include "devices/phantom/simulated/plant.hpp"
#include "devices/sim/operator.hpp"

namespace voxtouch::hd_sim {

struct Settings {
  const Model* model = find_model("premium");
  PlantConfig plant;
  sim::OperatorConfig hand = *hand::grip("pen");
  Motion motion{.path = {Vec3::Zero()}, .repeat_from = {}, .circle_centre = {}};
  std::uint64_t seed = 0;
  bool virtual_time = false;
  double hand_bandwidth_hz = hand::Hand::kBandwidthHz;
  double resolution_m = 0.03e-3;        ///< at the tip; data sheet from memory
  double gimbal_resolution_rad = 1e-3;  ///< this and the following: assumed
  double velocity_filter_hz = 50.0;
  double thermal_time_s = 60.0;  ///< of a motor
  double watchdog_s = 0.01;      ///< longest time that the amplifier holds its last value
  /// Deviation from right angles when the operator holds the links for a reset.
  Vec3 reset_error_rad = Vec3::Zero();
  Vec3 power_on_rad{0.3, -0.4, 0.2};  ///< positions of the three joints' encoders at power-on

  /// Sets a number by its name. Throws std::runtime_error with the valid names or the invalid
  /// value.
  void set(std::string_view name, double value);
};

/// Parses "virtual=1;model=omni;grip=pen-firm;seed=7;coulomb_nm=0.02": names of Settings::set, and
/// model, grip, seed, virtual. Throws std::runtime_error that quotes the invalid part.
void read_settings(Settings& settings, std::string_view text);

}  // namespace voxtouch::hd_sim
