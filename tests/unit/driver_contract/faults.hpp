#pragma once
/// Every fault of the two emulators, the expected reaction of a driver, and the measurement of its
/// reaction.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "devices/driver.hpp"

namespace voxtouch::contract {

class Subject;

enum class Plant : std::uint8_t { kPhantom, kLwr, kFr3 };

/// State of the session after the fault.
enum class After : std::uint8_t {
  kRidesThrough,  ///< nothing is reported, and force need not end
  kRecovers,      ///< force returns with the commands after the fault
  kEnds,          ///< permanent: it must be opened again
  kRefused,       ///< it does not open
};
std::string_view name_of(After after) noexcept;

struct FaultCase {
  std::string_view name;  ///< name for --only
  Plant plant;
  int code;                   ///< of hdsim_inject; the controller has `text`
  double amount, end_amount;  ///< of hdsim_inject at its begin and its end
  std::string_view text;      ///< of the controller's schedule, without START:DURATION; a value may
                              ///< follow after a colon
  bool short_one;  ///< lasts a millisecond; the others longer than anything is watched for
  After after;
  devices::DeviceError reported;  ///< means nothing for kRidesThrough and kRefused
  double bound_s;                 ///< longest until zero force; 0: one period
  std::string_view why;           ///< the bound is longer than one period
  bool at_opening = false;
};
const std::vector<FaultCase>& fault_cases();

inline constexpr double kWatched = 0.1;  ///< [s] after the bound

struct FaultOutcome {
  const FaultCase* fault = nullptr;
  bool virtual_time = true,
       pushed = false;  ///< pushed: the plant displayed the force before the fault
  double period_s = 0.0, bound_s = 0.0;
  double before_n = 0.0;                       ///< force when it began
  std::vector<devices::DeviceError> reported;  ///< each kind once, in order
  std::optional<double> reported_after_s;
  std::optional<double>
      zero_after_s;  ///< from the begin of the fault; absent: not zero for the 100 ms
  double largest_n = 0.0, largest_nm = 0.0;  ///< begun after the bound, within 100 ms
  After after = After::kEnds;
  std::string sentence;  ///< of the driver, when it first reported

  bool zero_in_time() const noexcept { return largest_n == 0.0 && largest_nm == 0.0; }
  /// Nothing is received that should not be.
  bool good() const noexcept;
};

/// Plans `fault`, opens, applies a force, waits for the fault, continues for as long as the force
/// may need to return, and closes.
FaultOutcome run_fault(Subject& subject, const FaultCase& fault);

/// When a planned fault begins on the plant's clock, and for how long [s].
double fault_start_s(const Subject& subject);
double fault_lasts_s(const Subject& subject, const FaultCase& fault);

}  // namespace voxtouch::contract
