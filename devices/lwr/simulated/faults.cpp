#include "devices/lwr/simulated/faults.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "core/types/number.hpp"

namespace voxtouch::lwr_sim {
namespace {

struct Row {
  FaultKind kind;
  std::string_view name;
  double usual, least, most;
  bool whole;
};
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::array<Row, kFaultKinds> kRows{{
    {FaultKind::kLoss, "loss", 1.0, 0.0, 1.0, false},
    {FaultKind::kAnswerLoss, "answer_loss", 1.0, 0.0, 1.0, false},
    {FaultKind::kLate, "late", 0.003, 0.0, 1.0, false},
    {FaultKind::kJitter, "jitter", 0.0005, 0.0, 1.0, false},
    {FaultKind::kReorder, "reorder", 1.0, 0.0, 1.0, false},
    {FaultKind::kDuplicate, "duplicate", 1.0, 0.0, 1.0, false},
    {FaultKind::kNan, "nan", 1.0, 1.0, 8.0, true},
    {FaultKind::kDrivesOff, "drives_off", 127.0, 1.0, 127.0, true},
    {FaultKind::kDriveError, "drive_error", 127.0, 1.0, 127.0, true},
    {FaultKind::kEmergencyStop, "estop", 0.0, 0.0, 0.0, false},
    {FaultKind::kQuality, "quality", 1.0, 0.0, 2.0, true},
    {FaultKind::kSilent, "silent", 0.0, 0.0, 0.0, false},
}};

[[noreturn]] void refuse(std::string_view text, std::string_view why) {
  throw std::runtime_error(
      fmt::format("fault '{}': {}; write KIND@START[:DURATION[:VALUE]], like late@2.0:0.1", text, why));
}

double number(std::string_view text, std::string_view part, std::string_view name) {
  const auto value = parse_number<double>(part);
  if (!value || std::isnan(*value)) refuse(text, fmt::format("'{}' is no {}", part, name));
  return *value;
}

/// The part up to the next colon; takes it off `rest`.
std::string_view split_off_part(std::string_view& rest) {
  const std::size_t colon = rest.find(':');
  const std::string_view part = rest.substr(0, colon);
  rest = colon == std::string_view::npos ? std::string_view() : rest.substr(colon + 1);
  return part;
}

}  // namespace

Fault parse_fault(std::string_view text) {
  const std::size_t at = text.find('@');
  if (at == std::string_view::npos) refuse(text, "it has no '@'");
  const Row* row = nullptr;
  for (const Row& r : kRows)
    if (r.name == text.substr(0, at)) row = &r;
  if (!row) refuse(text, fmt::format("there is no fault '{}'", text.substr(0, at)));
  Fault fault{row->kind, 0.0, kInfinity, row->usual};
  std::string_view rest = text.substr(at + 1);
  fault.start_s = number(text, split_off_part(rest), "start in seconds");
  if (!(fault.start_s >= 0.0 && fault.start_s < kInfinity)) refuse(text, "the start has to be 0 or more");
  const bool timed = text.substr(at + 1).find(':') != std::string_view::npos;
  if (timed) fault.duration_s = number(text, split_off_part(rest), "duration in seconds");
  if (!(fault.duration_s > 0.0)) refuse(text, "the duration has to be over 0 (inf: for ever)");
  if (rest.empty()) return fault;
  fault.value = number(text, rest, "value");
  if (!(fault.value >= row->least && fault.value <= row->most) ||
      (row->whole && fault.value != std::floor(fault.value)))
    refuse(text, fmt::format("the value has to be {} in [{}, {}]", row->whole ? "a whole number" : "a number",
                             row->least, row->most));
  return fault;
}

std::optional<double> FaultSchedule::active(FaultKind kind, double time_s) const noexcept {
  for (const Fault& f : faults_)
    if (f.kind == kind && time_s >= f.start_s - 1e-9 && time_s < f.start_s + f.duration_s - 1e-9) return f.value;
  return std::nullopt;
}

}  // namespace voxtouch::lwr_sim
