#include "nodes/validator/validator_node.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>

#include <fmt/format.h>

#include "core/reference/contact_validator.hpp"
#include "core/reference/reference_scene.hpp"
#include "core/reference/tool_validation.hpp"
#include "core/scene/scene_file.hpp"
#include "nodes/console/log.hpp"
#include "nodes/mesh_import/mesh_process.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/counters.hpp"
#include "nodes/runtime/node_host.hpp"
#include "nodes/runtime/role_binding.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::validator {
namespace {

/// In real time the validator only taps; in lockstep nothing it has to check may be lost.
const qos::Profile& contact_profile(const Options& options) {
  return options.lockstep ? qos::profile(qos::ProfileId::kLockstep)
                          : qos::profile(qos::ProfileId::kTap);
}

reference::ReportedContact to_report(const msg::ContactState& c) {
  reference::ReportedContact r;
  r.pose_WT = runtime::from_msg(c.object_pose);
  r.wrench = runtime::from_msg(c.contact_wrench);  // the reference covers contact only
  r.mean_normal = runtime::from_msg(c.mean_normal);
  r.deepest_depth_m = c.deepest_depth_m;
  r.coherence = c.coherence;
  r.surface_hits = c.surface_hits;
  r.interior_hits = c.interior_hits;
  r.latched =
      (c.flags & (msg::contact_state::kFlagLatched | msg::contact_state::kFlagRefusedSample)) != 0;
  r.fallback = (c.flags & msg::contact_state::kFlagFallback) != 0;
  return r;
}

reference::ReportedTool to_tool(const msg::ContactState& c) {
  return {.tool = runtime::from_msg(c.object_pose),
          .hand = runtime::from_msg(c.tool_pose),
          .wrench = runtime::from_msg(c.contact_wrench),
          .residual_m = c.residual_m,
          .constrained = (c.flags & msg::contact_state::kFlagConstrained) != 0,
          .not_converged = (c.flags & msg::contact_state::kFlagNotConverged) != 0,
          .not_initialised = (c.flags & msg::contact_state::kFlagNotInitialised) != 0,
          .returns_torque = std::isfinite(c.series_rad_per_nm)};
}

enum class ValidatorCounter : std::uint8_t { kFirstChecked, kExcused, kSkipped };
constexpr auto kValidatorTable = [] {
  using enum ValidatorCounter;
  using enum runtime::Counting;
  return std::to_array<runtime::CounterRow<ValidatorCounter>>({
      {kFirstChecked, "first_checked", "sample number", kFirst},
      {kExcused, "excused", "samples"},  // due since the first, but of a kind that is not evaluated
      {kSkipped, "skipped", "samples"},  // due since the first, but missed: the validator was busy
  });
}();

class ValidatorNode final : public runtime::Step<msg::ContactState, msg::ValidationReport> {
 public:
  ValidatorNode(const Options& options, const scene::Scene& scene)
      : options_(options),
        name_(scene.name),
        hash_(scene.hash),
        scene_(scene),
        reference_(scene),
        host_("validator", options, runtime::NodeHost::Kind::kTap),
        plans_(host_.reader<bus::LatchedReader<msg::ScenePlan>>(qos::kScenePlan)),
        contacts_(host_.participant(), qos::kContactState, options.rig, contact_profile(options)),
        reports_(host_.writer<msg::ValidationReport>(qos::kValidation)),
        rendering_("rendering", {&plans_.following(), &contacts_.following()}) {
    host_.link_reader(qos::kScenePlan, plans_);
    host_.link_reader(qos::kContactState, contacts_);
    host_.link_writer(qos::kValidation, reports_);
  }

  int run(const std::atomic<bool>& stop) { return host_.run(*this, contacts_, reports_, stop); }

 private:
  /// The part of a plan that the validation uses.
  struct Built {
    std::uint64_t session = 0, from_sample = 0;
    std::string scene, hash;
    double voxel_size_m = 0.0, shell_gap_m = 0.0;
    bool same_scene(const Built& other) const {
      return hash == other.hash && voxel_size_m == other.voxel_size_m &&
             shell_gap_m == other.shell_gap_m;
    }
  };

  /// A plan of the current session reports a change: it applies from its first sample on.
  void take(const msg::ScenePlan& plan) {
    Built built{plan.session_id, plan.from_sample,  plan.scene,
                plan.scene_hash, plan.voxel_size_m, plan.largest_shell_gap_m};
    if (validator_ && built.session == host_.session_in_loop())
      next_ = std::move(built);
    else
      start_session(std::move(built));
  }

  reference::ValidatorSettings settings() const {
    const double edge_m = built_.voxel_size_m;
    reference::ValidatorSettings settings;
    settings.edge_m = edge_m;
    settings.chord_error_m = reference_.chord_error_m();
    settings.shell_gap_m = std::min(built_.shell_gap_m, std::sqrt(3.0) * edge_m);
    settings.shell_offset_m =
        scene_.shell == scene::ShellKind::kNaive ? std::sqrt(3.0) / 2 * edge_m : 0.0;
    return settings;
  }

  /// The plan states what the rendering built: another scene file is a disagreement before the
  /// first sample.
  void start_session(Built built) {
    if (built.hash != scene_.hash)
      console::log(
          "warning: validator: the rendering runs a different version of scene '{}' than {}\n",
          built.scene, scene_.file.string());
    built_ = std::move(built);
    next_.reset();
    blind_ = false;
    validator_ = std::make_unique<reference::ContactValidator>(settings());
    forget_disagreement();
    host_.begin_session(built_.session);
    publish_counts();
    host_.session().begin(built_.session);
  }

  /// The rendering uses another scene from here on. Another file is read again. If it cannot be
  /// built as in the rendering, samples are not evaluated.
  void follow_change() {
    const bool another_file = next_->hash != built_.hash, another = !next_->same_scene(built_);
    built_ = std::move(*next_);
    next_.reset();
    if (!another)
      return;
    if (another_file) {
      const runtime::Heartbeat::Busy busy(host_.heartbeat(), 60'000'000'000);  // large meshes
      try {
        scene::Scene scene = scene::load_scene(options_.scene);
        blind_ = scene.hash != built_.hash;
        mesh_import::dry_run_reading(scene);
        if (!blind_)
          reference_ = reference::ReferenceScene(scene), scene_ = std::move(scene);
      } catch (const std::exception&) {
        blind_ = true;
      }
      if (blind_)
        console::log(
            "warning: validator: {} is not the rendering's current scene; validation stops\n",
            options_.scene.string());
    }
    if (!blind_)
      validator_->change(settings());
  }

  void listen() override {
    plans_.take([this](const msg::ScenePlan& plan) { take(plan); });
  }
  bool ready() const noexcept override { return validator_ != nullptr; }

  std::optional<msg::ValidationReport> step(const msg::ContactState& contact) noexcept override {
    if (next_ && contact.sequence_number >= next_->from_sample)
      follow_change();
    if (!reference::is_checked(contact.sequence_number, options_.every))
      return {};
    count_skipped(contact.sequence_number);
    if (blind_)
      return {};
    if (contact.flags & unlike()) {
      if (!std::isnan(counters_[ValidatorCounter::kFirstChecked]))
        counters_.note(ValidatorCounter::kExcused);
      return {};
    }
    unread_.store(reports_.matched_count() == 0, std::memory_order_relaxed);
    if (unread_)
      return {};  // no verdict without a reader
    reference_.move_to(static_cast<double>(contact.scene_time_ns) * 1e-9);
    reference::GapResult gap;
    validation_ =
        scene_.virtual_tool() ? validate_tool(contact, gap) : validate_contact(contact, gap);
    return report_of(contact, gap);
  }

  void wrote(const msg::ContactState& contact, const msg::ValidationReport&) noexcept override {
    counters_.note(ValidatorCounter::kFirstChecked, static_cast<double>(contact.sequence_number));
    if (validation_.verdict == reference::Verdict::kDisagree)
      note(contact.sequence_number, validation_);
    publish_counts();
  }

  void end() override {
    if (!options_.lockstep || host_.peer_lost())
      return;
    const runtime::Heartbeat::Busy busy(host_.heartbeat(), 6'000'000'000);
    reports_.wait_for_acknowledgments(DDS_SECS(5));
  }

  /// Samples that were due between the last due one and `sequence`.
  void count_skipped(std::uint64_t sequence) noexcept {
    if (!std::isnan(counters_[ValidatorCounter::kFirstChecked]) && sequence > last_due_) {
      const std::uint64_t periods = (sequence - last_due_) / options_.every;
      counters_.note(ValidatorCounter::kSkipped, static_cast<double>(periods - 1));
    }
    last_due_ = sequence;
  }

  /// Flags of a contact that cannot be evaluated. During a fade the displayed contact belongs to
  /// neither scene. The virtual tool reported with a refused sample is that of another one.
  std::uint32_t unlike() const {
    return msg::contact_state::kFlagFading |
           (scene_.virtual_tool() ? msg::contact_state::kFlagRefusedSample : 0U);
  }

  /// Lends the text of `validation_`.
  msg::ValidationReport report_of(const msg::ContactState& contact,
                                  const reference::GapResult& gap) const {
    const reference::ValidationCounts& counts = validator_->counts();
    msg::ValidationReport m{};
    m.session_id = contact.session_id;
    m.sequence_number = contact.sequence_number;
    m.sample_time_ns = contact.sample_time_ns;
    m.gap_m = gap.gap_m;
    m.reported_depth_m = contact.deepest_depth_m;
    m.depth_error_m = validation_.depth_error_m;
    m.direction_error_rad = validation_.direction_error_rad;
    m.surface_hits = contact.surface_hits;
    m.interior_hits = contact.interior_hits;
    m.verdict = static_cast<std::uint32_t>(validation_.verdict);
    m.cause = static_cast<std::uint32_t>(validation_.cause);
    m.checked = counts.checked;
    m.decided = counts.decided;
    m.agree = counts.agree;
    m.in_band = counts.in_band;
    m.disagree = counts.disagree;
    m.explanation = runtime::lend(validation_.explanation);
    return m;
  }

  reference::Validation validate_contact(const msg::ContactState& contact,
                                         reference::GapResult& gap) {
    const reference::ReportedContact report = to_report(contact);
    gap = reference_.gap(report.pose_WT);
    return validator_->validate(gap, report);
  }
  reference::Validation validate_tool(const msg::ContactState& contact, reference::GapResult& gap) {
    const reference::ReportedTool report = to_tool(contact);
    gap = reference_.gap(report.tool);
    const bool rubs = std::any_of(
        scene_.effects.begin(), scene_.effects.end(),
        [](const effects::EffectSpec& effect) { return effect.kind->friction != nullptr; });
    return validator_->validate(gap, reference_.gap(report.hand),
                                {.reach_m = reference_.tool_reach_m(), .rubs = rubs}, report);
  }

  void note(std::uint64_t sequence, const reference::Validation& validation) {
    const std::lock_guard lock(mutex_);
    if (first_disagreement_.empty())
      first_disagreement_ =
          fmt::format("sample {} ({}): {}", sequence,
                      validation.cause == reference::Cause::kReference ? "fault of the reference"
                                                                       : "fault of the rendering",
                      validation.explanation);
  }

  void forget_disagreement() {
    const std::lock_guard lock(mutex_);
    first_disagreement_.clear();
  }

  void publish_counts() {
    const std::lock_guard lock(mutex_);
    counts_ = validator_->counts();
  }

  void report(runtime::NodeRegistry& registry, runtime::NodeReport& report,
              runtime::StatusText& status) override {
    using runtime::StatusPriority;
    const std::lock_guard lock(mutex_);
    report.values = {{"scene", name_}, {"scene_hash", hash_}};
    report.figures = {{"checked", {counts_.checked, "samples"}},
                      {"decided", {counts_.decided, "samples"}},
                      {"compared", {counts_.compared, "samples"}},
                      {"agree", {counts_.agree, "samples"}},
                      {"in_band", {counts_.in_band, "samples"}},
                      {"disagree", {counts_.disagree, "samples"}},
                      {"by_rendering", {counts_.rendering, "samples"}},
                      {"by_reference", {counts_.reference, "samples"}}};
    counters_.report_to(report.figures);
    rendering_.update(registry, std::nullopt);
    report.figures["foreign_samples"] = {rendering_.refused(), "samples"};
    report.values["foreign_writers"] = rendering_.refused_writers();
    const std::string missing =
        host_.report_session(registry, report, "the rendering", counts_.checked > 0);
    const double skipped = counters_[ValidatorCounter::kSkipped];
    status.set(
        StatusPriority::kProgress,
        unread_
            ? "idle: the verdicts have no reader"
            : "no disagreement" +
                  (skipped > 0.0
                       ? fmt::format(
                             "; {:.0f} due samples skipped: a check takes longer than its period",
                             skipped)
                       : ""));
    if (!missing.empty())
      status.set(StatusPriority::kWaiting, "waiting for " + missing);
    status.set(StatusPriority::kForeign, rendering_.diagnostic(registry));
    if (!first_disagreement_.empty())
      status.set(StatusPriority::kFault, "first disagreement: " + first_disagreement_);
  }

  const Options& options_;
  std::string name_, hash_;  ///< of the file as this ring was started with
  scene::Scene scene_;
  reference::ReferenceScene reference_;
  runtime::NodeHost host_;
  bus::LatchedReader<msg::ScenePlan> plans_;
  bus::FollowedReader<msg::ContactState> contacts_;
  bus::Writer<msg::ValidationReport> reports_;
  runtime::RoleBinding rendering_;  ///< only its samples are evaluated
  std::unique_ptr<reference::ContactValidator> validator_;
  reference::Validation validation_;  ///< of the sample that is answered
  Built built_;                       ///< reference in use
  std::optional<Built> next_;         ///< from its first sample on
  std::uint64_t last_due_ = 0;        ///< sequence number of the last sample that was due
  bool blind_ = false;                ///< no reference for the rendering's scene
  std::atomic<bool> unread_ = false;  ///< the verdicts had no reader when the last one was due
  runtime::Counters<kValidatorTable> counters_;
  std::mutex mutex_;
  reference::ValidationCounts counts_;
  std::string first_disagreement_;
};

}  // namespace

int run(const Options& options, const std::atomic<bool>& stop) {
  const scene::Scene scene = scene::load_scene(options.scene);
  mesh_import::dry_run_reading(scene);
  ValidatorNode node(options, scene);
  return node.run(stop);
}

}  // namespace voxtouch::validator
