#pragma once
/// What identification reports of one axis, and the model that it fits.
///
///     m dv/dt = u(t - tau) + c - b v - Fc sign(v)
///
/// u: commanded force, held until the next command arrives; c: bias left after gravity
/// compensation.
#include <cstdint>
#include <limits>
#include <string_view>

namespace voxtouch::identification {

/// A figure with the half width of its 95 % interval; infinity: the figure is not known.
struct Estimate {
  double value = 0.0;
  double half_width = std::numeric_limits<double>::infinity();

  double low() const noexcept { return value - half_width; }
  double high() const noexcept { return value + half_width; }
};

/// The figures that excitation needs of an axis [kg, Ns/m, N, N, s].
struct AxisModel {
  double mass_kg = 0.0;
  double viscous_ns_per_m = 0.0;
  double coulomb_n = 0.0;
  double bias_n = 0.0;
  /// from the stamp of a sample to the motion: transport, loss and force lag
  double delay_s = 0.0;

  bool operator==(const AxisModel&) const = default;
};

/// The first structural mode, as the encoder sees it.
struct Mode {
  bool found = false;
  Estimate frequency_hz;
  double damping_ratio = 0.0;
  /// modal over rigid response; negative: the encoder is behind the spring
  double mass_ratio = 0.0;
};

enum class Outcome : std::uint8_t {
  kMeasured,
  kFrictionTooHigh,  ///< Coulomb friction and bias exceed 0.6 of the allowed force
  kDoesNotMove,      ///< nothing moves at the allowed force
  kWrongDirection,   ///< both break-away ramps move against the force
  kLeftBounds,       ///< position or speed left the bounds
  kFollowingError,   ///< the position does not follow the reference
  kEncoderStuck,     ///< no encoder increment although the reference moves
  kInvalidSamples,   ///< three samples that are NaN or not newer
  kNotIdentifiable,  ///< the fit does not converge, or too few windows move without reversal
};
/// "measured", "friction_too_high", ...
std::string_view name_of(Outcome outcome) noexcept;
/// True: the outcome ends the session at zero force; false: the other axes can still be measured.
bool ends_session(Outcome outcome) noexcept;

struct AxisFigures {
  Outcome outcome = Outcome::kNotIdentifiable;
  Estimate mass_kg, viscous_ns_per_m, coulomb_n, bias_n, delay_s;
  double break_away_n = 0.0;   ///< half the sum of both directions; a lower bound if nothing moves
  double lag_s = 0.0;          ///< the part of the delay that fits a first-order lag better
  double lost_commands = 0.0;  ///< ratio of the commands that the device seems to have lost
  double residual_m = 0.0;     ///< root mean square of the fit
  Mode mode;

  AxisModel model() const noexcept {
    return {mass_kg.value, viscous_ns_per_m.value, coulomb_n.value, bias_n.value, delay_s.value};
  }
};

/// Figures from the stamps and positions of all samples.
struct ClockFigures {
  double period_s = 0.0;       ///< mean of the periods without a lost sample
  double jitter = 0.0;         ///< largest relative deviation from that mean (99.9 % of periods)
  double loss = 0.0;           ///< ratio of samples lost
  int consecutive_losses = 0;  ///< largest number of samples lost one after the other
};

}  // namespace voxtouch::identification
