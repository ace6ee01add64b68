#pragma once
/// When a run was a good one: what is measured of it, the bounds, and the sentence where it is not
/// met. Pure.
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace voxtouch::cli {

/// One row of the table of limits.
struct Limit {
  std::string_view name;   ///< for --limit and --json
  std::string_view unit;   ///< "1" for a share
  bool at_least;           ///< else at most
  double value;            ///< unless --limit says another
  bool in_lockstep;        ///< judged there too; what hangs on a clock is not
  std::string_view what;   ///< subject of the sentence: "the share of ..."
  std::string_view means;  ///< what is wrong where it is not met, and what to do
};

/// Bounds that were chosen instead of the defaults, by name.
using ChosenLimits = std::map<std::string, double, std::less<>>;
/// Adds "NAME=VALUE" as typed. Returns nothing, or what is wrong with it: a sentence that names the
/// limits there are.
std::string choose_limit(const std::string& text, ChosenLimits& chosen);
/// For --help: every limit with its default.
std::string describe_limits();

/// What of a run is judged, in numbers.
struct RunFigures {
  bool lockstep = false;
  double samples = 0.0;  ///< of the device
  double nominal_rate_hz = 0.0, rate_hz = 0.0;
  std::optional<double>
      first_answered;  ///< number of the first sample that was answered; absent: none was
  double answered = 0.0;
  double overruns = 0.0, deadline_misses = 0.0, clamped = 0.0;
  double missed = 0.0;   ///< samples in which a contact may have been missed
  double passing = 0.0;  ///< samples in which the tool's middle was in what it touched, with a
                         ///< contact model alone
  /// Below zero: what the coupling gave more than it took; and as much as its observer may show of
  /// a sound contact [J].
  double lowest_energy_j = 0.0, energy_bound_j = 0.0, lowest_energy_rotation_j = 0.0,
         energy_bound_rotation_j = 0.0;
  double validate_every = 1.0;
  std::optional<double> first_judged;  ///< likewise, of the validator
  double judged = 0.0, excused = 0.0;  ///< samples; excused: due, but of a kind that is not judged
  struct Stream {
    std::string name;
    std::optional<double> first;  ///< number of the first sample in the bag
    double first_sent = 0.0;      ///< likewise, of those that were sent
    double recorded = 0.0, sent = 0.0;
  };
  bool recording = false;
  std::vector<Stream> streams;
  double silence_s = 0.0;  ///< longest time for which a node gave no sign of life
  std::string silent;      ///< which, and who else hung
};

/// One limit compared with one run.
struct Judged {
  const Limit* limit = nullptr;
  double bound = 0.0;              ///< the chosen one, else the default
  std::optional<double> measured;  ///< absent: not judged in this run
  bool met = true;
  std::string sentence;  ///< where it is not met
};
/// Every limit, in the table's order. A run without a sample is not judged.
std::vector<Judged> judge_figures(const RunFigures& run, const ChosenLimits& chosen);

}  // namespace voxtouch::cli
