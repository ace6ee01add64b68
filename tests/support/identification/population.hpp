#pragma once
/// Random devices, the results of their identification, and a table of both.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/identification/device_session.hpp"
#include "tests/support/identification/identified_axis.hpp"

namespace voxtouch::testing {

enum class Family : std::uint8_t { kRigid, kStribeck, kMode };

/// Mass 0.03 to 15 kg, viscous 0 to 5 Ns/m, delay 0.2 to 5 ms, half of them with a force lag of 0.2
/// to 3 ms in addition, encoder step 0.5 um to 0.1 mm, 500 Hz to 4 kHz, friction and bias up to 0.6
/// of the permitted force. The axes of a device have a common clock, encoder and delay.
std::array<AxisTruth, 3> random_device(std::mt19937_64& random, Family family);

struct AxisRun {
  AxisTruth truth;
  identification::AxisFigures figures;
  double encoder_step_m = 0.0;
  double allowed_force_n = 0.0;
  double largest_force_n = 0.0;
  double reserve() const;  ///< (allowed force - friction - bias) / mass [m/s^2]
};

/// One axis through its excitation and fits.
AxisRun identify_axis(const AxisTruth& truth, std::uint64_t seed);

/// Of many axes: the rows of the table.
struct Counts {
  int axes = 0, measured = 0, mass = 0, viscous = 0, coulomb = 0, step = 0;  ///< within the limits
  /// axes with the reserve, and those of them within the limit
  int reserve = 0, delay = 0;
  int stopped = 0;  ///< by a rule although nothing is wrong
  int modes = 0, low_modes = 0, low_found = 0, false_alarms = 0;
  std::array<int, 5> covered{};  ///< mass, viscous, Coulomb, bias, delay
  std::array<std::vector<double>, 5> half_widths;
  void add(const AxisRun& run, double mass_limit);
  double median_half_width(std::size_t figure) const;
};
std::string to_text(const Counts& counts);

/// A fault during a run.
struct FaultRun {
  identification::Outcome outcome = identification::Outcome::kMeasured;
  bool stopped = false;  ///< ended by a rule
  bool left_bounds = false;
  double time_to_zero_s = 0.0;  ///< from leaving the bounds to zero force at the motor
  double time_limit_s = 0.0;    ///< 2.4 T + delay + 4 ms
  double energy_j = 0.0;        ///< of the motor, from the fault to the stop
  bool over_force = false;
};
FaultRun run_fault(const AxisTruth& truth, AxisFault fault, double at_s, std::uint64_t seed);

}  // namespace voxtouch::testing
