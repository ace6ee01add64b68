#include "nodes/rendering/scene_update_server.hpp"

#include <fmt/format.h>

#include "nodes/runtime/realtime.hpp"

namespace voxtouch::rendering_node {
namespace {

namespace result = msg::effect_changed;
constexpr const char* kTooMany = "too many pending changes; wait for their replies";

}  // namespace

SceneUpdateServer::SceneUpdateServer(const bus::Participant& participant, const Options& options,
                                     const scene::Scene& scene,
                                     std::unique_ptr<rendering::BuiltScene> first,
                                     ChangeQueue& line,
                                     std::function<void(const scene::Scene&)> swapped,
                                     std::function<void(std::uint64_t)> begun)
    : change_queue_(line),
      swapped_(std::move(swapped)),
      begun_(std::move(begun)),
      validator_(scene, *first),
      publisher_(participant, options),
      reloader_(options.scene, std::move(first)),
      inbox_(
          participant, options,
          [this](auto changes, bool together, auto requests) {
            receive(changes, together, std::move(requests));
          },
          [this] { return parameters_of(validator_.scene(), validator_.effects()); }) {
  counters_.note(ChangeCounter::kWarnings, static_cast<double>(validator_.plan().warnings.size()));
  thread_ = std::jthread([this](const std::stop_token& stop) {
    runtime::ordinary_priority();
    while (!stop.stop_requested()) {
      const bool waits = !pending_.all().empty() || reloader_.request();
      inbox_.wait(waits                       ? ChangeInbox::kSoonNs
                  : publisher_.session() == 0 ? 5'000'000
                                              : 20'000'000);
      try {
        cycle();
      } catch (const std::exception&) {
        // For example out of memory: one change is lost. An exception that leaves this thread would
        // end the process and the ring.
        if (!reloader_.request())
          change_queue_.resume();
      }
    }
  });
}

SceneUpdateServer::~SceneUpdateServer() {
  thread_.request_stop();
  thread_.join();
  delete described_.load();
}

void SceneUpdateServer::cycle() {
  follow_device();
  ChangeReport report;
  while (change_queue_.next_report(report))
    handle_report(report);
  // the new scene starts with the settings that were pending
  if (reloader_.has_result() && pending_.all().empty())
    finish_reload();
  if (republish_.exchange(false))
    publisher_.publish(validator_);
  inbox_.serve(publisher_.session(), [this](std::uint64_t id) { return pending_.contains(id); });
}

/// Publishes the plan first, because the coupling waits for it and, in real time, fits in parallel.
/// Then the running scene and the changes requested so far are validated for the device. The loop
/// applies none of these changes until that is done. In lockstep, sample 0 waits for it.
void SceneUpdateServer::follow_device() {
  const std::unique_ptr<DescribedDevice> device(described_.exchange(nullptr));
  if (!device)
    return;
  const bool begins = device->session != publisher_.session();
  if (begins) {
    publisher_.set_session(device->session);
    publisher_.set_sample(0);
    publisher_.publish(validator_, false);
    if (!publisher_.lockstep())
      begun_(device->session);
  }
  validator_.set_device(device->model);
  judge_running();
  publisher_.set_complete();
  if (const std::string why = validator_.judge(pending_); !why.empty())
    pending_.cancel(why, change_queue_);
  change_queue_.approve(device->session);
  if (begins && publisher_.lockstep())
    begun_(device->session);
}

std::string SceneUpdateServer::check(std::span<const msg::EffectChange> changes,
                                     bool together) const {
  for (const msg::EffectChange& m : changes) {
    if (together && m.action == msg::effect_change::kActionReload)
      return "a scene reload cannot be combined with other changes";
    std::string why =
        validator_.check(m, publisher_.session(), change_queue_.answering(), pending_);
    if (!why.empty())
      return why;
  }
  return pending_.all().size() + changes.size() > ChangeQueue::kCapacity ? kTooMany : "";
}

void SceneUpdateServer::receive(std::span<const msg::EffectChange> changes, bool together,
                                std::vector<ChangeRequest> requests) {
  const std::string why = check(changes, together);
  for (std::size_t n = 0; n < changes.size(); ++n) {
    if (!why.empty())
      inbox_.refuse(requests[n], why);
    else
      requests[n].what = in_words(changes[n]), requests[n].change = KeptChange(changes[n]);
  }
  if (!why.empty())
    return;
  if (changes.front().action == msg::effect_change::kActionReload)
    return receive_reload(changes.front(), std::move(requests.front()));
  receive_effects(changes, std::move(requests));
}

/// Either all changes take effect from the same sample, or all are refused. They name the same
/// session and sample.
void SceneUpdateServer::receive_effects(std::span<const msg::EffectChange> changes,
                                        std::vector<ChangeRequest> requests) {
  const std::uint64_t from_sample = requests.front().from_sample;
  std::string why;
  if (reloader_.request() && reloader_.request()->from_sample > 0) {
    why = fmt::format("the scene is being rebuilt for sample {}; repeat the request after it",
                      reloader_.request()->from_sample);
  } else if (!pause_before(from_sample)) {
    why = fmt::format("sample {} has passed", from_sample);
  } else {
    auto judged = validator_.judge(changes, requests, pending_);
    if (!judged)
      why = std::move(judged.error());
    else if (!pending_.hand_over(std::move(*judged), change_queue_))
      why = kTooMany;
    change_queue_.resume();
  }
  for (const ChangeRequest& request : requests) {
    if (!why.empty())
      inbox_.refuse(request, why);
    else if (const std::uint64_t sample = pending_.last_sample(); sample > 0)
      inbox_.answer(request, result::kResultPending, sample, wait_text(request));
  }
}

/// Lockstep: makes the loop wait at this sample. Returns false, without a pause, if the sample has
/// passed.
bool SceneUpdateServer::pause_before(std::uint64_t sample) {
  if (!publisher_.lockstep() || sample == 0)
    return true;
  change_queue_.pause_before(sample);
  if (change_queue_.answering() < sample)
    return true;
  change_queue_.resume();
  return false;
}

std::string SceneUpdateServer::wait_text(const ChangeRequest& request) const {
  const std::uint64_t sample = pending_.last_sample(), now = change_queue_.answering();
  const double wait_s =
      sample > now ? static_cast<double>(sample - now) * validator_.on_device().period_s() : 0.0;
  return fmt::format(
      "{}: pending until sample {} ({:.1f} s of device time){}", request.what, sample, wait_s,
      request.from_sample > 0 ? "" : ", after an earlier request (changes are applied in order)");
}

void SceneUpdateServer::receive_reload(const msg::EffectChange& m, ChangeRequest request) {
  std::string why = reloader_.request() ? "a scene reload is already running; wait for its reply"
                                        : ChangeValidator::check_reload(m, pending_);
  if (why.empty() && !pause_before(request.from_sample))
    why = fmt::format("sample {} has passed", request.from_sample);
  if (!why.empty())
    return inbox_.refuse(request, why);
  inbox_.answer(request, result::kResultPending, request.from_sample,
                "building the scene in the background");
  reloader_.start(std::move(request), validator_.scene(), m.voxel_size_m, m.model ? m.model : "");
}

void SceneUpdateServer::finish_reload() {
  SceneReloader::Result built = reloader_.take();
  const ChangeRequest request = *reloader_.request();
  std::vector<effects::EffectSpec> effects;
  if (built.refusal.empty()) {
    auto judged = validator_.judge(built.scene, built.built->plan());
    if (judged)
      effects = std::move(*judged);
    else
      built.refusal = judged.error();
  }
  if (built.refusal.empty()) {
    built.built->scene_renderer().effects() = effects::EffectChain(effects);
    std::vector<PendingChange> swap(1);
    swap[0] = {request, {}, std::move(built.scene), std::move(effects), {}};
    swap[0].change.scene = reloader_.keep(std::move(built.built));
    pending_.hand_over(std::move(swap), change_queue_);  // the queue is empty, so it has room
  } else {
    reloader_.finish();
    inbox_.refuse(request, "the current scene stays active: " + built.refusal);
  }
  change_queue_.resume();
}

void SceneUpdateServer::handle_report(const ChangeReport& report) {
  using What = ChangeReport::What;
  pending_.set_epoch(report.epoch);
  if (report.what == What::kRetired) {
    reloader_.release(report.scene);
    validator_.end_fade();
    return show(publisher_.sample());
  }
  if (report.what == What::kAtRest) {
    validator_.come_to_rest();
    return show(publisher_.sample());
  }
  PendingChange done = pending_.take();
  if (report.what == What::kApplied)
    return applied(done, report);
  if (report.scene) {
    reloader_.release(report.scene);
    reloader_.finish();
  }
  inbox_.refuse(
      done.request,
      !done.refusal.empty() ? done.refusal
      : report.what == What::kLate
          ? fmt::format("sample {} has passed; the next sample is {}", done.request.from_sample,
                        report.sample)
          : "a new session began, or an earlier change was not applied; repeat the request");
}

void SceneUpdateServer::show(std::uint64_t from_sample, bool another_scene) {
  if (validator_.sum_up() || another_scene) {
    publisher_.set_sample(from_sample);
    publisher_.publish(validator_);
  }
  judge_running();
}

void SceneUpdateServer::judge_running() {
  validator_.judge_running();
  publisher_.set_judged(validator_.on_device());
}

void SceneUpdateServer::applied(PendingChange& done, const ChangeReport& report) {
  const bool another_scene = done.scene.has_value();
  validator_.apply(done);
  if (another_scene) {
    counters_.note(ChangeCounter::kWarnings,
                   static_cast<double>(validator_.plan().warnings.size()));
    counters_.note(ChangeCounter::kReloads);
    // the next scene may be built while the old one fades out; the loop takes it afterwards
    reloader_.finish();
    swapped_(validator_.scene());
  }
  counters_.note(ChangeCounter::kChanges);
  // changes of one group are published together, since they were not validated separately
  if (done.change.following == 0) {
    show(report.sample, another_scene);
    inbox_.parameters_changed();
  }
  inbox_.record(done.request, report.session, report.sample);
  inbox_.answer(done.request, result::kResultDone, report.sample,
                fmt::format("{}: active from sample {}", done.request.what, report.sample));
  change_queue_.acknowledge(done.change.ticket);
}

runtime::Figures SceneUpdateServer::figures() const {
  runtime::Figures figures{{"refused_changes", {inbox_.refused_changes(), "changes"}},
                           {"refused_requests", {inbox_.refused_requests(), "requests"}}};
  counters_.report_to(figures);
  return figures;
}

}  // namespace voxtouch::rendering_node
