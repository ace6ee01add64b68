#pragma once
/// Campaigns of simulated runs that try coupling designs on devices, hands and contacts none
/// chose. Each phase is a pure function of its options: the same seed gives the same counts.
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/coupling/coupling_spec.hpp"
#include "tests/support/coupling_models/nonlinear_loop.hpp"
#include "tests/support/coupling_models/population.hpp"

namespace voxtouch::campaign {

struct Options {
  std::uint64_t seed = 1;
  std::uint64_t first = 0;  ///< index of the first member
  std::uint64_t members = 2500;
  bool corners = true;         ///< designs: the corners of the population's ranges as well
  std::uint64_t limits = 150;  ///< designs: how many promises are compared with the simulated limit
  double overload = 1.0;  ///< designs: every contact this many times stiffer than promised; to see
                          ///< that the campaign sees it
  std::optional<double>
      damping_force_ratio;  ///< designs: as CouplingSpec has it; none: the designer chooses
  std::function<void(std::uint64_t done, std::uint64_t all)> progress;  ///< may be empty
};

/// Runs of one kind.
struct Tally {
  std::string name;
  std::uint64_t runs = 0, unstable = 0,
                decaying = 0;  ///< decaying: converging, but not at rest at the end
};

/// Everything that it takes to see a run again: draw_member(seed, index), or the corner of that
/// index, and the trial's name.
struct Failure {
  std::string setting;
  std::uint64_t seed = 0, index = 0;
  bool corner = false;
  std::string details;
};

struct Figure {
  std::string name;
  double value;
};

struct PhaseResult {
  std::string name;
  std::vector<Tally> tallies;
  std::vector<Figure> figures;
  std::vector<Failure>
      failures;  ///< unstable runs that should not be; empty for phases that only count

  Tally& tally(const std::string& kind);
  /// Counts a run; true if it is unstable.
  bool count(const std::string& kind, const coupling_models::NonlinearVerdict& verdict);
};

/// The paper's filter taken literally, 5 Hz and d = 1, its gain limited only by the device's
/// largest stiffness.
PhaseResult recipe_phase(const Options& options);
/// Designs by design_coupling; every unstable run is a failure.
PhaseResult design_phase(const Options& options);
/// Random loops around the boundary that the linear model predicts.
PhaseResult predictor_phase(const Options& options);

/// Depth, speed and duration of a run for a loop with a given contact. `displayed`: stiffness at
/// the hand. It determines the depth: half a millimetre to a centimetre, or 60 % of `max_effort`.
/// At least 8 of the loop's slowest time constants and 20 oscillations, at most two million
/// samples; the longest eight times that.
void drive(coupling_models::NonlinearLoop& loop, double displayed, double max_effort,
           coupling_models::Random& random);
/// Jitter within +- `jitter`, 1 to 3 % loss of at most `consecutive_losses`, quantisation, a
/// unilateral wall, any of the laws.
void disturb(coupling_models::NonlinearLoop& loop, const coupling::design::LoopTiming& timing,
             double resolution, coupling_models::Random& random);

/// A loop and its result as text.
std::string describe(const coupling_models::NonlinearLoop& loop,
                     const coupling_models::NonlinearVerdict& verdict);

/// As lines of text, or as one JSON object.
std::string as_table(const std::vector<PhaseResult>& phases);
std::string as_json(const std::vector<PhaseResult>& phases);

}  // namespace voxtouch::campaign
