#include "nodes/rendering/rendering_node.hpp"

#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>

#include "core/scene/scene_file.hpp"
#include "nodes/console/log.hpp"
#include "nodes/rendering/external_source.hpp"
#include "nodes/rendering/frame_counters.hpp"
#include "nodes/rendering/plan_warnings.hpp"
#include "nodes/rendering/sample_renderer.hpp"
#include "nodes/rendering/scene_update_server.hpp"
#include "nodes/runtime/device_input.hpp"
#include "nodes/runtime/participant_counts.hpp"
#include "nodes/scene_build/build_here.hpp"

namespace voxtouch::rendering_node {
namespace {

/// Answers each device sample with a contact state.
///
/// NodeHost::run calls all methods in its loop (see runtime::Step), except `report`, which runs in
/// the monitor's thread. The update server prepares changes of scene and effects in its own thread;
/// the loop applies them between two samples. In lockstep it also waits for the server, until a
/// stop.
class RenderingNode final : public runtime::Step<msg::DeviceState, msg::ContactState> {
 public:
  RenderingNode(const Options& options, const scene::Scene& scene,
                std::unique_ptr<rendering::BuiltScene> built)
      : host_("rendering", options),
        scene_(scene),
        plan_warnings_(built->plan().warnings),
        tool_reach_m_(built->plan().tool_reach_m),
        renderer_(scene.device, *built),
        states_(host_.reader<bus::FollowedReader<msg::DeviceState>>(qos::kDeviceState)),
        contacts_(host_.writer<msg::ContactState>(qos::kContactState)),
        device_(host_, &states_.following()),
        ros_(host_.participant(), options.rig, scene, options.mode()),
        updates_(
            host_.participant(), options, scene, std::move(built), change_queue_,
            [this](const scene::Scene& next) { ros_.set_scene(next); },
            [this](std::uint64_t session) { host_.session().begin(session); }) {
    host_.link_reader(qos::kDeviceState, states_);
    host_.link_writer(qos::kContactState, contacts_);
    host_.link_writer(qos::kScenePlan, updates_.published().writer());
    // Not in lockstep: a value arrives in wall time, so two runs would not be bit-identical.
    if (!options.lockstep && effects::external_of(scene.effects))
      external_.emplace(host_.participant(), options, scene);
  }

  int run(const std::atomic<bool>& stop) { return host_.run(*this, states_, contacts_, stop); }

 private:
  /// Begins the session of a new device, and passes its description to the update server, which
  /// validates the scene for it.
  void listen() override {
    device_.take([this](const DeviceDescription& device, std::uint64_t session) {
      described_ = DescribedDevice{session, coupling::design::model_of(device)};
    });
    if (!described_ || described_->session != device_.binding().session() || !device_.current())
      return;
    if (described_->session != host_.session_in_loop())
      begin_session(described_->session);
    updates_.set_device(std::make_unique<DescribedDevice>(std::move(*described_)));
    described_.reset();
  }

  /// Starts the session in the loop. The update server reports it as ready once its plan is
  /// published and the scene is validated.
  void begin_session(std::uint64_t session) {
    renderer_.begin_session();
    change_queue_.begin_session(session);
    host_.begin_session(session);
    if (external_)
      external_->begin_session(session);
  }

  /// Samples are answered once the scene is validated for the device, which also sets the stiffness
  /// of the spring.
  bool ready() const noexcept override {
    return updates_.published().is_validated(host_.session_in_loop());
  }

  std::optional<msg::ContactState> step(const msg::DeviceState& state) noexcept override {
    const std::int64_t begin_ns = runtime::monotonic_ns();
    apply_changes(state.sequence_number, true);
    renderer_.live().set_spring_target(updates_.published().spring_n_per_m());
    renderer_.live().set_series_target(updates_.published().series_spring());
    if (external_)
      if (const std::optional<Wrench> wrench = external_->take(state))
        renderer_.take_external(*wrench, state);
    msg::ContactState contact = renderer_.answer(state);
    contact.time_spent_ns = host_.options().lockstep ? 0 : runtime::monotonic_ns() - begin_ns;
    return contact;
  }

  void wrote(const msg::DeviceState&, const msg::ContactState& m) noexcept override {
    const rendering::SceneFrame& frame = renderer_.frame();
    ros_.show(shown_of(frame, m, renderer_.tool().pose));
    if (ros_.requests_points())
      ros_.show_points(points_of(frame, renderer_.live(), scene_.virtual_tool()));
    count(counters_, frame, m);
    const bool repeated = (m.flags & msg::contact_state::kFlagRefusedSample) != 0;
    if (external_ && !repeated)
      external_->count_energy(frame.effects.energy_generated_j);
  }

  /// Applies changes without a sample. Ends a fade between scenes after half a second without
  /// samples, since no force is displayed then.
  void idle(std::int64_t since_ns) noexcept override {
    apply_changes(host_.next_sample(), false);
    if (!host_.options().lockstep && renderer_.live().fading() && since_ns > 500'000'000)
      renderer_.live().finish();
  }

  /// Applies due changes before sample `next`. In lockstep it first waits for a scene that is being
  /// built for this sample, and then until the plan of each applied change is published.
  void apply_changes(std::uint64_t next, bool at_sample) noexcept {
    const bool lockstep = host_.options().lockstep;
    if (lockstep && at_sample)
      host_.sleep_while([&] { return change_queue_.announce_sample(next); });
    if (!lockstep)
      (void)change_queue_.announce_sample(next);
    change_queue_.apply_due(renderer_.live(), next, at_sample);
    if (lockstep)
      host_.sleep_while([&] { return !change_queue_.is_acknowledged(change_queue_.applied()); });
  }

  void report(runtime::NodeRegistry& registry, runtime::NodeReport& report,
              runtime::StatusText& status) override {
    report.values = {{"scene", scene_.name},
                     {"scene_hash", scene_.hash},
                     {"scene_file", std::filesystem::absolute(scene_.file).string()}};
    put_plan_warnings(plan_warnings_, report);
    report.figures = updates_.figures();
    constexpr std::size_t kOfAnyTool = FrameCounters::through(FrameCounter::kSaturated);
    counters_.report_to(report.figures, scene_.virtual_tool() ? kFrameTable.size() : kOfAnyTool);
    report.figures["foreign_samples"] = {device_.binding().refused(), "samples"};
    for (const auto& [participant, count] : updates_.requests())
      change_requests_.of(participant) = count;
    change_requests_.name(registry);
    report.values["change_requests"] = change_requests_.text();
    report.figures["tool_reach_m"] = {tool_reach_m_, "m"};
    if (scene_.virtual_tool())
      report.figures["spring_n_per_m"] = {updates_.published().spring_n_per_m(), "N/m"};
    device_.report_to(registry, status);
    report.values["foreign_writers"] = device_.binding().refused_writers();
    if (external_)
      external_->report_to(registry, report, status);
    const bool busy = counters_[FrameCounter::kSamples] > 0;
    const std::string missing = host_.report_session(registry, report, "a device", busy);
    const std::string waits = missing.empty() ? "" : "; waiting for " + missing;
    using enum runtime::StatusPriority;
    status.set(kProgress, "scene '" + scene_.name + "' is built" + waits);
    if (host_.must_repeat(registry, report.session_id, qos::kScenePlan))
      updates_.republish();
    if (host_.session().stopped())
      return status.set(kEnded, "stopped");
    runtime::report_refusal(updates_.published().refusal(), report, status);
  }

  runtime::NodeHost host_;
  const scene::Scene& scene_;
  const std::vector<std::string> plan_warnings_;  ///< of the initial scene
  const double tool_reach_m_;
  SampleRenderer renderer_;
  ChangeQueue change_queue_;
  bus::FollowedReader<msg::DeviceState> states_;
  bus::Writer<msg::ContactState> contacts_;
  runtime::DeviceInput device_;
  std::optional<ExternalSource> external_;  ///< effect `external`, in real time only
  RosOutputs ros_;
  SceneUpdateServer updates_;
  runtime::ParticipantCounts change_requests_;
  std::optional<DescribedDevice> described_;  ///< received, not yet passed to the update server
  FrameCounters counters_;
};

std::unique_ptr<rendering::BuiltScene> build(const scene::Scene& scene,
                                             const std::atomic<bool>& stop) {
  const runtime::AtOrdinaryPriority ordinary_priority;  // the loop has not begun
  const auto check_stop = [&stop] {
    if (stop.load())
      throw std::runtime_error("stopped before the scene was built");
  };
  return scene_build::build_here(scene, {.who = "rendering", .go_on = check_stop});
}

}  // namespace

int run(const Options& options, const std::atomic<bool>& stop) {
  std::optional<scene::Scene> scene;
  std::unique_ptr<rendering::BuiltScene> built;
  try {
    scene = scene::load_scene(options.scene);
    built = build(*scene, stop);
  } catch (const std::exception& error) {
    if (stop.load())
      return 0;
    runtime::NodeHost("rendering", options).report_failure(error.what());
    throw;
  }
  if (options.announce)
    for (const std::string& warning : built->plan().warnings)
      console::log("warning: {}\n", warning);
  if (stop.load())
    return 0;
  RenderingNode node(options, *scene, std::move(built));
  return node.run(stop);
}

}  // namespace voxtouch::rendering_node
