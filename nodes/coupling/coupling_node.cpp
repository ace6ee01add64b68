#include "nodes/coupling/coupling_node.hpp"

#include <algorithm>
#include <mutex>
#include <optional>

#include <fmt/format.h>

#include "core/fitting/design_problem.hpp"
#include "core/scene/scene_file.hpp"
#include "core/types/latest_value.hpp"
#include "nodes/bus/latched_reader.hpp"
#include "nodes/bus/wait_set.hpp"
#include "nodes/coupling/contact_coupling.hpp"
#include "nodes/coupling/design_message.hpp"
#include "nodes/coupling/fitting.hpp"
#include "nodes/faults/fault_recorder.hpp"
#include "nodes/faults/force_lock.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/device_message.hpp"
#include "nodes/runtime/duty.hpp"
#include "nodes/runtime/held_start.hpp"
#include "nodes/runtime/housekeeping.hpp"
#include "nodes/runtime/pair_reader.hpp"
#include "nodes/runtime/participation.hpp"
#include "nodes/runtime/recorder_gate.hpp"
#include "nodes/runtime/role_binding.hpp"

namespace voxtouch::coupling_node {
namespace {

using runtime::NodeState;
constexpr auto kRelaxed = std::memory_order_relaxed;

/// One contact and what it was answered with, for the record of a fault.
struct ContactSeen {
  msg::ContactState contact;
  msg::ForceCommand command;
};

std::vector<faults::FaultMessage> messages_of(const std::vector<ContactSeen>& rows) {
  std::vector<faults::FaultMessage> messages;
  for (const ContactSeen& row : rows) {
    messages.push_back(faults::message_of(0, row.contact.sample_time_ns, row.contact));
    messages.push_back(faults::message_of(1, row.contact.sample_time_ns, row.command));
  }
  return messages;
}

/// What bounds each loop of the thread that answers contacts. `run`: it is the process, each cycle
/// looks at `stop`. Contacts in a cycle: kMaxTakes; in real time the history holds one.
/// Descriptions and plans in a cycle: kMaxTakes, of those who are bound, or of anybody while none
/// is and no force can come of it. A fit, some tenths of a second, where a session begins and, in
/// lockstep, where it changes; else it runs beside the loop. One lock, where a fit is adopted or a
/// description has come.
class CouplingNode {
 public:
  CouplingNode(const Options& options, const scene::Scene& scene)
      : options_(options),
        scene_(scene),
        name_(runtime::name_in_ring(options.standby, "coupling")),
        recorder_(options),
        participant_(options.participant(name_)),
        descriptions_(participant_, qos::kDeviceDescription, options.rig),
        plans_(participant_, qos::kScenePlan, options.rig),
        contacts_(participant_, qos::kContactState, options.rig,
                  qos::profile_in(qos::kContactState, options.mode())),
        commands_(participant_, qos::kForceCommand, options.rig,
                  qos::profile_in(qos::kForceCommand, options.mode())),
        designs_(participant_, qos::kCouplingDesign, options.rig,
                 qos::profile_in(qos::kCouplingDesign, options.mode())),
        duty_(participant_, qos::kForceCommand, options.rig, "coupling",
              runtime::in_mode(options.standby, options.lockstep),
              {{"scene_hash", "design_status", "design_kind"},
               {"design_cutoff_hz", "design_gain", "design_injected_damping_ns_per_m",
                "design_shown_n_per_m", "design_critical_n_per_m"}}),
        wait_set_(participant_),
        device_("device", {&descriptions_.following()}),
        rendering_("rendering", {&plans_.following()}, &contacts_),
        fitting_(scene),
        coupling_(scene.device),
        faults_(options.fault_records, {name_, options.rig, {}},
                {faults::topic_of<msg::ContactState>("/" + options.rig + "/rendering/contact"),
                 faults::topic_of<msg::ForceCommand>("/" + options.rig + "/coupling/command")},
                messages_of),
        keeper_(participant_, options.rig) {
    wait_set_.attach(descriptions_.condition());
    wait_set_.attach(plans_.condition());
    contacts_.attach_to(wait_set_);
    links_ = {runtime::link_of_reader(qos::kDeviceDescription, descriptions_),
              runtime::link_of_reader(qos::kScenePlan, plans_),
              runtime::link_of_reader(qos::kContactState, contacts_),
              runtime::link_of_writer(qos::kForceCommand, commands_),
              runtime::link_of_writer(qos::kCouplingDesign, designs_)};
  }

  int run(const std::atomic<bool>& stop) {
    runtime::flush_denormals();
    runtime::Housekeeping housekeeping(
        participant_, name_, options_,
        [this](runtime::NodeRegistry& registry, runtime::NodeReport& report) {
          look(registry, report);
        },
        {{"its loop", [this] { return heartbeat_.sign(); }}});
    stop_ = &stop;
    housekeeping_ = &housekeeping;
    runtime::enter_loop(options_.realtime);
    while (!over()) {
      heartbeat_.beat();
      wait_set_.wait(coupling_.runs()
                         ? 50'000'000
                         : 5'000'000);  // no message tells that the housekeeping has bound somebody
      listen();
      if (auto fitted = fitting_.poll())
        adopt(std::move(*fitted));
      if (lock_.opened() && coupling_.runs())
        begin_anew();
      if (design_unsaid_ && duty_.acts_now())
        say_design();
      if (device_fault_.exchange(false, kRelaxed))
        faults_.keep_too("a fault that the device saw");
      for (int i = 0; i < contacts_.kMaxTakes && !over() && answer_one(); ++i) {
      }
    }
    session_.stop();
    return housekeeping.peer_lost() ? 1 : 0;
  }

 private:
  /// Asked to stop, or in lockstep a peer is lost.
  bool over() const noexcept { return stop_->load(kRelaxed) || housekeeping_->peer_lost(); }

  fitting::FittedCoupling fit() {
    constexpr std::int64_t kMaxFitNs =
        30'000'000'000;  // some tenths of a second on a machine that has time
    const runtime::Heartbeat::Busy busy(heartbeat_, kMaxFitNs);
    return fitting_.fit();
  }

  /// A session is followed where the device's status and description and the rendering's plan, each
  /// of the participant that is bound, name the same.
  void listen() {
    descriptions_.take([this](const msg::DeviceDescription& d) { receive(d); });
    plans_.take([this](const msg::ScenePlan& p) {
      fitting_.set_plan(p);
      voxel_m_.store(p.voxel_size_m, kRelaxed);
    });
    changed_ = fitting_.changed() || changed_;
    both_known_.store(descriptions_.current() && plans_.current(), std::memory_order_release);
    if (!changed_ || !recorder_.open() || !both_known_.load(kRelaxed) ||
        fitting_.session() != device_.session())
      return;
    changed_ = false;
    follow_change();
  }

  /// Numbers that cannot be a device's change nothing: what runs goes on as it was designed.
  void receive(const msg::DeviceDescription& message) {
    const DeviceDescription device = runtime::from_msg(message);
    std::string wrong = what_is_wrong(device);
    if (wrong.empty())
      fitting_.set_device(device, message.session_id);
    const std::lock_guard lock(running_mutex_);
    wrong_ = std::move(wrong);
  }

  /// A new session starts with its own fit. A change within one is fitted beside the loop, but for
  /// lockstep, where the sample from which it holds must not depend on how fast the fit is.
  /// Meanwhile the coupling that runs is judged by what has come: one that does not fit any more
  /// commands nothing from here on.
  void follow_change() {
    // A rendering that took another's place may run another scene: nothing of it is felt before the
    // fit.
    if (fitting_.session() != session_in_loop_ || rendering_.tenure() != plan_tenure_)
      return start_session();
    if (options_.lockstep && fitting_.outdated())
      return adopt(fit());
    judge_running();
    if (fitting_.outdated())
      fitting_.begin();
  }

  void judge_running() {
    std::string refusal = fitting_.judge(running_.fitted);
    // One that would fit again for another device or contact waits for its own fit.
    if (refusal.empty() == running_.fitted.refusal.empty() ||
        (refusal.empty() && fitting_.outdated()))
      return;
    fitting::FittedCoupling judged = running_.fitted;
    judged.refusal = std::move(refusal);
    adopt(std::move(judged));
  }

  void start_session() {
    const std::uint64_t session = *fitting_.session();
    plan_tenure_ = rendering_.tenure();
    contacts_.begin_session(session);
    heard_other_.store(false, kRelaxed);
    coupling_.begin_session(fitting_.device().timing);
    faults_.reserve(1.0 / fitting_.device().timing.period_s);
    session_in_loop_ = session;
    last_answered_.reset();
    stiffness_.store(0.0, kRelaxed);
    adopt(fit());
    if (coupling_.runs())
      session_.begin(session);
  }

  /// From here on this coupling runs. One that must not run leaves the device without commands,
  /// which fades its force.
  void adopt(fitting::FittedCoupling fitted) {
    if (duty_.acts_now())
      publish_design(designs_, fitted, session_in_loop_, coupling_.period_s(), fitting_.external());
    else
      design_unsaid_ = true;  // the one that acts says its own
    if (coupling_.runs() && !fitted.refusal.empty())
      faults_.keep("what came did not fit the device any more");
    coupling_.adopt(fitted, fitting_.device());
    const std::lock_guard lock(running_mutex_);
    running_ = {std::move(fitted), fitting_.device().translation.max_stiffness, running_.made + 1};
  }

  void say_design() {
    design_unsaid_ = false;
    publish_design(designs_, running_.fitted, session_in_loop_, coupling_.period_s(),
                   fitting_.external());
  }

  /// The last sample that there can be, by the time since the last contact: who answers a later one
  /// must not take over with it.
  std::uint64_t newest_sample() const noexcept {
    constexpr double kShortestPeriod = 0.8;  // of the nominal one
    if (options_.lockstep || !last_answered_)
      return ~std::uint64_t{0};
    const double since_s = 1e-9 * static_cast<double>(runtime::monotonic_ns() - last_contact_ns_);
    return *last_answered_ + 1 +
           static_cast<std::uint64_t>(
               std::clamp(since_s / (kShortestPeriod * coupling_.period_s()), 0.0, 1e12));
  }

  /// Answers one contact; false where none waits.
  bool answer_one() {
    heartbeat_.beat();
    msg::ContactState contact;
    if (!contacts_.take(contact, nullptr, newest_sample()))
      return false;
    // What another participant says of itself has yet to be judged before its contacts are felt.
    if (contact.session_id != session_in_loop_ || !coupling_.runs() || !both_known_.load(kRelaxed))
      return true;
    // A write that DDS could not end in time is made again in lockstep, and who had it already has
    // it twice. Nothing more than that: a forged number must not keep the rightful ones that follow
    // from being felt.
    if (options_.lockstep && last_answered_ == contact.sequence_number)
      return true;
    // A plan that holds from this sample on is here, for the rendering waited for that: it must not
    // be used a sample later.
    if (options_.lockstep)
      listen();
    if (coupling_.runs() && contact.session_id == session_in_loop_)
      answer(contact);  // what came may have left none that may run
    return true;
  }

  void answer(const msg::ContactState& contact) noexcept {
    last_answered_ = contact.sequence_number;
    if (!options_.lockstep)
      last_contact_ns_ = runtime::monotonic_ns();
    const coupling::CouplingCounters before = coupling_.counters();
    msg::ForceCommand command = coupling_.answer(contact);
    const bool acts = duty_.acts(contact.session_id, contact.sequence_number,
                                 [this](const msg::ForceCommand& theirs) { heed(theirs); });
    if (lock_.engaged())
      command.wrench = {}, command.status |= msg::force_command::kStatusLocked;
    if (acts) {
      commands_.write_until(command, [this] {
        heartbeat_.beat();
        return !options_.lockstep || over();
      });
      if (samples_.load(kRelaxed) == 0)
        first_sample_.store(contact.sequence_number, kRelaxed);
      samples_.fetch_add(1, kRelaxed);
    }
    note(contact.stiffness_bound_n_per_m);
    faults_.push({contact, command});
    keep_what_went_wrong(before, coupling_.counters());
  }

  /// A command of the one that acts. Where that one locks itself so does this one: a takeover opens
  /// no lock.
  void heed(const msg::ForceCommand& theirs) noexcept {
    const bool locked = (theirs.status & msg::force_command::kStatusLocked) != 0;
    if (locked && !they_are_locked_ && !duty_.acts_now() && !lock_.engaged())
      lock_.engage("the coupling that this one stands by for has locked itself");
    they_are_locked_ = locked;
    heard_other_.store(true, kRelaxed);
  }

  /// As at the begin of a session: no debt, and the force ramps in. Allocates, beside the answers,
  /// while no force is commanded.
  void begin_anew() {
    coupling_.begin_session(fitting_.device().timing);
    coupling_.adopt(running_.fitted, fitting_.device());
  }

  void keep_what_went_wrong(const coupling::CouplingCounters& before,
                            const coupling::CouplingCounters& now) noexcept {
    if (now.faults != before.faults)
      faults_.keep("a contact came late or could not be used");
    if (now.not_finite != before.not_finite)
      faults_.keep("a command was no number");
    const auto debt = [](double lowest_j, double was_j, double bound_j) {
      return lowest_j < was_j && bound_j > 0.0 ? -lowest_j / bound_j : 0.0;
    };
    const double voxel_m = voxel_m_.load(kRelaxed);
    const double most =
        std::max(debt(now.lowest_energy_j, before.lowest_energy_j,
                      coupling::energy_bound_j(now.most_force_n, now.longest_way_m, voxel_m)),
                 debt(now.lowest_energy_rotation_j, before.lowest_energy_rotation_j,
                      coupling::energy_bound_rotation_j(now.most_torque_nm, now.longest_turn_rad,
                                                        now.most_force_n, voxel_m)));
    if (most > 1.0)
      faults_.keep("the coupling gave away more energy than a sound contact shows");
    if (most > kOutOfHand &&
        std::min(now.lowest_energy_j, now.lowest_energy_rotation_j) < -kNoticeableJ)
      lock_.engage(
          "the coupling gave away five times the energy that a sound contact may show, so the "
          "contact is unstable");
  }

  void note(double stiffness_n_per_m) noexcept {
    counted_.put(coupling_.counters());
    if (stiffness_n_per_m > stiffness_.load(kRelaxed))
      stiffness_.store(stiffness_n_per_m, kRelaxed);
  }

  void fill(runtime::NodeReport& report, double displayed_n_per_m) {
    coupling::CouplingCounters& c = last_counted_;
    counted_.take(c);
    const double voxel_m = voxel_m_.load();
    report.values = {{"scene", scene_.name}, {"scene_hash", scene_.hash}};
    report.figures = {
        {"samples", {samples_.load(), "samples"}},
        {"clamped_inputs", {c.clamped, "samples"}},
        {"capped_samples", {c.capped, "samples"}},
        {"bounded_samples", {c.bounded, "samples"}},
        {"passivity_samples", {c.controlled, "samples"}},
        {"passivity_most_damping_ns_per_m", {c.most_damping_ns_per_m, "Ns/m"}},
        {"lowest_energy_j", {c.lowest_energy_j, "J"}},
        {"lowest_energy_rotation_j", {c.lowest_energy_rotation_j, "J"}},
        {"energy_bound_j",
         {coupling::energy_bound_j(c.most_force_n, c.longest_way_m, voxel_m), "J"}},
        {"energy_bound_rotation_j",
         {coupling::energy_bound_rotation_j(c.most_torque_nm, c.longest_turn_rad, c.most_force_n,
                                            voxel_m),
          "J"}},
        {"first_sample", {first_sample_.load(), "sample number"}},
        {"faults", {c.faults, "samples"}},
        {"stiffness_bound_max_n_per_m", {stiffness_.load(), "N/m"}},
        {"stiffness_at_hand_n_per_m", {displayed_n_per_m, "N/m"}},
        {"device_max_stiffness_n_per_m", {running_.device_max_stiffness_n_per_m, "N/m"}}};
    if (running_.made > 0)
      describe(running_.fitted.design, report);
    report.figures["foreign_samples"] = {device_.refused() + rendering_.refused(), "samples"};
  }

  /// The coupling runs, and nothing is missing.
  std::string running_sentence(double displayed_n_per_m) const {
    // The device's limit is compared with the total stiffness of the contact, not with one point's.
    if (displayed_n_per_m > running_.device_max_stiffness_n_per_m)
      return fmt::format(
          "the contact shows up to {:.0f} N/m, more than the device's {:.0f} N/m: lower the "
          "contact's stiffness or "
          "coupling.gain, or let it be designed (coupling: {{design: auto}})",
          displayed_n_per_m, running_.device_max_stiffness_n_per_m);
    return fmt::format("{} runs, {}", running_.fitted.spec.kind, status_word(running_.fitted));
  }

  void look(runtime::NodeRegistry& registry, runtime::NodeReport& report) {
    const std::lock_guard lock(running_mutex_);
    const double displayed_n_per_m =
        fitting::stiffness_at_hand_n_per_m(running_.fitted.spec, scene_.device, stiffness_.load());
    fill(report, displayed_n_per_m);
    rendering_.report_to(report, registry);
    device_.update(registry, std::nullopt);
    watch_device(registry);
    faults_.report_to(report);
    keeper_.listen(device_.session(), lock_);
    if (device_.bound())
      rendering_.update(registry, device_.session());
    recorder_.look(registry, commands_);
    std::string missing = session_.report_to(
        report, options_, registry, links_,
        recorder_.open() ? "a device and its scene's plan" : "the logger", samples_.load() > 0);
    if (missing.empty() && !both_known_.load(std::memory_order_acquire)) {
      missing = "a device and its scene's plan";
      report.session_id = 0, report.state = NodeState::kStarting;
    }
    if (!duty_.acts_now() && samples_.load() == 0 && !heard_other_.load(kRelaxed))
      report.state = NodeState::kStarting;  // it cannot stand by yet
    const std::string duty = duty_.look(registry, report);
    std::string trouble = device_.trouble(registry);
    if (trouble.empty())
      trouble = rendering_.trouble(registry);
    if (trouble.empty())
      trouble = duty;
    if (!wrong_.empty())
      trouble = "the device's description is refused: " + wrong_;
    report.message = session_.stopped() ? "stopped"
                     : !trouble.empty() ? trouble
                     : !missing.empty() ? "waiting for " + missing
                                        : running_sentence(displayed_n_per_m);
    lock_.report_to(report, !session_.stopped());
    if (running_.made == 0 || running_.fitted.refusal.empty())
      return;
    report.state = NodeState::kFailed;
    report.message = running_.fitted.refusal + " No force is commanded.";
  }

  /// A device that hangs, or has gone without a last word, tells of no fault any more.
  void watch_device(const runtime::NodeRegistry& registry) {
    if (const auto& bound = device_.participant()) {
      last_device_ = *bound;
      if (const runtime::NodeReport* device = registry.report_of(*bound);
          device && device_faults_.see(*device))
        device_fault_.store(true, kRelaxed);
    }
    const std::vector<runtime::Hung> hung = registry.hung();
    const bool silent =
        std::ranges::find(hung, last_device_, &runtime::Hung::participant) != hung.end();
    if (silent && !std::exchange(device_silent_, silent))
      device_fault_.store(true, kRelaxed);
    device_silent_ = silent;
  }

  void describe(const coupling::design::Design& design, runtime::NodeReport& report) const {
    const coupling::CouplingSpec& spec = running_.fitted.spec;
    report.values["design_status"] = status_word(running_.fitted);
    report.values["design_kind"] = spec.kind;
    report.figures["designs"] = {running_.made, "designs"};
    report.figures["design_cutoff_hz"] = {spec.kind == "shaping_filter" ? spec.cutoff_hz : 0.0,
                                          "Hz"};
    report.figures["design_gain"] = {spec.gain, "1"};
    report.figures["design_injected_damping_ns_per_m"] = {spec.injected_damping_ns_per_m, "Ns/m"};
    report.figures["design_shown_n_per_m"] = {design.translation.shown_stiffness, "N/m"};
    report.figures["design_critical_n_per_m"] = {design.translation.critical_stiffness, "N/m"};
    report.figures["design_gain_margin"] = {design.translation.gain_margin, "1"};
    report.values["design_worst_case"] = design.translation.worst_case_text;
  }

  const Options& options_;
  const scene::Scene& scene_;
  const std::string name_;
  runtime::RecorderGate recorder_;
  bus::Participant participant_;
  bus::LatchedReader<msg::DeviceDescription> descriptions_;
  bus::LatchedReader<msg::ScenePlan> plans_;
  runtime::PairReader<msg::ContactState> contacts_;
  bus::Writer<msg::ForceCommand> commands_;
  bus::Writer<msg::CouplingDesign> designs_;
  runtime::Duty<msg::ForceCommand> duty_;
  bus::WaitSet wait_set_;
  runtime::RoleBinding device_, rendering_;
  std::vector<runtime::Link> links_;
  Fitting fitting_;
  ContactCoupling coupling_;
  faults::FaultRecorder<ContactSeen> faults_;
  faults::OthersFaults device_faults_;
  static constexpr double kOutOfHand = 5.0;     ///< times what a sound contact may show
  static constexpr double kNoticeableJ = 0.01;  ///< a stylus of 50 g at 0.6 m/s
  faults::ForceLock lock_;
  faults::LockKeeper keeper_;
  std::optional<bus::Guid> last_device_;   ///< that was bound
  bool device_silent_ = false;             ///< at the last look
  std::atomic<bool> device_fault_{false};  ///< for the loop to keep what it saw
  /// What other threads may ask about; the loop takes the lock only where a fit is adopted.
  struct Running {
    fitting::FittedCoupling fitted;
    double device_max_stiffness_n_per_m = 0.0;
    std::uint64_t made = 0;
  } running_;
  std::mutex running_mutex_;
  std::string wrong_;     ///< of the device's last description; under the same lock
  bool changed_ = false;  ///< description or plan have changed and are not followed yet
  std::atomic<bool> both_known_{false};  ///< both are there of those who are bound
  std::uint64_t session_in_loop_ = 0;
  std::optional<std::uint64_t> last_answered_;  ///< number of the contact, in this session
  std::int64_t last_contact_ns_ = 0;            ///< when that was, by the clock of this host
  std::uint64_t plan_tenure_ =
      0;  ///< of the rendering whose plan the session was begun with; its standby goes on with it
  bool design_unsaid_ = false;    ///< what runs has not been published, for another coupling acts
  bool they_are_locked_ = false;  ///< the other coupling, as it said last
  std::atomic<bool> heard_other_{false};  ///< in this session
  std::atomic<std::uint64_t> samples_{0}, first_sample_{0};
  std::atomic<double> voxel_m_{0.0}, stiffness_{0.0};
  LatestValue<coupling::CouplingCounters> counted_;  ///< from the loop to the housekeeping
  coupling::CouplingCounters last_counted_;
  const std::atomic<bool>* stop_ = nullptr;
  const runtime::Housekeeping* housekeeping_ = nullptr;
  runtime::Heartbeat heartbeat_;
  runtime::Session session_;
};

}  // namespace

int run(const Options& options, const std::atomic<bool>& stop) {
  const scene::Scene scene = scene::load_scene(options.scene);
  if (!runtime::may_begin(stop))
    return 0;
  CouplingNode node(options, scene);
  return node.run(stop);
}

}  // namespace voxtouch::coupling_node
