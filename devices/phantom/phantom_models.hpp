#pragma once
/// What a Phantom does not report about itself, by its model's name, and the description made of
/// both.
#include <string>
#include <string_view>

#include "devices/driver.hpp"

namespace voxtouch::phantom {

/// What an opened device reported. Our units; zero where it reported nothing.
struct PhantomFacts {
  std::string model;     ///< as the library calls it
  std::string serial{};  ///< empty: the library reports none
  double rate_hz = 0.0;
  double max_force_n = 0.0, continuous_force_n = 0.0;
  double max_torque_nm = 0.0;
  double max_stiffness_n_per_m = 0.0;
  double max_impulse_n_per_s = 0.0;  ///< change of force that makes the device drop it
  int input_dof = 6, output_dof = 3;
  int temperatures = 0;  ///< motors whose temperature can be read
};

struct PhantomFigures {
  std::string_view prefix;  ///< of the model's name, without regard to capitals
  double max_force_n, continuous_force_n, max_stiffness_n_per_m;
  double mass_min_kg, mass_max_kg, coulomb_friction_n, position_resolution_m;
};
/// The row with the longest prefix that fits; one for unknown models otherwise.
const PhantomFigures& phantom_figures(std::string_view model) noexcept;

/// What the device said where it said something, the figures elsewhere. Stiffness: the smaller of
/// the two, since the device's figure is that of its structure, which no sampled wall reaches.
DeviceDescription describe_phantom(const PhantomFacts& facts);

/// The continuous force: what the device said, or the figure, and no more than the maximum [N].
double continuous_force_n(const PhantomFacts& facts) noexcept;

/// The rate that a servo loop can have which is nearest to a measured one [Hz]; 1000 where that is
/// no rate at all.
double servo_rate_hz(double measured_hz) noexcept;

}  // namespace voxtouch::phantom
