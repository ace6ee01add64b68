#pragma once
/// Options for opening a Phantom.
#include <cstdint>
#include <optional>
#include <string>

#include "core/types/geometry.hpp"

namespace voxtouch::phantom {

/// When encoders are set to zero at the opening. The operator must then hold all links at right
/// angles.
enum class EncoderReset : std::uint8_t {
  /// If the library reports that the arm is not calibrated: after a loss of power or cable.
  kIfNeeded,
  kAlways,
};

struct PhantomOptions {
  /// File of the vendor's library or of the simulated one; empty: the usual names.
  std::string library;
  std::string name;  ///< of the device, as in the vendor's setup tool; empty: its default names
  /// Origin of the library's frame in D (for a Premium: its tip in the reset pose). The axes of D
  /// are those of the library: x right, y up, z towards the operator.
  Vec3 origin_in_d = Vec3::Zero();
  std::optional<unsigned> rate_hz;    ///< of the servo loop; absent: unchanged
  std::optional<double> max_force_n;  ///< below the device's maximum; absent: its own value
  std::optional<double>
      max_speed_m_per_s;  ///< at a higher speed the device drops its force; absent: its own limit
  EncoderReset encoder_reset = EncoderReset::kIfNeeded;
  /// For a stylus in its inkwell or an automatic calibration; simulated time in virtual time.
  double calibration_timeout_s = 30.0;
  double velocity_cutoff_hz = 50.0;  ///< low-pass of the twist
  double silence_s = 1.0;            ///< without a tick for this long the servo loop is lost
};

}  // namespace voxtouch::phantom
