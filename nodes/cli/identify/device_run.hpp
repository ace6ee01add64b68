#pragma once
/// One identification run on an open driver.
#include <array>
#include <atomic>
#include <functional>
#include <string>

#include "core/identification/device_session.hpp"
#include "devices/driver.hpp"

namespace voxtouch::cli {

struct DeviceRunOptions {
  identification::SessionOptions session;
  bool virtual_time = false;  ///< fits run between two samples, and nothing waits
  bool hand_check = true;
  double hand_check_s = 60.0;  ///< for each axis
  bool with_curves = false;    ///< fills DeviceRunResult::curves
};

/// The curves of an axis in a picture.
struct AxisCurves {
  std::vector<identification::Curve> strokes;
  std::vector<identification::RecordEntry> record;  ///< strokes and dense tones
};

struct DeviceRunResult {
  std::array<identification::AxisFigures, 3> axes;
  std::array<double, 3> encoder_step_m{};
  identification::ClockFigures clock;
  identification::Outcome outcome = identification::Outcome::kMeasured;
  std::array<AxisCurves, 3> curves;
  std::string problem;  ///< why the run ended early; empty: it did not
  std::uint64_t guard_clamped = 0;
};

/// Neither opens nor closes the driver; ends with zero force on every path. `report`: receives the
/// progress.
DeviceRunResult run_identification(devices::Driver& driver, const DeviceRunOptions& options,
                                   const std::atomic<bool>& stop,
                                   const std::function<void(const std::string&)>& report);

}  // namespace voxtouch::cli
