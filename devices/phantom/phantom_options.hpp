#pragma once
/// What opening a Phantom needs to know.
#include <cstdint>
#include <optional>
#include <string>

#include "core/types/geometry.hpp"

namespace voxtouch::phantom {

/// When encoders are set to zero at the opening; whoever holds the arm then keeps all links at
/// right angles.
enum class EncoderReset : std::uint8_t {
  kIfNeeded,  ///< where the library says that the arm is not calibrated: after power or cable were
              ///< lost
  kAlways,
};

struct PhantomOptions {
  std::string
      library;  ///< file of the vendor's library, or of the simulated one; empty: the usual names
  std::string
      name;  ///< of the device, as the vendor's setup tool knows it; empty: its default names
  /// Where in D the origin of the library's frame lies (of a Premium: its tip in the reset pose).
  /// Axes of D are the library's: x to the right, y up, z towards the operator.
  Vec3 origin_in_d = Vec3::Zero();
  std::optional<unsigned> rate_hz;    ///< of the servo loop; absent: as it is
  std::optional<double> max_force_n;  ///< less than the device could; absent: what it says
  std::optional<double>
      max_speed_m_per_s;  ///< over this the device drops its force; absent: its own limit
  EncoderReset encoder_reset = EncoderReset::kIfNeeded;
  double calibration_timeout_s = 30.0;  ///< for a stylus in its inkwell or a calibration by itself;
                                        ///< simulated time in virtual time
  double velocity_cutoff_hz = 50.0;     ///< low-pass of the twist
  double silence_s = 1.0;               ///< without a tick for this long the servo loop has gone
};

}  // namespace voxtouch::phantom
