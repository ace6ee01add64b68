#include "nodes/cli/up/verdict_text.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace voxtouch::cli {
namespace {

std::string ended(const Found& f) {
  if (f.value > 128 && f.node == "device")
    return fmt::format(
        "device ended by signal {:.0f} without commanding zero force. Only the device's own "
        "watchdog acts then: check that it is at rest",
        f.value - 128);
  if (f.value > 128)
    return fmt::format("{} ended by signal {:.0f}; the device went to zero force", f.node,
                       f.value - 128);
  if (f.value != 0)
    return fmt::format("{} ended with status {:.0f}; see its message above", f.node, f.value);
  return fmt::format("{} ended before the device did", f.node);
}

std::string external(const RunRecord& run, const Found& f) {
  const auto n = [&](const char* figure) { return number(run.reports, "rendering", figure); };
  return fmt::format(
      "{} {} of its values were rendered; energy generated {:.3g} J. Refused: {} of other writers, "
      "{} with NaN or infinity, {} in an unknown frame.",
      f.text, n("external_samples"), n("external_energy_generated_j"), n("external_foreign"),
      n("external_not_finite"), n("external_wrong_frame"));
}

std::string sentence(const RunRecord& run, const Found& f) {
  switch (f.what) {
    case RunFact::kNodeEnded:
      return ended(f);
    case RunFact::kNodeFailed:
      return fmt::format("{}: {}", f.node, f.text);
    case RunFact::kNodeSilent:
      return fmt::format("{} is silent for {:.3g} s: the run ends", f.node, f.value);
    case RunFact::kNotRestarted:
      return fmt::format("{} is not restarted: {}", f.node, f.text);
    case RunFact::kCutShort:
      return fmt::format("the run was stopped before {} s", f.value);
    case RunFact::kNoFinalStatus:
      return fmt::format("no final status from {}: its figures end at {:.0f} samples", f.node,
                         f.value);
    case RunFact::kDisagree:
      return fmt::format("the validator disagrees in {:.0f} samples: {}", f.value, f.text);
    case RunFact::kForeignSamples:
      return fmt::format("{:.0f} samples of another writer on the ring's topics were refused ({})",
                         f.value, f.text);
    case RunFact::kForeignRecords:
      return fmt::format("{:.0f} records of another writer are not in the recording ({})", f.value,
                         f.text);
    case RunFact::kFaultLatched:
      return fmt::format("the {} latched at zero force {:.0f} times: see its fault records", f.node,
                         f.value);
    case RunFact::kTooStiff:
      return fmt::format(
          "all contact points together displayed {:.0f} N/m at the hand, limit {:.0f} N/m of {}: "
          "reduce the contact stiffness, the coupling's gain or a scale of the device",
          f.value, f.bound, run.device);
    case RunFact::kNoSample:
      return "the device sent no sample";
    case RunFact::kNoForce:
      return fmt::format("{} accepted no force in the whole run: {}", run.device, f.text);
    case RunFact::kRatioAboveOne:
      return fmt::format("{} is {:.4g}, above 1: its counts are inconsistent", f.node, f.value);
    case RunFact::kLostRecording:
      return f.text.empty()
                 ? fmt::format("the recording holds {:.0f} of {:.0f} messages", f.value, f.bound)
                 : f.text;
    case RunFact::kInterrupted:
      return fmt::format(
          "{} displayed no force in {:.0f} samples ({:.0f} interruptions); last reason: {}",
          run.device, f.value, f.bound, f.text);
    case RunFact::kForeignWriters:
      return fmt::format("other writers on the ring's topics: {}", f.text);
    case RunFact::kRefusedStatuses:
      return fmt::format(
          "{:.0f} node statuses were refused: too long, too many, or from another participant{}",
          f.value, f.text.empty() ? "" : " (" + f.text + ")");
    case RunFact::kChanges:
      return fmt::format("changes of the scene during the run: {:.0f}; requests by: {}", f.value,
                         f.text.empty() ? "an unknown participant" : f.text);
    case RunFact::kRecovers:
      return fmt::format("{:.0f} Recover messages from {}", f.value, f.text);
    case RunFact::kSamples:
      return fmt::format("in {:.0f} samples {}", f.value, f.text);
    case RunFact::kExternal:
      return external(run, f);
    case RunFact::kRestarted:
      return fmt::format("{} ended by {} after {:.0f} device samples; {}", f.node, f.text, f.value,
                         f.bound > 0 ? "it was restarted" : "the run ended before its restart");
    case RunFact::kPageEnded:
      return fmt::format("the page ended by {} during the run", f.text);
    case RunFact::kBagGoesOn:
      return fmt::format("The recording continues in {} after the logger's restart.", f.text);
    case RunFact::kFaultRecord:
      return f.text;
    case RunFact::kStartCheck:
      return "check at start against the device file: " + f.text;
  }
  return "";
}

std::vector<std::string> unique(std::vector<std::string> all) {
  std::vector<std::string> out;
  for (std::string& one : all)
    if (std::ranges::find(out, one) == out.end())
      out.push_back(std::move(one));
  return out;
}

void add(std::vector<std::string>& to, double n, const char* one, const char* many) {
  if (n > 0)
    to.push_back(fmt::format("{:.0f} {}", n, n == 1 ? one : many));
}

}  // namespace

std::string sentence_of(const CheckedLimit& judged) {
  const Limit& limit = *judged.limit;
  const double measured = judged.measured.value_or(NAN);
  return fmt::format("{}: {}{}, limit {} ({}); {}", limit.what,
                     std::isinf(measured) ? "never" : with_unit(measured, limit.unit),
                     judged.of.empty() ? "" : " (" + judged.of + ")",
                     with_unit(judged.bound, limit.unit), limit.name, limit.means);
}

std::vector<std::string> problems_of(const RunRecord& run, const RunVerdict& verdict) {
  std::vector<std::string> all;
  for (const Found& fault : verdict.faults)
    all.push_back(sentence(run, fault));
  for (const CheckedLimit& judged : verdict.limits)
    if (!judged.met)
      all.push_back(sentence_of(judged));
  return unique(std::move(all));
}

std::vector<std::string> notes_of(const RunRecord& run, const RunVerdict& verdict) {
  std::vector<std::string> all;
  for (const Found& note : verdict.notes)
    all.push_back(sentence(run, note));
  return unique(std::move(all));
}

std::string verdict_line(const RunRecord& run, const RunVerdict& verdict) {
  std::vector<std::string> reported;
  if (const std::size_t n = verdict.limits_failed(); n > 0)
    reported.push_back(fmt::format("{} of {} limits", n, verdict.limits.size()));
  add(reported, static_cast<double>(verdict.faults.size()), "other fault", "other faults");
  add(reported, number(run.reports, "device", "faded"), "force fade", "force fades");
  add(reported, static_cast<double>(run.fault_records.size()), "fault record", "fault records");
  return fmt::format("{}{}", verdict.passed() ? "PASSED" : "FAILED",
                     reported.empty() ? "" : fmt::format(" ({})", fmt::join(reported, ", ")));
}

}  // namespace voxtouch::cli
