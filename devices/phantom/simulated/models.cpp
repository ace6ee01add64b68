#include "devices/phantom/simulated/models.hpp"

#include <algorithm>
#include <array>

namespace voxtouch::hd_sim {
namespace {

// Type strings are as seen in drivers, except the first; that of the plain Premium 1.5 is assumed.
// Forces are data-sheet figures recalled from memory. The maxima 8.5, 7.9, 3.3 N and the stiffness
// 0.8, 1.0, 0.7 N/mm are in CHAI3D's model table.
constexpr std::array kModels{
    Model{"premium", "PHANTOM Premium 1.5", Bus::kParallelPort,
          phantom::hd::kCalibrationEncoderReset, 3, 8.5, 1.4, 0.8},
    Model{"premium-6dof", "PHANTOM Premium 1.5 6DOF", Bus::kParallelPort,
          phantom::hd::kCalibrationEncoderReset, 6, 8.5, 1.4, 0.8},
    Model{"desktop", "PHANTOM Desktop", Bus::kParallelPort, phantom::hd::kCalibrationAuto, 3, 7.9,
          1.75, 1.0},
    Model{"omni", "PHANTOM Omni", Bus::kFireWire, phantom::hd::kCalibrationInkwell, 3, 3.3, 0.88,
          0.7},
};

}  // namespace

const Model* find_model(std::string_view key) noexcept {
  const auto found =
      std::find_if(kModels.begin(), kModels.end(), [key](const Model& m) { return m.key == key; });
  return found == kModels.end() ? nullptr : &*found;
}

std::string_view model_keys() noexcept { return "premium, premium-6dof, desktop, omni"; }

int substeps_at(const Model& model, phantom::hd::HDulong rate_hz) noexcept {
  if (model.bus == Bus::kParallelPort)
    return rate_hz == 500 || rate_hz == 1000 || rate_hz == 2000 ? int(8000 / rate_hz) : 0;
  // floor(8000 / N + 0.5) in integers. No model runs below 500 Hz.
  for (unsigned n = 1; n <= 16; ++n)
    if ((16000 + n) / (2 * n) == rate_hz)
      return static_cast<int>(n);
  return 0;
}

}  // namespace voxtouch::hd_sim
