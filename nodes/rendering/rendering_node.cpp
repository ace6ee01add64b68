#include "nodes/rendering/rendering_node.hpp"

#include <array>
#include <cmath>
#include <mutex>

#include <fmt/format.h>

#include "core/contact/limits.hpp"
#include "core/scene/scene_file.hpp"
#include "nodes/bus/followed_reader.hpp"
#include "nodes/bus/latched_reader.hpp"
#include "nodes/bus/wait_set.hpp"
#include "nodes/rendering/external_source.hpp"
#include "nodes/rendering/ros_outputs.hpp"
#include "nodes/rendering/sample_renderer.hpp"
#include "nodes/rendering/scene_update_server.hpp"
#include "nodes/rendering/session_of_another.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/device_message.hpp"
#include "nodes/runtime/duty.hpp"
#include "nodes/runtime/held_start.hpp"
#include "nodes/runtime/housekeeping.hpp"
#include "nodes/runtime/participation.hpp"
#include "nodes/runtime/realtime.hpp"
#include "nodes/runtime/recorder_gate.hpp"
#include "nodes/runtime/role_binding.hpp"
#include "nodes/scene_build/build_here.hpp"

namespace voxtouch::rendering_node {
namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;

/// What bounds each loop of the thread that answers samples. `run`: it is the process, each cycle
/// looks at `stop`. Samples in a cycle: kMaxTakes; in real time the history holds one. Descriptions
/// in a cycle: kMaxTakes, of the bound device, or of anybody while none is bound and no force can
/// come of it. `change`: in real time no wait, and at most the changes that the line holds; in
/// lockstep it waits for the update server, asleep for 0.2 ms at a time, and looks at `stop`. A
/// frame: the scene's own counts. One lock, where a description has come.
class RenderingNode {
 public:
  RenderingNode(const Options& options, const scene::Scene& scene,
                std::unique_ptr<rendering::BuiltScene> built)
      : options_(options),
        scene_(scene),
        name_(runtime::name_in_ring(options.standby, "rendering")),
        recorder_(options),
        renderer_(scene.device, *built),
        participant_(options.participant(name_)),
        descriptions_(participant_, qos::kDeviceDescription, options.rig),
        states_(participant_, qos::kDeviceState, options.rig,
                qos::profile_in(qos::kDeviceState, options.mode())),
        contacts_(participant_, qos::kContactState, options.rig,
                  qos::profile_in(qos::kContactState, options.mode())),
        ros_(participant_, options.rig, scene, options.mode()),
        updates_(
            participant_, options, scene, std::move(built), line_,
            [this](const scene::Scene& next) { ros_.scene_is(next); },
            [this](std::uint64_t session) { session_.begin(session); }),
        duty_(participant_, qos::kContactState, options.rig, "rendering",
              runtime::in_mode(options.standby, options.lockstep),
              {{"scene_hash"}, {"changes", "reloads"}}),
        wait_set_(participant_),
        device_("device", {&descriptions_.following(), &states_.following()}) {
    wait_set_.attach(descriptions_.condition());
    wait_set_.attach(states_.condition());
    links_ = {runtime::link_of_reader(qos::kDeviceDescription, descriptions_),
              runtime::link_of_reader(qos::kDeviceState, states_),
              runtime::link_of_writer(qos::kContactState, contacts_),
              runtime::link_of_writer(qos::kScenePlan, updates_.plans())};
    // In lockstep nothing is followed: a value comes at the wall's time, and no two runs would give
    // the same bits.
    if (options.lockstep || effects::external_of(scene.effects) == nullptr)
      return;
    external_samples_ = {participant_, qos::kExternalSample, options.rig,
                         qos::profile(qos::kExternalSample.profile)};
    external_.emplace(participant_, options, scene);
  }

  int run(const std::atomic<bool>& stop) {
    runtime::flush_denormals();
    stop_ = &stop;
    runtime::Housekeeping housekeeping(
        participant_, name_, options_,
        [this](runtime::NodeRegistry& registry, runtime::NodeReport& report) {
          look(registry, report);
        },
        {{"its loop", [this] { return heartbeat_.sign(); }}});
    housekeeping_ = &housekeeping;
    runtime::enter_loop(options_.realtime);
    while (!over()) {
      heartbeat_.beat();
      wait_set_.wait(session_in_loop_ != 0
                         ? 50'000'000
                         : 5'000'000);  // no message tells that the housekeeping has bound a device
      descriptions_.take([this](const msg::DeviceDescription& d) { listen(d); });
      // The device's status and its description name one session: then it begins, or goes on with
      // what has changed.
      if (described_ && described_->session == device_.session() && descriptions_.current() &&
          recorder_.open())
        follow_device();
      msg::DeviceState state;
      const std::uint64_t before = rendered_;
      for (int i = 0; i < states_.kMaxTakes && states_.take(state) && !over(); ++i)
        answer(state);
      if (rendered_ == before)
        idle();
    }
    session_.stop();
    return housekeeping.peer_lost() ? 1 : 0;
  }

 private:
  /// Asked to stop, or in lockstep a peer is lost.
  bool over() const noexcept { return stop_->load(kRelaxed) || housekeeping_->peer_lost(); }

  /// Numbers that cannot be a device's change nothing: what runs goes on, and a session does not
  /// begin on them.
  void listen(const msg::DeviceDescription& message) {
    const DeviceDescription device = runtime::from_msg(message);
    std::string wrong = what_is_wrong(device);
    if (wrong.empty())
      described_ = DescribedDevice{message.session_id, coupling::design::model_of(device)};
    const std::lock_guard lock(wrong_mutex_);
    wrong_ = std::move(wrong);
  }

  /// Of the session that runs: the scene is the same, but the device may not be fit for it any
  /// more.
  void follow_device() {
    if (described_->session != session_in_loop_)
      start_session(described_->session);
    updates_.device_is(std::make_unique<DescribedDevice>(std::move(*described_)));
    described_.reset();
  }

  /// Ready is said by the update server, when readers have the plan.
  void start_session(std::uint64_t session) {
    renderer_.begin_session();
    theirs_.begin();
    line_.begin_session(session);
    next_sample_ = 0;
    session_in_loop_ = session;
    if (external_)
      external_->begin_session(session);
  }

  /// No sample has come: what waits for none is changed now. A fade goes on with the samples; where
  /// there are none for long, nobody feels it.
  void idle() noexcept {
    change(next_sample_, false);
    if (!options_.lockstep && renderer_.live().fading() &&
        runtime::monotonic_ns() - last_answer_ns_ > 500'000'000)
      renderer_.live().finish();
  }

  void sleep_briefly() noexcept {
    heartbeat_.beat();
    runtime::sleep_until(runtime::monotonic_ns() + 200'000);
  }

  /// Between two samples. In lockstep it waits here for what the sample `next` must be answered
  /// with: the plan of a change, which readers must have before it, or a scene that is still being
  /// built.
  void change(std::uint64_t next, bool at_sample) noexcept {
    while (options_.lockstep && at_sample && line_.pauses_before(next) && !over())
      sleep_briefly();
    if (!options_.lockstep)
      (void)line_.pauses_before(next);
    line_.apply_due(renderer_.live(), next, at_sample);
    while (options_.lockstep && !line_.settled(line_.applied()) && !over())
      sleep_briefly();
  }

  void answer(const msg::DeviceState& state) noexcept {
    const std::int64_t begin = runtime::monotonic_ns();
    heartbeat_.beat();
    if (state.session_id != session_in_loop_)
      return;  // its description, which is reliable, is on the way
    // A write that DDS could not end in time is made again in lockstep, and who had it already has
    // it twice. Nothing more than that: a forged number must not keep the rightful ones that follow
    // from being felt.
    if (options_.lockstep && state.sequence_number + 1 == next_sample_)
      return;
    change(state.sequence_number, true);
    next_sample_ = state.sequence_number + 1;
    last_answer_ns_ = begin;
    renderer_.live().aim_for_spring(updates_.spring_n_per_m());
    ++rendered_;
    const std::optional<Wrench> wrench =
        external_ ? external_->take(session_in_loop_) : std::nullopt;
    if (wrench)
      renderer_.take_external(*wrench, state);
    msg::ContactState contact = renderer_.answer(state);
    const bool acts = duty_.acts(
        state.session_id, state.sequence_number, [this](const msg::ContactState& c) { heed(c); },
        &theirs_.agrees());
    theirs_.note(contact, acts);
    if (!acts)
      return;
    // For a replay it is told which sample saw what.
    if (wrench)
      external_samples_.write({state.session_id, state.sequence_number, state.sample_time_ns,
                               runtime::to_msg(*wrench)});
    publish(theirs_.carried_on(contact), begin);
  }

  /// An answer of the one that acts: while this node stands by it goes by the session as that one
  /// began it.
  void heed(const msg::ContactState& theirs) noexcept {
    if (duty_.acts_now())
      return;
    if (const auto begin_ns = theirs_.session_begin(theirs))
      renderer_.begin_session(begin_ns);
    theirs_.heed(theirs);
  }

  void publish(msg::ContactState m, std::int64_t begin) noexcept {
    const rendering::SceneFrame& frame = renderer_.frame();
    const contact::StageResult& touch = frame.touch;
    const contact::ContactResult& c = touch.contact;
    const std::int64_t spent = runtime::monotonic_ns() - begin;
    m.time_spent_ns = options_.lockstep ? 0 : spent;
    contacts_.write_until(m, [this] {
      heartbeat_.beat();
      return !options_.lockstep || over();
    });
    if (samples_.load(kRelaxed) == 0)
      first_sample_.store(m.sequence_number, kRelaxed);
    const bool touches = c.surface_hits + c.interior_hits > 0,
               pushes = c.wrench.force.norm() > kForceEpsilonN;
    ros_.show({m.sample_time_ns, m.session_id, static_cast<double>(m.scene_time_ns) * 1e-9,
               renderer_.tool().pose, frame.object, frame.wrench, c.wrench.force});
    if (ros_.wants_points())
      show_points(touches);
    samples_.fetch_add(1, kRelaxed);
    const bool buried = touches && !pushes && c.interior_hits > c.surface_hits;
    const std::array<bool, kCounted.size()> counts = {
        // in the order of the names
        pushes,
        (m.flags & msg::contact_state::kFlagRefusedSample) != 0,
        touch.fast,
        touch.missed,
        touch.passing,
        buried,
        touch.retained,
        c.saturated,
        frame.tool.lag,
        frame.tool.unplaced,
        frame.tool.queries >= contact::limits::kMaxQueries};
    for (std::size_t n = 0; n < counts.size(); ++n)
      if (counts[n])
        counted_[n].fetch_add(1, kRelaxed);
    if (frame.tool.residual_m > most_residual_m_.load(kRelaxed))
      most_residual_m_.store(frame.tool.residual_m, kRelaxed);
    if (frame.tool.constrained && c.deepest_depth_m > most_depth_m_.load(kRelaxed))
      most_depth_m_.store(c.deepest_depth_m, kRelaxed);
    if (spent > longest_ns_.load(kRelaxed))
      longest_ns_.store(spent, kRelaxed);
    if (const double budget_us = renderer_.live().dominant().plan().budget_us; budget_us > 0.0)
      hold_to_budget(budget_us, spent, frame);
    const bool refused = (m.flags & msg::contact_state::kFlagRefusedSample) !=
                         0;  // then the frame is the last one once more
    if (external_ && !refused)
      external_given_j_.store(external_given_j_.load(kRelaxed) + frame.effects.given_j, kRelaxed);
  }

  /// The clock checks what the counts have promised, and changes nothing.
  void hold_to_budget(double budget_us, std::int64_t spent_ns,
                      const rendering::SceneFrame& frame) noexcept {
    constexpr double kTolerated = 1.1;
    const contact::LeftOut& left_out = frame.touch.contact.left_out;
    has_budget_.store(true, kRelaxed);
    if (!options_.lockstep && static_cast<double>(spent_ns) > kTolerated * 1e3 * budget_us)
      over_budget_.fetch_add(1, kRelaxed);
    if (left_out.points > 0)
      left_out_.fetch_add(1, kRelaxed);
    if (frame.tool.cut_short)
      cut_short_.fetch_add(1, kRelaxed);
    if (left_out.depth_m > most_left_out_m_.load(kRelaxed))
      most_left_out_m_.store(left_out.depth_m, kRelaxed);
  }

  /// For who draws them: all points of the last query in contact, or every n-th of them. Of a
  /// virtual tool the deepest alone.
  void show_points(bool touches) noexcept {
    const rendering::SceneFrame& frame = renderer_.frame();
    ShownPoints shown;
    if (scene_.virtual_tool() && touches)
      shown.at[shown.count++] = frame.touch.contact.deepest_point;
    rendering::ObjectContacts& objects = renderer_.live().dominant().contacts();
    const std::size_t every =
        (frame.touch.contact.surface_hits + frame.touch.contact.interior_hits) /
            ShownPoints::kMaxPoints +
        1;
    std::size_t n = 0;
    for (std::size_t k = 0; k < objects.size() && !scene_.virtual_tool(); ++k)
      for (const contact::Hits* hits : {&objects.object(k).renderer->hits().surface,
                                        &objects.object(k).renderer->hits().interior})
        for (std::size_t i = 0; i < hits->size() && shown.count < ShownPoints::kMaxPoints; ++i)
          if (n++ % every == 0)
            shown.at[shown.count++] = frame.object.position + (*hits)[i].arm;
    ros_.show_points(shown);
  }

  void fill(runtime::NodeReport& report) {
    report.values = {
        {"scene", scene_.name},
        {"scene_hash", scene_.hash},
        {"scene_file",
         std::filesystem::absolute(scene_.file).string()}};  // for who looks on from this host
    report.figures = updates_.figures();
    report.figures["longest_frame_us"] = {
        options_.lockstep ? 0.0 : std::round(static_cast<double>(longest_ns_.load()) * 1e-3), "us"};
    report.figures["samples"] = {samples_.load(), "samples"};
    report.figures["first_sample"] = {first_sample_.load(), "sample number"};
    for (std::size_t n = 0; n < (scene_.virtual_tool() ? kCounted.size() : kOfAnyTool); ++n)
      report.figures[kCounted[n]] = {counted_[n].load(), "samples"};
    report.figures["foreign_samples"] = {device_.refused(), "samples"};
    if (scene_.virtual_tool()) {
      report.figures["most_residual_m"] = {most_residual_m_.load(), "m"};
      report.figures["most_penetration_m"] = {most_depth_m_.load(), "m"};
      report.figures["spring_n_per_m"] = {updates_.spring_n_per_m(), "N/m"};
    }
    if (has_budget_.load()) {
      report.figures["over_budget_samples"] = {over_budget_.load(), "samples"};
      report.figures["left_out_samples"] = {left_out_.load(), "samples"};
      report.figures["most_left_out_depth_m"] = {most_left_out_m_.load(), "m"};
      report.figures["cut_short_samples"] = {cut_short_.load(), "samples"};
    }
  }

  void look(runtime::NodeRegistry& registry, runtime::NodeReport& report) {
    fill(report);
    device_.update(registry, std::nullopt);
    if (external_) {
      external_->report_to(registry, report);
      report.figures["external_given_j"] = {external_given_j_.load(), "J"};
    }
    recorder_.look(registry, contacts_);
    const std::string missing =
        session_.report_to(report, options_, registry, links_,
                           recorder_.open() ? "a device" : "the logger", samples_.load() > 0);
    if (!duty_.acts_now() && !(theirs_.known() && theirs_.agrees().load()))
      report.state = runtime::NodeState::kStarting;  // it cannot stand by yet
    const std::string duty = duty_.look(registry, report);
    updates_.speak(duty_.acts_now());
    std::string trouble = device_.trouble(registry);
    if (trouble.empty() && external_)
      trouble = external_->trouble(registry);
    if (trouble.empty())
      trouble = duty;
    {
      const std::lock_guard lock(wrong_mutex_);
      if (!wrong_.empty())
        trouble = "the device's description is refused: " + wrong_;
    }
    report.message = session_.stopped() ? "stopped"
                     : !trouble.empty() ? trouble
                                        : "scene '" + scene_.name + "' is built" +
                                              (missing.empty() ? "" : "; waiting for " + missing);
    if (!options_.lockstep && reminder_.is_due(registry, report.session_id, qos::kScenePlan))
      updates_.remind();
    const std::string refusal = updates_.refusal();
    if (refusal.empty() || session_.stopped())
      return;
    report.state = runtime::NodeState::kFailed;
    report.message = refusal + " No force is commanded.";
  }

  static constexpr double kForceEpsilonN =
      1e-9;  ///< below this a sum of forces that cancel is rounding, not force
  const Options& options_;
  const scene::Scene& scene_;
  const std::string name_;
  runtime::RecorderGate recorder_;
  SampleRenderer renderer_;
  ChangeLine line_;
  bus::Participant participant_;
  bus::LatchedReader<msg::DeviceDescription> descriptions_;
  bus::FollowedReader<msg::DeviceState> states_;
  bus::Writer<msg::ContactState> contacts_;
  bus::Writer<msg::ExternalSample>
      external_samples_;  ///< where the scene names the effect `external`, in real time
  std::optional<ExternalSource> external_;  ///< likewise
  RosOutputs ros_;
  runtime::Session session_;
  SceneUpdateServer updates_;
  runtime::Duty<msg::ContactState> duty_;
  SessionOfAnother theirs_;
  std::uint64_t rendered_ = 0;  ///< samples, also while the other one answers them
  bus::WaitSet wait_set_;
  runtime::RoleBinding device_;
  runtime::Reminder reminder_;
  std::optional<DescribedDevice> described_;  ///< the last that could be a device's, until the
                                              ///< session that it names is followed
  std::mutex
      wrong_mutex_;  ///< the loop takes it where a description has come, and at no other time
  std::string wrong_;
  std::vector<runtime::Link> links_;
  const std::atomic<bool>* stop_ = nullptr;
  const runtime::Housekeeping* housekeeping_ = nullptr;
  runtime::Heartbeat heartbeat_;
  std::uint64_t session_in_loop_ = 0;
  std::uint64_t next_sample_ = 0;  ///< number of the first one that has not been answered
  std::int64_t last_answer_ns_ = 0;
  /// Figures that count samples; what is behind the first kOfAnyTool is known of a virtual tool
  /// only.
  static constexpr std::array kCounted{
      "contact_samples", "refused_samples",  "fast_samples",           "missed_samples",
      "passing_samples", "buried_samples",   "held_samples",           "saturated_samples",
      "lag_samples",     "unplaced_samples", "samples_at_most_queries"};
  static constexpr std::size_t kOfAnyTool = 8;
  std::array<std::atomic<std::uint64_t>, kCounted.size()> counted_{};
  std::atomic<std::uint64_t> samples_{0}, first_sample_{0};
  std::atomic<double> most_residual_m_{0.0}, most_depth_m_{0.0};  ///< of a virtual tool
  std::atomic<bool> has_budget_{
      false};  ///< a scene with a time budget has run; what follows is of such scenes
  std::atomic<std::uint64_t> over_budget_{0}, left_out_{0}, cut_short_{0};
  std::atomic<double> most_left_out_m_{0.0};
  std::atomic<double> external_given_j_{
      0.0};  ///< to the hand, in W, by the effect `external`; below 0: taken
  std::atomic<std::int64_t> longest_ns_{0};
};

std::unique_ptr<rendering::BuiltScene> build(const scene::Scene& scene,
                                             const scene_build::CacheOptions& cache) {
  const runtime::AtOrdinaryPriority while_no_sample_waits;
  return scene_build::build_here(scene, {.who = "rendering", .cache = cache});
}

}  // namespace

int run(const Options& options, const std::atomic<bool>& stop) {
  (void)runtime::in_mode(options.standby, options.lockstep);  // before a scene is built
  const scene::Scene scene = scene::load_scene(options.scene);
  std::unique_ptr<rendering::BuiltScene> built = build(scene, options.cache);
  for (const std::string& warning :
       options.announce ? built->plan().warnings : std::vector<std::string>())
    log::tell("warning: {}\n", warning);
  if (!runtime::may_begin(stop))
    return 0;
  RenderingNode node(options, scene, std::move(built));
  return node.run(stop);
}

}  // namespace voxtouch::rendering_node
