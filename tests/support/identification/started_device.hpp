#pragma once
/// Random devices through the check at start.
#include <array>
#include <cstdint>

#include "core/identification/start_check.hpp"
#include "tests/support/identification/identified_axis.hpp"

namespace voxtouch::testing {

/// The hand at the device during the check.
enum class Holding : std::uint8_t { kReleased, kStill, kMoving };
/// The device compared with its file.
enum class Planted : std::uint8_t {
  kHealthy,
  kDelayTwice,
  kMassTwice,
  kMassHalf,
  kEncoderFourfold
};

/// The file that a perfect identification writes for these axes.
DeviceDescription file_of(const std::array<AxisTruth, 3>& truth);

struct StartRun {
  identification::StartFindings findings;
  /// root mean square of the acceleration of a free tool of the file's least mass [m/s^2]
  double acceleration = 0.0;
};
/// `truth`: the values of the file; the device differs from it as planted.
StartRun check_start(std::array<AxisTruth, 3> truth, Planted planted, Holding holding,
                     std::uint64_t seed);

}  // namespace voxtouch::testing
