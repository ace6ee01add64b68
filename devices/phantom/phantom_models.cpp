#include "devices/phantom/phantom_models.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "devices/sim/parameters.hpp"

namespace voxtouch::phantom {
namespace {

// Sources of the numbers. Confirmed in CHAI3D's model table: maximum force and stiffness of Premium
// 1.5 (its 6DOF row) and 3.0, Desktop, Omni, Touch. Derived from a published link model: mass of
// the Premium 1.5. Assumed: all others, from data sheets recalled from memory. The Premium 1.0 and
// the high-force model have the stiffness of their sister model; a range of mass is the figure of
// the sheet and a third less. Model names are confirmed except "1.0", "High Force", and "1.5"
// without 6DOF, which are assumed.
constexpr std::array kFigures{
    //             prefix                            max  cont. stiffness  mass from, to  friction
    //             resolution
    PhantomFigures{"PHANTOM Premium 1.0", 8.5, 1.40, 800.0, 0.050, 0.075, 0.04, 0.030e-3},
    PhantomFigures{"PHANTOM Premium 1.5", 8.5, 1.40, 800.0, 0.035, 0.080, 0.04, 0.030e-3},
    PhantomFigures{"PHANTOM Premium 1.5 High Force", 37.5, 6.20, 800.0, 0.100, 0.150, 0.20,
                   0.007e-3},
    PhantomFigures{"PHANTOM Premium 3.0", 22.0, 3.00, 1000.0, 0.106, 0.159, 0.20, 0.020e-3},
    PhantomFigures{"PHANTOM Desktop", 7.9, 1.75, 1000.0, 0.030, 0.045, 0.06, 0.023e-3},
    PhantomFigures{"PHANTOM Omni", 3.3, 0.88, 700.0, 0.030, 0.045, 0.26, 0.055e-3},
    PhantomFigures{"Touch", 3.3, 0.88, 400.0, 0.030, 0.045, 0.26, 0.055e-3},
};
// Confirmed: force and stiffness, which CHAI3D uses for unknown models. The others are assumed: the
// range of the rows above.
constexpr PhantomFigures kUnknown{"", 6.0, 0.88, 1000.0, 0.030, 0.160, 0.26, 0.055e-3};

// Of the guard; a force rate below max_force / this would prevent its fade.
constexpr double kFadeS = 0.02;

bool starts_with(std::string_view name, std::string_view prefix) noexcept {
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) ==
           std::tolower(static_cast<unsigned char>(b));
  };
  return name.size() >= prefix.size() &&
         std::equal(prefix.begin(), prefix.end(), name.begin(), same);
}

// A larger value than any device of this family has is an error of the library.
constexpr double kMostForceN = 1'000.0, kMostTorqueNm = 100.0, kMostStiffness = 1e9,
                 kMostRate = 1e9;

double known_or(double known, double most, double otherwise) noexcept {
  return known >= 1e-3 && known <= most ? known : otherwise;  // false for NaN
}

}  // namespace

const PhantomFigures& phantom_figures(std::string_view model) noexcept {
  const PhantomFigures* best = &kUnknown;
  for (const PhantomFigures& row : kFigures)
    if (starts_with(model, row.prefix) && row.prefix.size() > best->prefix.size())
      best = &row;
  return *best;
}

double continuous_force_n(const PhantomFacts& facts) noexcept {
  const PhantomFigures& f = phantom_figures(facts.model);
  return std::min(known_or(facts.continuous_force_n, kMostForceN, f.continuous_force_n),
                  known_or(facts.max_force_n, kMostForceN, f.max_force_n));
}

DeviceDescription describe_phantom(const PhantomFacts& facts) {
  const PhantomFigures& f = phantom_figures(facts.model);
  DeviceDescription d = sim::sim_phantom().description;  // common to all models, with its sources
  d.model = facts.model.empty() ? "Phantom" : facts.model;
  d.rate_hz = servo_rate_hz(facts.rate_hz);
  d.max_force_n = known_or(facts.max_force_n, kMostForceN, f.max_force_n);
  d.max_torque_nm = facts.output_dof >= 6 ? known_or(facts.max_torque_nm, kMostTorqueNm, 0.0) : 0.0;
  d.max_stiffness_n_per_m =
      std::min(known_or(facts.max_stiffness_n_per_m, kMostStiffness, kMostStiffness),
               f.max_stiffness_n_per_m);
  d.mass_min_kg = f.mass_min_kg;
  d.mass_max_kg = f.mass_max_kg;
  d.coulomb_friction_n = f.coulomb_friction_n;
  d.position_resolution_m = f.position_resolution_m;
  d.delay_s = 1.0 / d.rate_hz;  // derived: a command is set one tick after its sample
  if (d.max_torque_nm > 0.0) {  // assumed, except the stiffness, which is in CHAI3D's table
    d.inertia_min_kg_m2 = d.inertia_max_kg_m2 = 1e-4;
    d.damping_nms_per_rad = 1e-3;
    d.max_stiffness_nm_per_rad = 0.3;
  }
  d.input_dof = static_cast<std::uint32_t>(std::clamp(facts.input_dof, 0, 7));
  d.output_dof = static_cast<std::uint32_t>(std::clamp(facts.output_dof, 0, 7));
  derive_slew_limits(d);
  // The force rate at which the device drops its force is never reached; the guard must be able to
  // fade.
  const double dropped_n_per_s = known_or(facts.max_impulse_n_per_s, kMostRate, kMostRate);
  d.max_force_rate_n_per_s =
      std::max(d.max_force_n / kFadeS, std::min(d.max_force_rate_n_per_s, 0.9 * dropped_n_per_s));
  return d;
}

/// floor(8000 / n + 0.5) over FireWire, and 500, 1000, 2000 over a parallel port, which are among
/// those.
double servo_rate_hz(double measured_hz) noexcept {
  constexpr double kDefaultHz = 1000.0;
  if (!(measured_hz > 400.0 && measured_hz < 9000.0))
    return kDefaultHz;
  double nearest = kDefaultHz;
  for (int n = 1; n <= 16; ++n) {
    const double rate = std::floor(8000.0 / n + 0.5);
    if (std::abs(rate - measured_hz) < std::abs(nearest - measured_hz))
      nearest = rate;
  }
  return nearest;
}

}  // namespace voxtouch::phantom
