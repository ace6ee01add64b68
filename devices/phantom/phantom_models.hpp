#pragma once
/// Figures of a Phantom that it does not report itself, by model name, and the description from
/// both sources.
#include <string>
#include <string_view>

#include "devices/driver.hpp"

namespace voxtouch::phantom {

/// Properties reported by an opened device, in SI units; zero if not reported.
struct PhantomFacts {
  std::string model;     ///< as named by the library
  std::string serial{};  ///< empty: the library reports none
  double rate_hz = 0.0;
  double max_force_n = 0.0, continuous_force_n = 0.0;
  double max_torque_nm = 0.0;
  double max_stiffness_n_per_m = 0.0;
  double max_impulse_n_per_s = 0.0;  ///< change of force at which the device drops it
  int input_dof = 6, output_dof = 3;
  int temperatures = 0;  ///< number of motors with readable temperature
};

struct PhantomFigures {
  std::string_view prefix;  ///< of the model's name, case-insensitive
  double max_force_n, continuous_force_n, max_stiffness_n_per_m;
  double mass_min_kg, mass_max_kg, coulomb_friction_n, position_resolution_m;
};
/// The row with the longest matching prefix, or one for unknown models.
const PhantomFigures& phantom_figures(std::string_view model) noexcept;

/// Reported properties take precedence over the figures. Stiffness: the smaller of the two, since
/// the device reports that of its structure, which no sampled wall reaches.
DeviceDescription describe_phantom(const PhantomFacts& facts);

/// The continuous force, reported or from the figures, at most the maximum [N].
double continuous_force_n(const PhantomFacts& facts) noexcept;

/// The possible servo rate nearest to a measured one [Hz]; 1000 for an invalid measurement.
double servo_rate_hz(double measured_hz) noexcept;

}  // namespace voxtouch::phantom
