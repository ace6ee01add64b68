#pragma once
/// How long the steps of a measurement take, as guessed from the meshes alone, before the first of
/// them has been measured.
#include <cstddef>

#include "core/accuracy/accuracy.hpp"

namespace voxtouch::accuracy {

/// Seconds of CPU time on two processors of 2025, right within a small factor. MeasuredProgress
/// corrects them.
struct EstimatedCosts {
  double triangles = 0.0, area_m2 = 0.0;  ///< of the static surface

  double places_s(std::size_t count) const {
    return 7e-6 * triangles + static_cast<double>(count) * (5e-4 + 7e-8 * triangles);
  }
  double truth_s(std::size_t count) const {
    return static_cast<double>(count) * 5e-3 * (1.0 + triangles / 5e4);
  }
  /// Of a virtual tool. `god_object`: on the meshes' triangles; otherwise the exact ball.
  double tool_truth_s(std::size_t count, bool god_object) const {
    return static_cast<double>(count) * (god_object ? 1e-2 : 2e-3) * (1.0 + triangles / 5e4);
  }
  double build_s(const AccuracySetting& setting) const {
    const bool field = setting.virtual_tool || setting.model == contact::ContactModelKind::kField;
    return 0.02 + 5e-6 * triangles + (field ? field_s(setting.voxel_m) : 0.0);
  }
  double judge_s(const AccuracySetting& setting, std::size_t count) const {
    return static_cast<double>(count) * (setting.virtual_tool ? 4e-3 : 5e-4);
  }
  double phase_s(double voxel_m) const { return 0.05 + 1e-5 * triangles + 0.3 * field_s(voxel_m); }

 private:
  double field_s(double voxel_m) const {
    return area_m2 / (voxel_m * voxel_m) * (1e-5 + 4e-10 * triangles);
  }
};

}  // namespace voxtouch::accuracy
