#pragma once
/// The choice between measured settings: from rows and a goal to the row to take.
#include <cstddef>
#include <optional>
#include <vector>

#include "core/accuracy/accuracy.hpp"
#include "core/accuracy/pareto.hpp"

namespace voxtouch::accuracy {

/// Direction errors below this [deg] count as equal: no hand feels them, and a tessellated
/// reference has facets larger.
inline constexpr double kMinDirectionDeg = 1e-3;

/// Limits on errors (the cheapest setting within all of them is chosen), or on the time (the most
/// accurate setting within it is chosen). Without limits the knee of the Pareto front is chosen.
struct AccuracyGoal {
  std::optional<double> direction_deg =
      {};                            ///< mean direction error, a missed contact counted as 180 deg
  std::optional<double> noise = {};  ///< magnitude noise, 0.01 = 1 %
  std::optional<double> torque_m = {};   ///< torque error as a lever arm
  std::optional<double> onset_m = {};    ///< |median onset error|
  std::optional<double> within_us = {};  ///< median CPU time of a frame

  bool requests_error() const noexcept { return direction_deg || noise || torque_m || onset_m; }
  /// Throws std::invalid_argument for a limit that is not finite and above 0, and for limits on
  /// errors and time at once.
  void validate() const;
};

/// Indices of rows.
struct AccuracyAdvice {
  std::optional<std::size_t>
      row;                  ///< the choice; without a goal the knee, or the only row of the front
  std::optional<bool> met;  ///< whether `row` meets the goal; absent without a goal
  std::vector<std::size_t>
      front;  ///< Pareto front of time and mean direction error, by ascending time
  std::optional<std::size_t> knee;
  std::optional<std::size_t>
      refused_tool;  ///< the scene's virtual tool, if it was not evaluated: then no row is chosen
};

/// Whether a row can be compared with others: built, in contact at least once, time and direction
/// error finite. A setting without any contact has zero errors.
bool is_judged(const AccuracyRow& row) noexcept;

/// Deterministic: among equals the faster, then the smaller, then the first row. `renders_tool`:
/// the scene renders a virtual tool.
AccuracyAdvice advise(const std::vector<AccuracyRow>& rows, const AccuracyGoal& goal,
                      bool renders_tool = false);

}  // namespace voxtouch::accuracy
