#pragma once
/// Faults of a simulated controller, on a schedule. Which kinds there are is each controller's own enumeration.
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace voxtouch::arm_sim {

/// Acts from `start_s` on for `duration_s`, on the controller's clock.
template <class Kind>
struct Fault {
  Kind kind{};
  double start_s = 0.0;
  double duration_s = std::numeric_limits<double>::infinity();
  double value = 0.0;
};

/// One kind as it is typed; its place in the list is its number.
struct FaultRow {
  std::string_view name;
  double usual, least, most;  ///< of the value
  bool whole;
};

/// KIND@START[:DURATION[:VALUE]] in seconds, DURATION "inf" for ever (as if left out): "late@2.0:0.1", "loss@0:inf:0.02",
/// "nan@1.5:0.001:3". Throws std::runtime_error that shows the text and says what is wrong with it.
Fault<std::size_t> parse_fault(std::string_view text, std::span<const FaultRow> rows);

template <class Kind>
Fault<Kind> parse_fault_as(std::string_view text, std::span<const FaultRow> rows) {
  const Fault<std::size_t> fault = parse_fault(text, rows);
  return {static_cast<Kind>(fault.kind), fault.start_s, fault.duration_s, fault.value};
}

/// Real-time safe after construction.
template <class FaultKind>
class FaultSchedule {
 public:
  using Kind = FaultKind;
  explicit FaultSchedule(std::vector<Fault<Kind>> faults = {}) : faults_(std::move(faults)) {}
  /// The value of the first fault of this kind that acts at `time_s`.
  std::optional<double> active(Kind kind, double time_s) const noexcept {
    for (const Fault<Kind>& f : faults_)
      if (f.kind == kind && time_s >= f.start_s - 1e-9 && time_s < f.start_s + f.duration_s - 1e-9) return f.value;
    return std::nullopt;
  }

 private:
  std::vector<Fault<Kind>> faults_;
};

}  // namespace voxtouch::arm_sim
