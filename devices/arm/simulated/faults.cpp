#include "devices/arm/simulated/faults.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "core/types/number.hpp"

namespace voxtouch::arm_sim {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

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

Fault<std::size_t> parse_fault(std::string_view text, std::span<const FaultRow> rows) {
  const std::size_t at = text.find('@');
  if (at == std::string_view::npos) refuse(text, "it has no '@'");
  std::size_t kind = 0;
  while (kind < rows.size() && rows[kind].name != text.substr(0, at)) ++kind;
  if (kind == rows.size()) refuse(text, fmt::format("there is no fault '{}'", text.substr(0, at)));
  const FaultRow& row = rows[kind];
  Fault<std::size_t> fault{kind, 0.0, kInfinity, row.usual};
  std::string_view rest = text.substr(at + 1);
  fault.start_s = number(text, split_off_part(rest), "start in seconds");
  if (!(fault.start_s >= 0.0 && fault.start_s < kInfinity)) refuse(text, "the start has to be 0 or more");
  const bool timed = text.substr(at + 1).find(':') != std::string_view::npos;
  if (timed) fault.duration_s = number(text, split_off_part(rest), "duration in seconds");
  if (!(fault.duration_s > 0.0)) refuse(text, "the duration has to be over 0 (inf: for ever)");
  if (rest.empty()) return fault;
  fault.value = number(text, rest, "value");
  if (!(fault.value >= row.least && fault.value <= row.most) || (row.whole && fault.value != std::floor(fault.value)))
    refuse(text,
           fmt::format("the value has to be {} in [{}, {}]", row.whole ? "a whole number" : "a number", row.least, row.most));
  return fault;
}

}  // namespace voxtouch::arm_sim
