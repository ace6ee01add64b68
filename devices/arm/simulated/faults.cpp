#include "devices/arm/simulated/faults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "core/types/number.hpp"

namespace voxtouch::arm_sim {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct FaultRow {
  std::string_view name;
  double usual, least, most;  ///< default and range of the value
  bool whole;
};

/// In the order of FaultKind.
constexpr std::array<FaultRow, kFaultKinds> kRows{{
    {"loss", 1.0, 0.0, 1.0, false},
    {"answer_loss", 1.0, 0.0, 1.0, false},
    {"late", 0.003, 0.0, 1.0, false},
    {"jitter", 0.0005, 0.0, 1.0, false},
    {"reorder", 1.0, 0.0, 1.0, false},
    {"duplicate", 1.0, 0.0, 1.0, false},
    {"nan", 1.0, 1.0, 8.0, true},
    {"silent", 0.0, 0.0, 0.0, false},
    {"drives_off", 127.0, 1.0, 127.0, true},
    {"drive_error", 127.0, 1.0, 127.0, true},
    {"estop", 0.0, 0.0, 0.0, false},
    {"quality", 1.0, 0.0, 2.0, true},
    {"user_stop", 0.0, 0.0, 0.0, false},
    {"guiding", 0.0, 0.0, 0.0, false},
    {"reflex", 7.0, 0.0, 40.0, true},
    {"not_ready", 0.0, 0.0, 0.0, false},
    {"closed", 0.0, 0.0, 0.0, false},
}};

[[noreturn]] void refuse(std::string_view text, std::string_view why) {
  throw std::runtime_error(fmt::format(
      "fault '{}': {}; format KIND@START[:DURATION[:VALUE]], such as late@2.0:0.1", text, why));
}

double number(std::string_view text, std::string_view part, std::string_view name) {
  const auto value = parse_number<double>(part);
  if (!value || std::isnan(*value))
    refuse(text, fmt::format("'{}' is not a {}", part, name));
  return *value;
}

/// The part up to the next colon, which is removed from `rest`.
std::string_view split_off_part(std::string_view& rest) {
  const std::size_t colon = rest.find(':');
  const std::string_view part = rest.substr(0, colon);
  rest = colon == std::string_view::npos ? std::string_view() : rest.substr(colon + 1);
  return part;
}

}  // namespace

Fault parse_fault(std::string_view text, const ControllerFaults& known) {
  const std::size_t at = text.find('@');
  if (at == std::string_view::npos)
    refuse(text, "'@' is missing");
  const std::string_view name = text.substr(0, at);
  const auto found = std::ranges::find(kRows, name, &FaultRow::name);
  if (found == kRows.end() || !fmt::format(" {} ", known.kinds).contains(fmt::format(" {} ", name)))
    refuse(text, fmt::format("unknown fault '{}'", name));
  FaultRow row = *found;
  Fault fault{static_cast<FaultKind>(found - kRows.begin()), 0.0, kInfinity, row.usual};
  if (fault.kind == FaultKind::kNan)
    row.most = known.most_nan;
  std::string_view rest = text.substr(at + 1);
  fault.start_s = number(text, split_off_part(rest), "start in seconds");
  if (!(fault.start_s >= 0.0 && fault.start_s < kInfinity))
    refuse(text, "the start must be >= 0");
  const bool timed = text.substr(at + 1).find(':') != std::string_view::npos;
  if (timed)
    fault.duration_s = number(text, split_off_part(rest), "duration in seconds");
  if (!(fault.duration_s > 0.0))
    refuse(text, "the duration must be > 0 (inf: unlimited)");
  if (rest.empty())
    return fault;
  fault.value = number(text, rest, "value");
  if (!(fault.value >= row.least && fault.value <= row.most) ||
      (row.whole && fault.value != std::floor(fault.value)))
    refuse(text, fmt::format("the value must be {} in [{}, {}]",
                             row.whole ? "an integer" : "a number", row.least, row.most));
  return fault;
}

}  // namespace voxtouch::arm_sim
