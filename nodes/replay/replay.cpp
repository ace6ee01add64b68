#include "nodes/replay/replay.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

#include "core/scene/scene_file.hpp"
#include "nodes/replay/coupling_replay.hpp"
#include "nodes/replay/recording.hpp"
#include "nodes/replay/scene_replay.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/stamps.hpp"

namespace voxtouch::replay {
namespace {

double force_n(const msg::geometry_msgs_Wrench& w) noexcept {
  return std::hypot(w.force.x, w.force.y, w.force.z);
}

void add_sample(ForceStatistics& statistics, double force, bool touching) noexcept {
  statistics.most_n = std::max(statistics.most_n, force), statistics.squares += force * force;
  ++statistics.samples, statistics.touching += touching;
}

scene::Scene scene_of(const ReplayOptions& options, const Recording& recording) {
  if (!options.scene.empty())
    return scene::load_scene(options.scene);
  if (recording.scene_file.empty())
    throw std::runtime_error(fmt::format(
        "{} does not contain the scene file's name (no status of the rendering). Use --scene.",
        options.bag.string()));
  if (!std::filesystem::exists(recording.scene_file))
    throw std::runtime_error(fmt::format("Recorded scene file {} not found. Use --scene",
                                         recording.scene_file.string()));
  return scene::load_scene(recording.scene_file);
}

/// If the recorder started late, its first contact states when the session began; empty if there is
/// no earlier contact.
std::optional<std::int64_t> begin_of(const RecordedSession& session) {
  const auto first = std::ranges::find_if(session.samples, [](const auto& one) {
    return one.second.contact &&
           !(one.second.contact->flags & msg::contact_state::kFlagRefusedSample);
  });
  if (first == session.samples.end() || first->second.contact->scene_time_ns == 0)
    return std::nullopt;
  return runtime::ns_between(first->second.contact->scene_time_ns,
                             first->second.contact->sample_time_ns);
}

/// One recording through one scene.
class Run {
 public:
  Run(const ReplayOptions& options, const Recording& recording, const scene::Scene& scene)
      : options_(options),
        recording_(recording),
        scene_(scene),
        rendering_(scene),
        coupling_(scene_, recording.scene_hash.empty() || recording.scene_hash == scene.hash) {
    out_.bag = options.bag.string(), out_.rig = recording.rig, out_.lockstep = recording.lockstep;
    out_.recorded = {recording.scene, recording.scene_hash, recording.scene_file.string()};
    out_.replayed = {scene.name, scene.hash, std::filesystem::absolute(scene.file).string()};
    out_.notes = recording.warnings, out_.losses = recording.losses;
    follows_ = !recording.lockstep && recording.scene_hash == scene.hash;
    std::uint64_t commands = 0;
    for (const RecordedSession& session : recording.sessions)
      for (const auto& [number, sample] : session.samples)
        commands += sample.command.has_value() + sample.again.size();
    const auto figures = recording.figures.find("coupling");
    each_was_made_ = figures != recording.figures.end() &&
                     runtime::as_count(runtime::value_of(figures->second, "samples")) >= commands;
  }

  Replayed replay() {
    for (const RecordedSession& session : recording_.sessions)
      run(session);
    out_.designs = coupling_.compared(), out_.designs_differ = coupling_.differ();
    for (const std::string& note : coupling_.notes())
      out_.notes.push_back(note);
    report_losses();
    return std::move(out_);
  }

 private:
  void run(const RecordedSession& session) {
    ++out_.sessions;
    out_.device = session.device->model;
    if (session.described_anew)
      out_.missing.push_back(
          fmt::format("Session {} has several device descriptions without sample numbers: the "
                      "first is used throughout.",
                      session.id));
    change(session.id, std::nullopt);
    rendering_.begin_session(coupling::design::model_of(*session.device), begin_of(session));
    coupling_.begin_session(session, rendering_.bounds(), rendering_.demand());
    const RecordedSample* last = nullptr;
    const RecordedSample* first = nullptr;
    for (const auto& [number, sample] : session.samples) {
      change(session.id, number);
      if (sample.state)
        first = first ? first : &sample, last = &sample, ++out_.samples;
      answer(session, number, sample);
    }
    if (first)
      out_.duration_s +=
          runtime::seconds_between(first->state->sample_time_ns, last->state->sample_time_ns);
  }

  /// Applies all changes from this sample of the session on; without a sample those made before it
  /// began.
  void change(std::uint64_t session, std::optional<std::uint64_t> sample) {
    for (; next_change_ < recording_.changes.size(); ++next_change_) {
      const RecordedChange& made = recording_.changes[next_change_];
      const bool before = made.session == 0, past = sample_of_other(made.session, session);
      if (!before && !past && (made.session != session || !sample || made.from_sample > *sample))
        return;
      const auto last =
          std::find_if(recording_.changes.begin() + static_cast<std::ptrdiff_t>(next_change_),
                       recording_.changes.end(), [&](const RecordedChange& c) {
                         return c.session != made.session || c.from_sample != made.from_sample;
                       });
      const std::span together(
          &made, static_cast<std::size_t>(last - recording_.changes.begin()) - next_change_);
      apply(together);
      if (sample && together.size() == 1)
        coupling_.contact_displays(rendering_.bounds(), rendering_.demand());
    }
  }
  /// Whether the sample is of a session that ended before its change applied, or before the
  /// recorder started.
  bool sample_of_other(std::uint64_t of, std::uint64_t now) const {
    const auto place = [&](std::uint64_t id) {
      return std::ranges::find(recording_.sessions, id, &RecordedSession::id);
    };
    return of != 0 && of != now &&
           (place(of) == recording_.sessions.end() || place(of) < place(now));
  }

  /// Applies the first of the changes for the same sample.
  void apply(std::span<const RecordedChange> together) {
    const RecordedChange& made = together.front();
    ++out_.changes;
    if (!made.requested)
      return out_.missing.push_back(
          fmt::format("The request of the change at sample {} (\"{}\") is missing in the "
                      "recording: later samples cannot be compared.",
                      made.from_sample, made.sentence));
    if (const std::string why = rendering_.apply(together); !why.empty())
      return out_.missing.push_back(
          fmt::format("The change at sample {} (\"{}\") cannot be replayed: {}", made.from_sample,
                      made.sentence, why));
    if (made.action != msg::effect_change::kActionReload)
      return;
    const auto plan = std::ranges::find_if(recording_.plans, [&](const RecordedPlan& p) {
      return p.session == made.session && p.from_sample == made.from_sample;
    });
    if (plan == recording_.plans.end())
      out_.missing.push_back(
          fmt::format("The scene reloaded at sample {} is not identified in the recording: the "
                      "current file is used.",
                      made.from_sample));
    else if (plan->scene_hash != rendering_.scene_hash())
      out_.missing.push_back(
          fmt::format("The scene reloaded at sample {} had hash {}, the file has {} now: later "
                      "samples cannot be compared.",
                      made.from_sample, plan->scene_hash, rendering_.scene_hash()));
  }

  void answer(const RecordedSession& session, std::uint64_t number, const RecordedSample& sample) {
    if (!sample.state) {
      if (++out_.lost_states == 1)
        out_.missing.push_back(
            fmt::format("Device sample {} is missing in the recording, its reply is not: later "
                        "contacts may differ.",
                        number));
    } else if (!sample.rendered() && !recording_.lockstep) {
      return void(++out_.skipped);
    }
    std::optional<msg::ContactState> contact;
    if (sample.state && sample.external)
      rendering_.take_external(*sample.external, *sample.state);
    if (sample.state)
      contact =
          rendering_.answer(*sample.state, follows_ && sample.contact ? &*sample.contact : nullptr);
    if (contact && sample.contact)
      compare(*sample.contact, *contact);
    if (!sample.contact && sample.command)
      ++out_.lost_contacts;
    if (!contact)
      contact = sample.contact;  // a missing rendering does not affect the coupling
    if (!contact || (!sample.command && !recording_.lockstep))
      return;  // in lockstep every contact is answered
    const std::optional<msg::ForceCommand> command = coupling_.answer(*contact);
    if (!command)
      return report_once(
          fmt::format("From sample {} of session {} the recording has commands, but no coupling is "
                      "allowed now.",
                      number, session.id));
    if (sample.command)
      compare(*sample.command, *command);
    for (const msg::ForceCommand& more : sample.again)
      if (each_was_made_ || std::memcmp(&more, &*sample.command, sizeof more) != 0)
        compare(more, *coupling_.answer(*contact));
  }

  void compare(const msg::ContactState& recorded, msg::ContactState replayed) {
    if (!recording_.lockstep)
      replayed.time_spent_ns = recorded.time_spent_ns;  // measured, and nothing hangs on it
    if (options_.answers)
      out_.answers.contacts.try_emplace({recorded.session_id, recorded.sequence_number}, replayed);
    out_.contact.take(recorded, replayed);
    const double before = force_n(recorded.wrench), now = force_n(replayed.wrench);
    add_sample(out_.rendered.recorded, before, recorded.surface_hits + recorded.interior_hits > 0);
    add_sample(out_.rendered.replayed, now, replayed.surface_hits + replayed.interior_hits > 0);
    draw(out_.rendered_curves, recorded.sample_time_ns, before, now);
  }

  void compare(const msg::ForceCommand& recorded, const msg::ForceCommand& replayed) {
    if (options_.answers)
      out_.answers.commands[{recorded.session_id, recorded.sequence_number}].push_back(replayed);
    out_.command.take(recorded, replayed);
    const double before = force_n(recorded.wrench), now = force_n(replayed.wrench);
    add_sample(out_.returned.recorded, before, before > 0.0);
    add_sample(out_.returned.replayed, now, now > 0.0);
    draw(out_.returned_curves, recorded.sample_time_ns, before, now);
  }

  void draw(ForceCurves& curves, std::int64_t time_ns, double recorded_n, double replayed_n) {
    if (!options_.curves)
      return;
    if (!begin_ns_)
      begin_ns_ = time_ns;
    curves.t_s.push_back(runtime::seconds_between(*begin_ns_, time_ns));
    curves.recorded_n.push_back(recorded_n), curves.replayed_n.push_back(replayed_n);
  }

  void report_once(std::string sentence) {
    if (!said_)
      out_.missing.push_back(std::move(sentence));
    said_ = true;
  }

  /// Reports messages that the nodes counted and the bag lacks. If no message states the sample, it
  /// is unknown.
  void report_losses() {
    Held contacts, commands;
    for (const RecordedSession& session : recording_.sessions)
      for (const auto& [number, sample] : session.samples) {
        contacts.take(number, sample.contact ? 1 : 0, sample.rendered());
        commands.take(number, sample.command.has_value() + sample.again.size(),
                      sample.command.has_value());
      }
    contacts.count += out_.lost_contacts;
    report_lost("rendering", "contacts", contacts);
    report_lost("coupling", "commands", commands);
    report_restarts();
    report_designs();
    report_changes();
    report_refused();
    report_external();
  }

  /// Of one kind of answers, in the bag.
  struct Held {
    std::uint64_t count = 0;
    std::optional<std::uint64_t> first, first_without;  ///< samples of a session
    void take(std::uint64_t number, std::uint64_t answers, bool is_answered) noexcept {
      count += answers;
      if (answers > 0 && !first)
        first = number;
      if (!is_answered && !first_without)
        first_without = number;
    }
  };

  void report_lost(const std::string& node, std::string_view what, const Held& held) {
    const auto figures = recording_.figures.find(node);
    if (figures == recording_.figures.end())
      return out_.missing.push_back(fmt::format(
          "The recording has no status of the {}: it is unknown whether all its {} are recorded.",
          node, what));
    const std::uint64_t made = runtime::as_count(runtime::value_of(figures->second, "samples"));
    if (made <= held.count)
      return;
    // A node counts from its start. In the first session its first answered sample is the bag's
    // first one, unless the recorder started late.
    const std::uint64_t began =
        runtime::as_count(runtime::value_of(figures->second, "first_sample"));
    const bool came_late =
        recording_.sessions.size() == 1 &&
        runtime::as_count(runtime::value_of(figures->second, runtime::kSessions)) == 1 &&
        held.first && began < *held.first;
    const std::string begin =
        came_late ? fmt::format("its first for sample {}, the recording's first for sample {}",
                                began, *held.first)
                  : "of unknown samples";
    out_.missing.push_back(fmt::format(
        "The {} made {} {} more than recorded, {}: results may differ from sample {}.", node,
        made - held.count, what, begin, came_late ? began : held.first_without.value_or(0)));
  }

  void report_designs() {
    const auto figures = recording_.figures.find("coupling");
    if (figures == recording_.figures.end())
      return;
    const std::uint64_t made = runtime::as_count(runtime::value_of(figures->second, "designs"));
    if (made > recording_.designs)
      out_.missing.push_back(fmt::format(
          "The coupling used {} designs, recorded: {}. Results of the others may differ.", made,
          recording_.designs));
  }

  void report_changes() {
    const auto figures = recording_.figures.find("rendering");
    if (figures == recording_.figures.end())
      return;
    const std::uint64_t made = runtime::as_count(runtime::value_of(figures->second, "changes"));
    const std::size_t recorded = recording_.changes.size();
    if (made > recorded)
      out_.missing.push_back(
          fmt::format("The rendering made {} changes, recorded: {}.", made, recorded));
    if (made < recorded)
      out_.missing.push_back(
          fmt::format("The recording has {} changes, the rendering's last status counts {}: later "
                      "changes, or changes by other writers. All are replayed.",
                      recorded, made));
  }

  /// Reports restarts: no message contains the initial state of a process that started during a
  /// session.
  void report_restarts() {
    for (const std::string node : {"rendering", "coupling"})
      if (const auto processes = recording_.processes.find(node);
          recording_.sessions.size() == 1 && processes != recording_.processes.end() &&
          processes->second.size() > 1)
        out_.missing.push_back(
            fmt::format("The {} was restarted within the session. Its initial state is not "
                        "recorded: later results may differ.",
                        node));
  }

  void report_refused() {
    const auto figures = recording_.figures.find("logger");
    const std::uint64_t refused =
        figures == recording_.figures.end()
            ? 0
            : runtime::as_count(runtime::value_of(figures->second, "refused_records"));
    if (refused > 0)
      out_.notes.push_back(fmt::format("The logger refused {} records of other writers.", refused));
  }

  /// Reports missing values of the effect `external`. The rendering counts those of a ring, the bag
  /// has those of its sessions.
  void report_external() {
    std::uint64_t held = 0;
    for (const RecordedSession& session : recording_.sessions)
      for (const auto& [number, sample] : session.samples)
        held += sample.external.has_value();
    const auto figures = recording_.figures.find("rendering");
    const std::uint64_t taken =
        figures == recording_.figures.end()
            ? held
            : runtime::as_count(runtime::value_of(figures->second, "external_samples"));
    if (taken > held)
      out_.missing.push_back(
          fmt::format("The rendering used {} external wrenches that are not recorded, of unknown "
                      "samples: results may differ.",
                      taken - held));
  }

  const ReplayOptions& options_;
  const Recording& recording_;
  const scene::Scene& scene_;
  SceneReplay rendering_;
  CouplingReplay coupling_;
  Replayed out_;
  std::size_t next_change_ = 0;
  std::optional<std::int64_t> begin_ns_;
  bool said_ = false;
  /// Every command in the bag was made by the coupling. Otherwise DDS delivered one twice, which is
  /// not a second answer.
  bool each_was_made_ = false;
  bool follows_ = false;  ///< the springs that the recorded answers name
};

}  // namespace

double ForceStatistics::rms_n() const noexcept {
  return samples > 0 ? std::sqrt(squares / static_cast<double>(samples)) : 0.0;
}

Replayed replay(const ReplayOptions& options) {
  const Recording recording = read_recording(options.bag, options.rig);
  const scene::Scene scene = scene_of(options, recording);
  return Run(options, recording, scene).replay();
}

}  // namespace voxtouch::replay
