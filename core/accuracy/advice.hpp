#pragma once
/// What to choose: from measured rows and a goal to one sentence and the row it names.
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/accuracy/accuracy.hpp"
#include "core/accuracy/pareto.hpp"

namespace voxtouch::accuracy {

/// Direction errors below this [deg] are not told apart: no hand feels them, and a tessellated
/// reference has facets larger.
inline constexpr double kMinDirectionDeg = 1e-3;

/// What the user wants: errors that must not be exceeded (the cheapest setting that keeps all of
/// them), or a time (the most accurate setting within it). Nothing: what there is to choose from.
struct AccuracyGoal {
  std::optional<double> direction_deg =
      {};                            ///< mean direction error, a missed contact counted as 180 deg
  std::optional<double> noise = {};  ///< magnitude noise, 0.01 = 1 %
  std::optional<double> torque_m = {};   ///< torque error as a lever arm
  std::optional<double> onset_m = {};    ///< |median onset error|
  std::optional<double> within_us = {};  ///< median CPU time of a frame

  bool wants_error() const noexcept { return direction_deg || noise || torque_m || onset_m; }
  /// Throws std::invalid_argument for a goal that is not finite and above 0, and for an error and a
  /// time at once.
  void validate() const;
};

struct AccuracyAdvice {
  std::string sentence;
  std::optional<std::size_t>
      row;  ///< what the sentence recommends; without a goal the knee, or the only choice
  std::optional<bool> met;  ///< whether `row` keeps the goal; absent without a goal
  std::vector<std::size_t>
      front;  ///< Pareto front of time and mean direction error, by ascending time
  std::optional<std::size_t> knee;
};

/// Whether a row can be compared with others: built, in contact at least once, time and direction
/// error finite. (A setting that never met the wall has zeros for errors, which would look like
/// perfection.)
bool is_judged(const AccuracyRow& row) noexcept;

/// Deterministic: among equals the faster, then the smaller, then the first row. `renders_tool`:
/// the scene renders a virtual tool; where its row was refused the sentence says so and why, and
/// nothing is recommended against what was not judged.
AccuracyAdvice advise(const std::vector<AccuracyRow>& rows, const AccuracyGoal& goal,
                      bool renders_tool = false);

/// "one", "area".
std::string_view weights_word(contact::PointWeights weights) noexcept;
/// "adapted/area, e = 1 mm, shell 0.5 mm": as sentences and progress name a setting.
std::string describe(const AccuracySetting& setting);

}  // namespace voxtouch::accuracy
