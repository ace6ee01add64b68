#include "nodes/cli/up/run_limits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/types/number.hpp"

namespace voxtouch::cli {
namespace {

/// The one place where the defaults stand.
constexpr Limit kLimits[] = {
    {"first_answer_s", "s", false, 2.0, false, "the time to the first answered sample",
     "until then no force is displayed; the coupling is designed in it, in some tenths of a "
     "second"},
    {"answered_ratio", "1", true, 0.95, false,
     "the fraction of samples answered, from the first answer on,",
     "the ring did not keep up, so that forces were held and faded; see what else the machine "
     "does"},
    {"rate_ratio", "1", true, 0.95, false, "the rate, as a fraction of the device's own,",
     "the coupling is certified for the device's rate only"},
    {"overrun_ratio", "1", false, 0.05, false, "the fraction of periods that were skipped",
     "the device's loop was kept from running; see what else the machine does, and whether it has "
     "real-time priority"},
    {"deadline_miss_ratio", "1", false, 0.01, false,
     "deadlines missed, as a fraction of the samples,",
     "for three periods and more no command came"},
    {"clamped_ratio", "1", false, 0.001, true, "the fraction of commands that the guard cut",
     "the scene asks for more than the device may give: less stiffness or gain"},
    {"tunnelling_suspected_samples", "samples", false, 0.0, true,
     "the number of samples in which the tool may have passed something unseen",
     "it moved more than half a voxel a sample next to the scene: a slower hand, larger voxels, or "
     "contact: {rendering: virtual_tool}"},
    {"passed_through_samples", "samples", false, 0.0, true,
     "the number of samples in which the tool passed a wall, or its middle was in what it touched "
     "with nothing that holds it,",
     "smaller voxels (voxtouch plan has the wall and the tool that they hold), or contact: "
     "{rendering: virtual_tool}, or rendering: penalty, which holds depths; "
     "memoryless is the paper's law, and where its walls are passed is what it shows"},
    {"slewed_samples", "samples", false, 0.0, true,
     "the number of samples in which the guard's slew limit acted",
     "no certified loop asks for such a step of force: let the coupling be designed (coupling: "
     "{design: auto})"},
    {"swing_s", "s", false, 0.0, true, "the time for which the device swung by itself",
     "force and tool went to and fro without the hand's work: less stiffness or gain, or let the "
     "coupling be designed (coupling: {design: auto})"},
    {"not_initialised_ratio", "1", false, 0.01, true, "the ratio of samples without a virtual tool",
     "without one no wall holds the hand: begin the motion outside of what it touches, or start "
     "the ring before the hand touches"},
    {"first_validation_s", "s", false, 5.0, true, "the time to the first validated sample",
     "what came before it was not checked"},
    {"validated_ratio", "1", true, 0.9, true,
     "the fraction of due samples validated, from the first on,",
     "the validator did not keep up: a larger --validate-every asks for less"},
    {"decided_ratio", "1", true, 0.5, true,
     "the ratio of validated samples that the validator could decide",
     "the run is hardly checked: declare the tool's and the meshes' shapes (parts), or accept it "
     "with --limit decided_ratio=0"},
    {"first_recorded_s", "s", false, 3.0, true, "the time to the first recorded sample",
     "what came before it is not in the bag"},
    {"recorded_ratio", "1", true, 0.99, true,
     "the fraction of sent samples in the bag, from the first on,",
     "the logger did not keep up: a faster disk, or --no-record"},
    {"silence_s", "s", false, 0.4, false, "the longest time without a sign of life of a node",
     "a node that hangs leaves the others without what it should send them"},
    {"force_losses", "times", false, 0.0, false, "the number of times that force was lost",
     "no command came, or the device's process stood still; see the fault records and what else "
     "the machine does"},
    {"start_check_differences", "figures", false, 0.0, true,
     "the number of figures in which the device is not as its file says",
     "the coupling is certified for the file: measure the device again with voxtouch identify"},
    {"restarts", "restarts", false, 0.0, false,
     "the number of nodes that died and were started again",
     "force was zero until each was ready again; --limit restarts=N accepts N of them"},
};

struct Measured {
  std::optional<double> value;
  std::string of;  ///< which of several; empty: there is but one
};

constexpr double kNever = std::numeric_limits<double>::infinity();

/// 1 where nothing was due.
double fraction(double part, double whole) { return whole > 0.0 ? part / whole : 1.0; }

double seconds_to(const RunFigures& run, const std::optional<double>& sample) {
  return sample ? *sample / run.nominal_rate_hz : kNever;
}

/// Samples 0, every, 2 every, ... that lie in [first, samples).
double due(const RunFigures& run) {
  const double every = std::max(run.validate_every, 1.0), first = run.first_judged.value_or(0.0);
  return std::ceil(run.samples / every) - std::ceil(first / every);
}

Measured swing(const RunFigures& run) {
  if (!(run.swing_s > 0.0))
    return {run.swing_s, ""};
  return {run.swing_s, fmt::format("{:.3g} Hz, {:.3g} mm and {:.3g} N from peak to peak",
                                   run.swing_hz, 1e3 * run.swing_m, run.swing_n)};
}

/// Samples that were sent before the first one in the bag.
double head(const RunFigures::Stream& s) {
  return std::max(s.first.value_or(s.first_sent) - s.first_sent, 0.0);
}

/// The worst stream's.
Measured recorded_ratio(const RunFigures& run) {
  Measured worst{1.0, ""};
  for (const RunFigures::Stream& s : run.streams)
    if (const double part = fraction(s.recorded, s.sent - head(s)); part < *worst.value)
      worst = {part, s.name};
  return worst;
}

Measured first_recorded(const RunFigures& run) {
  Measured worst{0.0, ""};
  for (const RunFigures::Stream& s : run.streams)
    if (const double late_s = s.first ? head(s) / run.nominal_rate_hz : kNever;
        s.sent > 0.0 && late_s > *worst.value)
      worst = {late_s, s.name};
  return worst;
}

Measured measure(std::string_view name, const RunFigures& run) {
  if (name == "first_answer_s")
    return {seconds_to(run, run.first_answered), ""};
  if (name == "answered_ratio")
    return {fraction(run.answered, run.samples - run.first_answered.value_or(0.0)), ""};
  if (name == "rate_ratio")
    return {fraction(run.rate_hz, run.nominal_rate_hz), ""};
  if (name == "overrun_ratio")
    return {run.overruns / (run.samples + run.overruns), ""};
  if (name == "deadline_miss_ratio")
    return {run.deadline_misses / run.samples, ""};
  if (name == "clamped_ratio")
    return {run.clamped / run.samples, ""};
  if (name == "tunnelling_suspected_samples")
    return {run.tunnelling_suspected, ""};
  if (name == "passed_through_samples")
    return {run.passed_through, ""};
  if (name == "slewed_samples")
    return {run.slewed, ""};
  if (name == "swing_s")
    return swing(run);
  if (name == "first_validation_s")
    return {due(run) > 0.0 ? seconds_to(run, run.first_judged) : 0.0, ""};
  if (name == "validated_ratio")
    return {fraction(run.judged, due(run) - run.excused), ""};
  if (name == "not_initialised_ratio")
    return {run.not_initialised / run.samples, ""};
  if (name == "decided_ratio")
    return {fraction(run.decided, run.judged), ""};
  if (name == "silence_s")
    return {run.silence_s, run.silent};
  if (name == "force_losses")
    return {run.force_losses, run.force_losses > 0.0
                                  ? fmt::format("{:.3g} s in all, the longest {:.3g} s",
                                                run.force_lost_s, run.longest_loss_s)
                                  : ""};
  if (name == "start_check_differences")
    return {run.start_differences, run.start_check};
  if (name == "restarts")
    return {run.restarts, run.restarted};
  if (!run.recording)
    return {};
  return name == "first_recorded_s" ? first_recorded(run) : recorded_ratio(run);
}

const Limit* find(std::string_view name) {
  const auto found = std::find_if(std::begin(kLimits), std::end(kLimits),
                                  [&](const Limit& l) { return l.name == name; });
  return found == std::end(kLimits) ? nullptr : &*found;
}

}  // namespace

std::string with_unit(double value, std::string_view unit) {
  const std::string number = std::isinf(value) ? "without end" : fmt::format("{:.4g}", value);
  return unit == "1" || std::isinf(value) ? number : fmt::format("{} {}", number, unit);
}

std::string choose_limit(const std::string& text, ChosenLimits& chosen) {
  const std::size_t sign = text.find('=');
  const std::string name = text.substr(0, sign);
  std::string known;
  for (const Limit& limit : kLimits)
    known += (known.empty() ? "" : ", ") + std::string(limit.name);
  if (sign == std::string::npos || !find(name))
    return fmt::format("it takes NAME=VALUE and there is no limit '{}'; there are {}", name, known);
  const auto value = parse_number<double>(std::string_view(text).substr(sign + 1));
  if (!value || !(*value >= 0.0))
    return fmt::format("{}: '{}' is not a number of 0 or more (inf: no limit)", name,
                       text.substr(sign + 1));
  chosen[name] = *value;
  return {};
}

std::string describe_limits() {
  std::string text;
  for (const Limit& limit : kLimits)
    text +=
        fmt::format("{}{} {} {}", text.empty() ? "" : ", ", limit.name,
                    limit.at_least ? "at least" : "at most", with_unit(limit.value, limit.unit));
  return text;
}

std::vector<CheckedLimit> judge_figures(const RunFigures& run, const ChosenLimits& chosen) {
  std::vector<CheckedLimit> all;
  for (const Limit& limit : kLimits) {
    const auto other = chosen.find(limit.name);
    CheckedLimit judged{&limit, other == chosen.end() ? limit.value : other->second, std::nullopt,
                        true, ""};
    const bool applies = run.samples > 0.0 && (limit.in_lockstep || !run.lockstep);
    Measured measured = applies ? measure(limit.name, run) : Measured{};
    judged.measured = measured.value, judged.of = std::move(measured.of);
    if (measured.value)
      judged.met =
          limit.at_least ? *measured.value >= judged.bound : *measured.value <= judged.bound;
    all.push_back(std::move(judged));
  }
  return all;
}

}  // namespace voxtouch::cli
