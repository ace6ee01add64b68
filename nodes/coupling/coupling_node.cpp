#include "nodes/coupling/coupling_node.hpp"

#include <optional>

#include "core/scene/scene_file.hpp"
#include "nodes/coupling/contact_coupling.hpp"
#include "nodes/coupling/coupling_fit.hpp"
#include "nodes/coupling/coupling_watch.hpp"
#include "nodes/coupling/running_design.hpp"
#include "nodes/runtime/device_input.hpp"

namespace voxtouch::coupling_node {
namespace {

using runtime::StatusPriority;

/// Node step of the coupling: answers each contact with a force command. Its cycle time is bounded
/// by NodeHost::run and by kMaxTakes descriptions and plans. These come from the bound
/// participants, or from any while none is bound and no force is possible. A fit takes tenths of a
/// second. The loop fits at the start of a session and, in lockstep, for a change. In real time
/// another thread fits a change.
class CouplingNode final : public runtime::Step<msg::ContactState, msg::ForceCommand> {
 public:
  CouplingNode(const Options& options, const scene::Scene& scene)
      : host_("coupling", options),
        scene_(scene),
        device_(host_),
        plans_(host_.reader<bus::LatchedReader<msg::ScenePlan>>(qos::kScenePlan)),
        contacts_(host_.reader<bus::FollowedReader<msg::ContactState>>(qos::kContactState)),
        commands_(host_.writer<msg::ForceCommand>(qos::kForceCommand)),
        rendering_("rendering", {&plans_.following(), &contacts_.following()}),
        fitting_(scene),
        coupling_(scene.device),
        design_(host_, scene.device),
        watch_(host_.participant(), options.rig, options.fault_records) {
    host_.link_reader(qos::kScenePlan, plans_);
    host_.link_reader(qos::kContactState, contacts_);
    host_.link_writer(qos::kForceCommand, commands_);
    host_.link_writer(qos::kCouplingDesign, design_.writer());
  }

  int run(const std::atomic<bool>& stop) { return host_.run(*this, contacts_, commands_, stop); }

 private:
  void listen() override {
    device_.take([this](const DeviceDescription& device, std::uint64_t session) {
      fitting_.set_device(device, session);
    });
    plans_.take([this](const msg::ScenePlan& plan) { fitting_.set_plan(plan); });
    both_known_.store(device_.current() && plans_.current(), std::memory_order_release);
    // A session begins when three messages name it: the device's status, its description and the
    // rendering's plan. Each must come from the bound participant.
    if (both_known_.load(std::memory_order_relaxed) &&
        fitting_.session() == device_.binding().session() && fitting_.changed())
      follow_change();
    if (auto fitted = fitting_.poll())
      adopt(std::move(*fitted));
    if (watch_.take_reset() && coupling_.runs())
      restart();
  }

  /// A new session starts with its own fit. A change within a session is fitted in another thread.
  /// In lockstep it is fitted in the loop, because its first sample must not depend on the duration
  /// of the fit. Until the fit is done, the running coupling is validated for the new data; if it
  /// is invalid, it commands no force.
  void follow_change() {
    // A replacement rendering may run another scene: no force until the fit is done.
    if (fitting_.session() != host_.session_in_loop() ||
        rendering_.binding_epoch() != plan_binding_epoch_)
      return begin_session();
    if (host_.options().lockstep && fitting_.outdated())
      return adopt(fit());
    judge_running();
    if (fitting_.outdated())
      fitting_.begin();
  }

  void judge_running() {
    const device_fit::FittedCoupling& running = design_.fitted();
    device_fit::Refusal refusal = fitting_.judge(running);
    // A coupling that is valid again for another device or contact waits for its own fit.
    if (refusal.empty() == running.refusal.empty() || (refusal.empty() && fitting_.outdated()))
      return;
    device_fit::FittedCoupling judged = running;
    judged.refusal = std::move(refusal);
    adopt(std::move(judged));
  }

  void begin_session() {
    host_.begin_session(*fitting_.session());
    plan_binding_epoch_ = rendering_.binding_epoch();
    coupling_.begin_session(fitting_.device().timing);
    watch_.reserve(1.0 / fitting_.device().timing.period_s);
    counters_.take(CouplingCounter::kStiffness);
    adopt(fit(), true);
    if (coupling_.runs())
      host_.session().begin(host_.session_in_loop());
  }

  device_fit::FittedCoupling fit() {
    // some tenths of a second on an idle machine
    constexpr std::int64_t kMaxFitNs = 30'000'000'000;
    const runtime::Heartbeat::Busy busy(host_.heartbeat(), kMaxFitNs);
    return fitting_.fit();
  }

  /// Runs this coupling from now on. If it must not run, the device receives no commands and fades
  /// its force out. `starts_at_rest`: without the state of the previous coupling.
  void adopt(device_fit::FittedCoupling fitted, bool starts_at_rest = false) {
    if (coupling_.runs() && !fitted.refusal.empty())
      watch_.keep("the new design or plan does not fit the device");
    Adoption use{host_.session_in_loop(), host_.next_sample(), starts_at_rest,
                 adopted(fitted, scene_.device, fitting_.device()), coupling_.period_s()};
    coupling_.adopt(use.coupling);
    use.coupling.runs = coupling_.runs();
    const std::optional<device_fit::ForcePreview> preview = fitting_.preview(fitted);
    design_.adopt(std::move(fitted), std::move(use), preview,
                  fitting_.device().translation.max_stiffness, fitting_.external());
  }

  /// After a reset of the fault latch, starts as in a new session: without an energy debt, and with
  /// a fade-in of the force. Allocates, while no force is commanded.
  void restart() {
    coupling_.begin_session(fitting_.device().timing);
    coupling_.adopt(design_.use().coupling);
  }

  bool ready() const noexcept override {
    return coupling_.runs() && both_known_.load(std::memory_order_relaxed);
  }

  std::optional<msg::ForceCommand> step(const msg::ContactState& contact) noexcept override {
    watch_.begin_sample(coupling_.counters());
    msg::ForceCommand command = coupling_.answer(contact);
    if (watch_.latched())
      command.wrench = {}, command.status |= msg::force_command::kStatusFaultLatched;
    return command;
  }

  void wrote(const msg::ContactState& contact, const msg::ForceCommand& command) noexcept override {
    const EnergyBounds bounds = energy_bounds(coupling_.counters(), fitting_.voxel_size_m());
    count(counters_, coupling_.counters(), bounds, contact);
    watch_.end_sample({contact, command}, coupling_.counters(), bounds);
  }

  void report(runtime::NodeRegistry& registry, runtime::NodeReport& report,
              runtime::StatusText& status) override {
    report.values = {{"scene", scene_.name}, {"scene_hash", scene_.hash}};
    report.figures.clear();
    counters_.report_to(report.figures);
    report.figures["foreign_samples"] = {device_.binding().refused() + rendering_.refused(),
                                         "samples"};
    device_.report_to(registry, status);
    if (device_.binding().bound())
      rendering_.update(registry, device_.binding().session());
    const std::string of_device = device_.binding().refused_writers(),
                      of_rendering = rendering_.refused_writers();
    report.values["foreign_writers"] =
        of_device + (of_device.empty() || of_rendering.empty() ? "" : " and ") + of_rendering;
    status.set(StatusPriority::kFault, rendering_.diagnostic(registry));
    constexpr char kBoth[] = "a device and its scene plan";
    std::string missing =
        host_.report_session(registry, report, kBoth, counters_[CouplingCounter::kSamples] > 0);
    if (missing.empty() && !host_.session().stopped() &&
        !both_known_.load(std::memory_order_acquire)) {
      missing = kBoth;
      report.session_id = 0, report.state = runtime::NodeState::kStarting;
    }
    if (!missing.empty())
      status.set(StatusPriority::kWaiting, "waiting for " + missing);
    const bool stopped = host_.session().stopped();
    if (stopped)
      status.set(StatusPriority::kEnded, "stopped");
    watch_.report_to(registry, device_.binding(), !stopped, report, status);
    // If its rendering has left, the device ends the session.
    if (!stopped && rendering_.lost_session() != 0 &&
        rendering_.lost_session() == host_.session().id()) {
      report.session_id = 0, report.state = runtime::NodeState::kFailed;
      return status.set(StatusPriority::kEnded, rendering_.diagnostic(registry));
    }
    design_.report_to(counters_[CouplingCounter::kStiffness], report, status);
  }

  runtime::NodeHost host_;
  const scene::Scene& scene_;
  runtime::DeviceInput device_;
  bus::LatchedReader<msg::ScenePlan> plans_;
  bus::FollowedReader<msg::ContactState> contacts_;
  bus::Writer<msg::ForceCommand> commands_;
  runtime::RoleBinding rendering_;
  Fitting fitting_;
  ContactCoupling coupling_;
  RunningDesign design_;
  CouplingWatch watch_;
  CouplingCounters counters_;
  /// Description and plan of the bound participants have arrived.
  std::atomic<bool> both_known_{false};
  /// Binding epoch of the rendering whose plan began the session.
  std::uint64_t plan_binding_epoch_ = 0;
};

}  // namespace

int run(const Options& options, const std::atomic<bool>& stop) {
  const scene::Scene scene = scene::load_scene(options.scene);
  CouplingNode node(options, scene);
  return node.run(stop);
}

}  // namespace voxtouch::coupling_node
