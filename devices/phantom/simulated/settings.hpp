#pragma once
/// What the simulated library starts from: set by its hooks or by an environment variable.
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
  double gimbal_resolution_rad = 1e-3;  ///< this and the rest: assumed
  double velocity_filter_hz = 50.0;
  double thermal_time_s = 60.0;  ///< of a motor
  double watchdog_s = 0.01;      ///< the amplifier holds its last value this long at most
  Vec3 reset_error_rad =
      Vec3::Zero();  ///< how far from right angles the operator holds the links when they are reset
  Vec3 power_on_rad{0.3, -0.4, 0.2};  ///< where the encoders of the three joints stood at power-on

  /// Sets a number by its name. Throws std::runtime_error that lists the names, or names the value
  /// that cannot be.
  void set(std::string_view name, double value);
};

/// Reads "virtual=1;model=omni;grip=pen-firm;seed=7;coulomb_nm=0.02": names of Settings::set, and
/// model, grip, seed, virtual. Throws std::runtime_error that quotes what it could not read.
void read_settings(Settings& settings, std::string_view text);

}  // namespace voxtouch::hd_sim
