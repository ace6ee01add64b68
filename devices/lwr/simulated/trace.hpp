#pragma once
/// Measurements of the arm for each period, as a table for tests and analysis.
#include <cstdio>
#include <filesystem>
#include <string_view>

#include "devices/lwr/simulated/fri_controller.hpp"

namespace voxtouch::lwr_sim {

/// CSV: one header line, one row per period. Base axes. Force and torque `applied` are those of the
/// drives at the tool in addition to carrying the arm (zero while brakes hold it); `hand` is the
/// force of the operator. Numbers do not depend on the locale.
class Trace {
 public:
  /// Throws std::runtime_error if the file cannot be created.
  explicit Trace(const std::filesystem::path& file);
  ~Trace();
  Trace(const Trace&) = delete;
  Trace& operator=(const Trace&) = delete;

  void write(const TraceRow& row);
  /// Throws std::runtime_error if the file is incomplete.
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
