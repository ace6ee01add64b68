#pragma once
/// Product identities of the simulated library. The arm is always that of a Premium 1.5; models
/// differ in calls and limits that a driver must handle.
#include <string_view>

#include "devices/phantom/hdapi.hpp"

namespace voxtouch::hd_sim {

enum class Bus { kParallelPort, kFireWire };

struct Model {
  std::string_view key;        ///< name in tests and settings
  phantom::hd::HDstring type;  ///< reported model type
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

/// Substeps of the plant in one tick at `rate_hz`; 0 if the model's bus does not have that rate:
/// 500, 1000, 2000 Hz over a parallel port, 8000 / N rounded over FireWire.
int substeps_at(const Model& model, phantom::hd::HDulong rate_hz) noexcept;

}  // namespace voxtouch::hd_sim
