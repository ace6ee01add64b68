#include "nodes/cli/up/run_limits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/types/number.hpp"

namespace voxtouch::cli {
namespace {

/// The only definition of the defaults.
constexpr Limit kLimits[] = {
    {"first_answer_s", "s", false, 2.0, false, "time to the first answered sample",
     "no force until then; the coupling design takes some tenths of a second of it"},
    {"answered_ratio", "1", true, 0.95, false,
     "fraction of samples answered since the first answer",
     "the ring did not keep up and forces faded; check the machine's load"},
    {"rate_ratio", "1", true, 0.95, false, "rate as a fraction of the device's nominal rate",
     "the coupling is certified for the nominal rate only"},
    {"overrun_ratio", "1", false, 0.05, false, "fraction of skipped periods",
     "the device loop was not scheduled in time; check the machine's load and the real-time "
     "priority"},
    {"deadline_miss_ratio", "1", false, 0.01, false, "missed deadlines as a fraction of samples",
     "no command for three or more periods"},
    {"clamped_ratio", "1", false, 0.001, true, "fraction of commands clamped by the force guard",
     "the scene requests more than the device's limit; reduce stiffness or gain"},
    {"tunnelling_suspected_samples", "samples", false, 0.0, true,
     "samples with suspected tunnelling",
     "the tool moved more than half a voxel per sample near the scene; use a slower hand, larger "
     "voxels or contact: {rendering: virtual_tool}"},
    {"passed_through_samples", "samples", false, 0.0, true,
     "samples in which the tool passed through a wall or its centre was in a solid",
     "use smaller voxels (voxtouch plan lists the limits) or contact: {rendering: virtual_tool} or "
     "{rendering: penalty}; memoryless cannot prevent it"},
    {"slewed_samples", "samples", false, 0.0, true, "samples in which the guard's slew limit acted",
     "a certified loop never requests such a force step; use coupling: {design: auto}"},
    {"swing_s", "s", false, 0.0, true, "duration of self-sustained oscillation",
     "the loop oscillated without work of the hand; reduce stiffness or gain, or use coupling: "
     "{design: auto}"},
    {"not_initialised_ratio", "1", false, 0.01, true, "ratio of samples without a virtual tool",
     "walls do not stop the hand then; start the motion outside of objects"},
    {"first_validation_s", "s", false, 5.0, true, "time to the first validated sample",
     "earlier samples are not checked"},
    {"validated_ratio", "1", true, 0.9, true, "fraction of due samples validated since the first",
     "the validator did not keep up; increase --validate-every"},
    {"compared_ratio", "1", true, 0.5, true, "fraction of due samples compared with the reference",
     "the others have no depth or direction to compare; declare the shapes of tool and meshes "
     "(parts), if latched use a stiffer contact, or accept it with --limit compared_ratio=0"},
    {"first_recorded_s", "s", false, 3.0, true, "time to the first recorded sample",
     "earlier samples are missing in the recording"},
    {"recorded_ratio", "1", true, 0.99, true, "fraction of sent samples recorded since the first",
     "the logger did not keep up; use a faster disk or --no-record"},
    {"silence_s", "s", false, 0.4, false, "longest silence of a node",
     "a hanging node sends nothing to the others"},
    {"force_losses", "times", false, 0.0, false, "losses of force",
     "no command arrived or the device process stalled; see the fault records and the machine's "
     "load"},
    {"start_check_differences", "figures", false, 0.0, true,
     "figures in which the device differs from its file",
     "the coupling is certified for the file; measure the device again with voxtouch identify"},
    {"restarts", "restarts", false, 0.0, false, "restarts of nodes",
     "force is zero until the node is ready; --limit restarts=N accepts N restarts"},
};

struct Measured {
  std::optional<double> value;
  std::string of;  ///< which of several; empty: there is but one
};

constexpr double kNever = std::numeric_limits<double>::infinity();

/// 1 if nothing was due.
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
  return {run.swing_s, fmt::format("{:.3g} Hz, {:.3g} mm and {:.3g} N peak to peak", run.swing_hz,
                                   1e3 * run.swing_m, run.swing_n)};
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
  if (name == "compared_ratio")
    return {
        fraction(run.compared, due(run) - run.excused),
        run.latched > 0.0 ? fmt::format("{:.0f} samples with latched depths", run.latched) : ""};
  if (name == "silence_s")
    return {run.silence_s, run.silent};
  if (name == "force_losses")
    return {run.force_losses, run.force_losses > 0.0
                                  ? fmt::format("{:.3g} s in total, longest {:.3g} s",
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
  const std::string number = std::isinf(value) ? "unlimited" : fmt::format("{:.4g}", value);
  return unit == "1" || std::isinf(value) ? number : fmt::format("{} {}", number, unit);
}

std::string choose_limit(const std::string& text, ChosenLimits& chosen) {
  const std::size_t sign = text.find('=');
  const std::string name = text.substr(0, sign);
  std::string known;
  for (const Limit& limit : kLimits)
    known += (known.empty() ? "" : ", ") + std::string(limit.name);
  if (name == "decided_ratio")
    return "Unknown limit 'decided_ratio'; its name is compared_ratio";
  if (sign == std::string::npos || !find(name))
    return fmt::format("Unknown limit '{}' (expected NAME=VALUE). Valid limits: {}", name, known);
  const auto value = parse_number<double>(std::string_view(text).substr(sign + 1));
  if (!value || !(*value >= 0.0))
    return fmt::format("{}: '{}' is not a number >= 0 (inf: no limit)", name,
                       text.substr(sign + 1));
  chosen[name] = *value;
  return {};
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
