#pragma once
/// The figures of an identification as a table and as a device file.
#include <string>

#include "core/types/device_description.hpp"
#include "nodes/cli/identify/device_run.hpp"

namespace voxtouch::cli {

struct IdentifyContext {
  DeviceDescription assumed;  ///< reported by the open driver
  std::string serial;         ///< of the device; empty: its driver reports none
  std::string date, command;
  bool answers_at_once = true;  ///< false: in the ring a command leaves up to a period later
  double allowed_force_n = 0.0;
};

bool all_measured(const DeviceRunResult& result, const identification::SessionOptions& session);

/// As text: verdict, reasons, figures.
std::string figures_text(const DeviceRunResult& result,
                         const identification::SessionOptions& session,
                         const IdentifyContext& context);

/// The description with the measured figures: the ends of the intervals that make the design more
/// careful
/// (`at_interval_ends`), or the values.
DeviceDescription measured_description(const DeviceRunResult& result,
                                       const identification::SessionOptions& session,
                                       const IdentifyContext& context, bool at_interval_ends);

/// A device file that `sim:FILE` and `design` read.
std::string device_file_text(const DeviceRunResult& result,
                             const identification::SessionOptions& session,
                             const IdentifyContext& context);

/// Stiffness, its limit and the cost of the intervals: the design before and after.
std::string design_table(const DeviceDescription& before, const DeviceDescription& values,
                         const DeviceDescription& interval_ends);

/// For the drawing tool: figures, strokes and records of the measured axes. `text`: the report that
/// a page repeats.
std::string plots_json(const DeviceRunResult& result, const identification::SessionOptions& session,
                       const IdentifyContext& context, const std::string& text);

}  // namespace voxtouch::cli
