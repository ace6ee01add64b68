#pragma once
/// Which product the simulated library says that it is. The arm is a Premium 1.5's in all of them:
/// what differs is what a driver has to ask for and to keep to.
#include <string_view>

#include "devices/phantom/hdapi.hpp"

namespace voxtouch::hd_sim {

enum class Bus { kParallelPort, kFireWire };

struct Model {
  std::string_view key;        ///< what tests and people call it
  phantom::hd::HDstring type;  ///< what the library answers for the model type
  Bus bus;
  phantom::hd::HDenum calibration;  ///< one style
  int output_dof;
  double max_force_n, continuous_force_n;
  double stiffness_n_per_mm;  ///< nominal
};

/// Null for an unknown key.
const Model* find_model(std::string_view key) noexcept;
/// The keys, separated by ", ".
std::string_view model_keys() noexcept;

/// Substeps of the plant in one tick at `rate_hz`; 0 where the model's bus has no such rate: 500,
/// 1000, 2000 Hz over a parallel port, 8000 / N rounded over FireWire.
int substeps_at(const Model& model, phantom::hd::HDulong rate_hz) noexcept;

}  // namespace voxtouch::hd_sim
