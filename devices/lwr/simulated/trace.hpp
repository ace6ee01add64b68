#pragma once
/// What the arm measured, period by period, as a table for tests and people.
#include <cstdio>
#include <filesystem>
#include <string_view>

#include "devices/lwr/simulated/fri_controller.hpp"

namespace voxtouch::lwr_sim {

/// CSV: one header line, one row a period. Base axes; force and torque `applied` by the drives at
/// the tool beyond carrying the arm (zero where the brakes hold it), `hand` by the operator.
/// Numbers do not depend on the locale.
class Trace {
 public:
  /// Throws std::runtime_error where the file cannot be made.
  explicit Trace(const std::filesystem::path& file);
  ~Trace();
  Trace(const Trace&) = delete;
  Trace& operator=(const Trace&) = delete;

  void write(const TraceRow& row);
  /// Throws std::runtime_error if not everything reached the file.
  void finish();

 private:
  std::filesystem::path path_;
  std::FILE* file_;
};

/// "off", "mon", "cmd"
std::string_view name_of(lwr::fri::State state) noexcept;
/// "unacceptable", "bad", "ok", "perfect"
std::string_view name_of(lwr::fri::Quality quality) noexcept;

}  // namespace voxtouch::lwr_sim
