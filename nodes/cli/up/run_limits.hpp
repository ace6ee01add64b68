#pragma once
/// The limits of a run: the measured figures and their bounds. No side effects.
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace voxtouch::cli {

/// One row of the table of limits.
struct Limit {
  std::string_view name;   ///< for --limit and --json
  std::string_view unit;   ///< "1" for a ratio
  bool at_least;           ///< else at most
  double value;            ///< unless set by --limit
  bool in_lockstep;        ///< applies in lockstep; false for limits that depend on a clock
  std::string_view what;   ///< subject of the sentence: "the ratio of ..."
  std::string_view means;  ///< consequence if it is not met, and the remedy
};

/// Bounds that were chosen instead of the defaults, by name.
using ChosenLimits = std::map<std::string, double, std::less<>>;
/// Adds "NAME=VALUE" from the command line. Returns nothing, or a diagnostic that lists the limits.
std::string choose_limit(const std::string& text, ChosenLimits& chosen);

/// The evaluated figures of a run.
struct RunFigures {
  bool lockstep = false;
  double samples = 0.0;  ///< of the device
  double nominal_rate_hz = 0.0, rate_hz = 0.0;
  std::optional<double>
      first_answered;  ///< number of the first sample that was answered; absent: none was
  double answered = 0.0;
  double overruns = 0.0, deadline_misses = 0.0, clamped = 0.0;
  double tunnelling_suspected = 0.0;  ///< samples in which a contact may have been missed
  double passed_through =
      0.0;  ///< samples with the tool's centre inside a solid, without a virtual tool
  double not_initialised = 0.0;  ///< samples without a virtual tool, of a scene that has one
  double slewed = 0.0;           ///< samples in which the guard's slew limit acted
  double swing_s = 0.0, swing_hz = 0.0, swing_m = 0.0,
         swing_n = 0.0;  ///< duration of self-excited oscillations, and the largest amplitude
  double validate_every = 1.0;
  std::optional<double> first_judged;  ///< the same of the validator
  double judged = 0.0, compared = 0.0,
         excused = 0.0;  ///< samples; compared: with the reference; excused: due, but of a kind
                         ///< that is not evaluated
  double latched = 0.0;  ///< samples of the rendering with latched depths, which are not compared
  struct Stream {
    std::string name;
    std::optional<double> first;  ///< number of the first sample in the bag
    double first_sent = 0.0;      ///< the same of sent samples
    double recorded = 0.0, sent = 0.0;
  };
  bool recording = false;
  std::vector<Stream> streams;
  double silence_s = 0.0;  ///< longest time for which a node gave no sign of life
  std::string silent;      ///< that node, and others that hung
  double force_losses = 0.0, force_lost_s = 0.0,
         longest_loss_s = 0.0;              ///< times that force was lost, and for how long
  std::optional<double> start_differences;  ///< figures in which the device differs from its file
  std::string start_check;                  ///< which
  double restarts = 0.0;                    ///< nodes that died and were started again
  std::string restarted;                    ///< which
};

/// One limit compared with one run.
struct CheckedLimit {
  const Limit* limit = nullptr;
  double bound = 0.0;              ///< the chosen one, else the default
  std::optional<double> measured;  ///< absent: not evaluated in this run
  bool met = true;
  std::string of{};  ///< which node, stream or amount was measured
};
/// "0.2 s", "0.95", "without end".
std::string with_unit(double value, std::string_view unit);
/// Every limit, in the table's order. Empty for a run without a sample.
std::vector<CheckedLimit> judge_figures(const RunFigures& run, const ChosenLimits& chosen);

}  // namespace voxtouch::cli
