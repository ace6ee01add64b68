#include "nodes/rendering/scene_update_server.hpp"

#include <fmt/format.h>
#include <string.h>

#include <algorithm>
#include <cmath>

#include "core/rendering/reload_check.hpp"
#include "core/scene/scene_file.hpp"
#include "nodes/mesh_import/mesh_process.hpp"
#include "nodes/rendering/effect_action.hpp"
#include "nodes/rendering/plan_message.hpp"
#include "nodes/runtime/realtime.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::rendering_node {
namespace {

using namespace msg::effect_change;
namespace result = msg::effect_changed;

constexpr std::size_t kMaxNameBytes = 64;
/// What waits for a sample holds up all that is asked for later: no longer than a person would wait.
constexpr double kMaxWaitS = 10.0;

bool too_long(const char* text) { return text && ::strnlen(text, kMaxNameBytes + 1) > kMaxNameBytes; }
std::string_view view(const char* text) { return text ? text : ""; }

std::string in_words(const msg::EffectChange& m) {
  const std::string effect = effects::quotable(view(m.effect));
  switch (m.action) {
    case kActionSwitch: return fmt::format("'{}' {}", effect, m.value[0] != 0.0 ? "on" : "off");
    case kActionGain: return fmt::format("gain of '{}' {:g}", effect, m.value[0]);
    case kActionValue: return fmt::format("'{}' of '{}'", effects::quotable(view(m.parameter)), effect);
    default: return "the scene, built anew";
  }
}

}  // namespace

SceneUpdateServer::SceneUpdateServer(const bus::Participant& participant, const Options& options, const scene::Scene& scene,
                       std::unique_ptr<rendering::BuiltScene> first, ChangeLine& line, std::function<void(const scene::Scene&)> swapped,
                       std::function<void(std::uint64_t)> begun)
    : options_(options), line_(line), swapped_(std::move(swapped)),
      changes_(participant, qos::kEffectChange, options.rig, qos::profile_in(qos::kEffectChange, options.mode())),
      answers_(participant, qos::kEffectChanged, options.rig, qos::profile_in(qos::kEffectChanged, options.mode())),
      plans_(participant, qos::kScenePlan, options.rig, qos::profile_in(qos::kScenePlan, options.mode())),
      wait_set_(participant), scene_(scene), settled_(scene.effects), reach_(effects::at_rest(settled_)), begun_(std::move(begun)),
      speaks_(!options.standby.is_standby), spoke_(!options.standby.is_standby) {
  set_plan(*first);
  sum_up();
  scenes_.push_back(std::move(first));
  wait_set_.attach(changes_.condition());
  thread_ = std::thread([this] { run(); });
}

SceneUpdateServer::~SceneUpdateServer() {
  stop_.store(true, std::memory_order_release);
  thread_.join();
  delete described_.load();
}

void SceneUpdateServer::run() {
  runtime::ordinary_priority();
  while (!stop_.load(std::memory_order_acquire)) {
    wait_set_.wait(outstanding_.empty() && !reload_ ? 20'000'000 : 1'000'000);
    try {
      cycle();
    } catch (const std::exception&) {
      // Out of memory, say. One change is lost; an exception that left this thread would end the process, and the ring with it.
      if (!reload_) line_.resume();
    }
  }
}

void SceneUpdateServer::cycle() {
  look_after_device();
  ChangeReport report;
  while (line_.next_report(report)) handle_report(report);
  look_after_build();
  if (const bool begins_to_speak = speaks_.load(std::memory_order_acquire) && !spoke_; remind_.exchange(false) || begins_to_speak) republish();
  spoke_ = speaks_.load(std::memory_order_acquire);
  changes_.take_each([this](const msg::EffectChange& m) { receive(m); });
}

/// The plan goes out first, for the coupling waits for it. Then what runs is held against the device, and what was asked for before
/// the device was known as well: the loop makes none of it before.
void SceneUpdateServer::look_after_device() {
  const std::unique_ptr<DescribedDevice> device(described_.exchange(nullptr));
  if (!device) return;
  const bool begins = device->session != session_;
  session_ = device->session;
  if (begins) {
    plan_from_sample_ = 0;
    publish(0);
  }
  on_device_.device_is(device->model);
  judge_running();
  judge_outstanding();
  line_.found_good_for(session_);
  if (begins) begun_(session_);
}

void SceneUpdateServer::judge_outstanding() {
  if (outstanding_.empty()) return;
  const Next all = next();
  const std::string why = on_device_.why_not(all.scene, all.contact_alone, all.reach);
  if (why.empty()) return;
  for (Outstanding& waits : outstanding_) waits.why_not = why;
  line_.cancel(ticket_);
}

/// What holds whatever is asked for.
std::string SceneUpdateServer::why_not(const msg::EffectChange& m) const {
  if (too_long(m.effect) || too_long(m.parameter) || too_long(m.model))
    return fmt::format("a name is longer than {} characters", kMaxNameBytes);
  if (m.action < kActionSwitch || m.action > kActionReload)
    return fmt::format("there is no action {}; 1 switches, 2 sets a gain, 3 a parameter, 4 builds the scene anew",
                       m.action);
  const std::uint64_t runs = session_;
  if (m.session_id != 0 && m.session_id != runs)
    return fmt::format("session {} does not run{}; 0 means whichever does", m.session_id,
                       runs == 0 ? ", no device has begun one" : fmt::format(" ({} does)", runs));
  const auto farthest = static_cast<std::uint64_t>(kMaxWaitS / std::clamp(on_device_.period_s(), 1e-5, 1.0));
  if (m.from_sample > line_.answering() + farthest)
    return fmt::format("sample {} is more than {} samples away, {:g} s: changes are made in order, and all others would wait",
                       m.from_sample, farthest, kMaxWaitS);
  if (m.from_sample > 0 && !outstanding_.empty() && m.from_sample < outstanding_.back().change.from_sample)
    return fmt::format("a change asked for earlier waits for sample {}, and changes are made in order",
                       outstanding_.back().change.from_sample);
  if (outstanding_.size() >= ChangeLine::kCapacity) return "too many changes wait already; wait for their answers";
  return {};
}

void SceneUpdateServer::receive(const msg::EffectChange& m) {
  Request request{m.request, m.session_id, m.from_sample, {}};
  if (answered_before(m.request)) return;
  if (const std::string why = why_not(m); !why.empty()) return refuse(request, why);
  request.what = in_words(m);
  if (m.action == kActionReload) return receive_reload(m, std::move(request));
  receive_effect(m, std::move(request));
}

void SceneUpdateServer::receive_effect(const msg::EffectChange& m, Request request) {
  if (reload_ && reload_->from_sample > 0)
    return refuse(request,
                  fmt::format("the scene is being built anew for sample {}; ask again after it", reload_->from_sample));
  if (options_.lockstep && request.from_sample > 0 && !pause_before(request))
    return refuse(request, fmt::format("sample {} has passed", request.from_sample));
  const std::string why = give(m, request);
  line_.resume();
  if (!why.empty()) return refuse(request, why);
  if (outstanding_.back().change.from_sample > 0)
    answer(request, result::kResultWaiting, outstanding_.back().change.from_sample, wait_text(request));
}

/// Judges and hands over to the loop; a sentence why not.
std::string SceneUpdateServer::give(const msg::EffectChange& m, const Request& request) {
  Next after = next();
  const auto command = effects::judge(after.effects, {.action = effect_action(m.action),
                                             .effect = view(m.effect),
                                             .parameter = view(m.parameter),
                                             .value = {m.value[0], m.value[1], m.value[2]}});
  if (!command) return command.error();
  effects::EffectSpec& effect = after.effects[command->effect];
  voxtouch::effects::carry_out(effect, *command);
  after.reach[command->effect].widen(effect);
  if (std::string why = on_device_.why_not(after.scene, after.contact_alone, after.reach); !why.empty()) return why;
  Outstanding asked{request, {}};
  asked.change.effect = *command;
  return ask(std::move(asked)) ? "" : "too many changes wait already; wait for their answers";
}

/// Lockstep: from here on the loop answers no sample from the request's on. False, and nothing pauses, where it has passed.
bool SceneUpdateServer::pause_before(const Request& request) {
  line_.pause_before(request.from_sample);
  if (line_.answering() < request.from_sample) return true;
  line_.resume();
  return false;
}

std::string SceneUpdateServer::wait_text(const Request& request) const {
  const std::uint64_t sample = outstanding_.back().change.from_sample, now = line_.answering();
  const double wait_s = sample > now ? static_cast<double>(sample - now) * on_device_.period_s() : 0.0;
  return fmt::format("{}: waits for sample {}, {:.1f} s of the device's time from now{}", request.what, sample, wait_s,
                     request.from_sample > 0 ? "" : ", behind a change that was asked for earlier: changes are made in order");
}

SceneUpdateServer::Next SceneUpdateServer::next() const {
  const Outstanding* swap = nullptr;
  for (const Outstanding& waits : outstanding_)
    if (waits.scene) swap = &waits;
  Next all = swap ? Next{*swap->scene, swap->change.scene->plan().of_contact_alone, swap->effects, effects::at_rest(swap->effects)}
                  : Next{scene_, plan_.of_contact_alone, settled_, reach_};
  bool after = swap == nullptr;
  for (const Outstanding& waits : outstanding_) {
    if (after) {
      effects::EffectSpec& effect = all.effects[waits.change.effect.effect];
      voxtouch::effects::carry_out(effect, waits.change.effect);
      all.reach[waits.change.effect.effect].widen(effect);
    }
    after |= &waits == swap;
  }
  return all;
}

/// False where the loop's queue is full.
bool SceneUpdateServer::ask(Outstanding&& asked) {
  asked.change.ticket = ticket_ + 1;
  asked.change.epoch = epoch_;
  asked.change.session = asked.request.session;
  asked.change.from_sample = asked.request.from_sample;
  // One that goes at once goes after what waits; in the report it then stands for the same sample.
  if (!line_.ask(asked.change)) return false;
  if (asked.change.from_sample == 0 && !outstanding_.empty())
    asked.change.from_sample = outstanding_.back().change.from_sample;
  ++ticket_;
  outstanding_.push_back(std::move(asked));
  return true;
}

void SceneUpdateServer::receive_reload(const msg::EffectChange& m, Request request) {
  if (reload_) return refuse(request, "the scene is being built anew already; wait for its answer");
  if (m.voxel_size_m != 0.0 && !(std::isfinite(m.voxel_size_m) && m.voxel_size_m > 0.0))
    return refuse(request, "'voxel_size_m' must be a number above 0 [m], or 0 for the scene's own");
  contact::ContactModelKind kind{};
  if (!view(m.model).empty() && !contact::parse_contact_model(view(m.model), kind))
    return refuse(request,
                  fmt::format("there is no contact model '{}'; there are original, adapted, clustered and field",
                              effects::quotable(view(m.model))));
  if (!outstanding_.empty() && outstanding_.back().change.from_sample > 0)
    return refuse(request, fmt::format("a change waits for sample {}; ask again after it",
                                       outstanding_.back().change.from_sample));
  if (options_.lockstep && request.from_sample > 0 && !pause_before(request))
    return refuse(request, fmt::format("sample {} has passed", request.from_sample));
  reload_ = request;
  answer(request, result::kResultWaiting, request.from_sample, "the scene is being built beside the loop");
  under_way_ = std::async(std::launch::async, [this, voxel = m.voxel_size_m, model = std::string(view(m.model))] {
    runtime::ordinary_priority();
    return build(voxel, model);
  });
}

/// In a thread of its own; of the members it only reads the running scene, which does not change before it ends.
SceneUpdateServer::Built SceneUpdateServer::build(double voxel_size_m, const std::string& model) const {
  Built out;
  try {
    out.scene = scene::load_scene(options_.scene);
    out.refusal = rendering::why_not_reloaded(scene_, out.scene);
    if (!out.refusal.empty()) return out;
    if (voxel_size_m > 0.0) out.scene.voxel_size_m = voxel_size_m;
    if (!model.empty() && out.scene.virtual_tool() && model != out.scene.contact.model) {
      out.refusal = fmt::format("a virtual tool goes with the contact model {}, not with {}", out.scene.contact.model, model);
      return out;
    }
    if (!model.empty()) out.scene.contact.model = model;
    const auto go_on = [this] {
      if (stop_.load(std::memory_order_acquire)) throw std::runtime_error("the ring has stopped");
    };
    const ParallelFor until_stopped = [&](std::size_t count, const std::function<void(std::size_t)>& body) {
      for (std::size_t i = 0; i < count; ++i) go_on(), body(i);
    };
    out.built =
        rendering::build_scene(out.scene, until_stopped, {.read = mesh_import::mesh_process()}, [&](const std::string&) { go_on(); });
  } catch (const std::exception& error) {
    out.refusal = error.what();
  }
  return out;
}

void SceneUpdateServer::look_after_build() {
  if (!under_way_.valid() || under_way_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  // What is outstanding must have settled, for the new scene begins with it.
  if (!outstanding_.empty()) {
    return;
  }
  Built result = under_way_.get();
  const Request request = *reload_;
  std::vector<effects::EffectSpec> effects;
  if (result.refusal.empty()) {
    effects = rendering::carried_over(scene_.effects, settled_, result.scene.effects);
    result.refusal = on_device_.why_not(result.scene, result.built->plan().of_contact_alone, effects::at_rest(effects));
  }
  if (!result.refusal.empty()) {
    line_.resume();
    reload_.reset();
    return refuse(request, "the old scene goes on: " + result.refusal);
  }
  result.built->scene_renderer().effects() = effects::EffectChain(effects);
  Outstanding asked{request, {}, std::move(result.scene), std::move(effects)};
  asked.change.scene = result.built.get();
  scenes_.push_back(std::move(result.built));
  ask(std::move(asked));  // nothing else is there: it has room
  line_.resume();
}

void SceneUpdateServer::handle_report(const ChangeReport& report) {
  using What = ChangeReport::What;
  epoch_ = report.epoch;
  if (report.what == What::kRetired) {
    std::erase_if(scenes_, [&](const auto& scene) { return scene.get() == report.scene; });
    fading_.reset();
    return show(plan_from_sample_);
  }
  if (report.what == What::kAtRest) {
    reach_ = effects::at_rest(settled_);
    return show(plan_from_sample_);
  }
  Outstanding done = std::move(outstanding_.front());
  outstanding_.pop_front();
  if (report.what == What::kApplied) return applied(done, report.sample);
  if (report.scene) {
    std::erase_if(scenes_, [&](const auto& scene) { return scene.get() == report.scene; });
    reload_.reset();
  }
  refuse(done.request,
         !done.why_not.empty() ? done.why_not
         : report.what == What::kLate
             ? fmt::format("sample {} has passed, the next one is {}", done.request.from_sample, report.sample)
             : "another session has begun, or a change asked for before this one was not made; ask again");
}

void SceneUpdateServer::set_plan(const rendering::BuiltScene& built) {
  plan_ = built.plan();
  largest_shell_gap_m_ = built.largest_shell_gap_m();
  warnings_.store(plan_.warnings.size());
}

/// What the effects may show as they are set now, which is not as the plan's scene file has them. True where that is another thing
/// than before.
bool SceneUpdateServer::sum_up() {
  const rendering::StiffnessBounds bounds = rendering::with_effects(plan_.of_contact_alone, settled_);
  fitting::DeviceDemand shown = fitting::demand_of(scene_, reach_);
  if (fading_) shown = fitting::larger_of(*fading_, shown);
  const bool another = shown != shown_ || bounds != rendering::StiffnessBounds{plan_.contact_n_per_m, plan_.contact_nm_per_rad};
  plan_.contact_n_per_m = bounds.translation, plan_.contact_nm_per_rad = bounds.rotation;
  shown_ = std::move(shown);
  return another;
}

/// First the coupling is told, which may have to be designed anew; what the device says to it is found out meanwhile.
void SceneUpdateServer::show(std::uint64_t from_sample, bool another_scene) {
  if (sum_up() || another_scene) {
    plan_from_sample_ = from_sample;
    republish();
  }
  judge_running();
}

void SceneUpdateServer::judge_running() {
  on_device_.runs(scene_, {plan_.contact_n_per_m, plan_.contact_nm_per_rad}, shown_);
  spring_n_per_m_.store(on_device_.spring_n_per_m(), std::memory_order_release);
  const std::lock_guard lock(refusal_mutex_);
  refusal_ = on_device_.refusal();
}

void SceneUpdateServer::applied(Outstanding& done, std::uint64_t sample) {
  if (done.scene) {
    scene_ = std::move(*done.scene);
    settled_ = std::move(done.effects), reach_ = effects::at_rest(settled_);
    fading_ = shown_;
    set_plan(*done.change.scene);
    reload_.reset();  // the next one may be built while the old scene fades out; the loop takes it after that
    reloads_.fetch_add(1);
    swapped_(scene_);
  } else {
    effects::EffectSpec& effect = settled_[done.change.effect.effect];
    voxtouch::effects::carry_out(effect, done.change.effect);
    reach_[done.change.effect.effect].widen(effect);
  }
  show(sample, done.change.scene != nullptr);
  done_.fetch_add(1);
  answer(done.request, result::kResultDone, sample,
         fmt::format("{}: holds from sample {} on", done.request.what, sample));
  line_.settle(done.change.ticket);
}

/// With the sample from which the scene and what it shows hold; what is demanded no longer, since a ramp or a fade is over, is told
/// with that of the change that began it.
void SceneUpdateServer::republish() {
  if (session_ == 0) return;  // the first one tells
  publish(plan_from_sample_);
  // In lockstep the loop waits for this: whoever reads the plan has it before the first sample that it holds for.
  if (options_.lockstep) plans_.wait_for_acknowledgments(DDS_SECS(2));
}

void SceneUpdateServer::publish(std::uint64_t from_sample) {
  if (speaks_.load(std::memory_order_acquire)) publish_plan(plans_, scene_, plan_, shown_, largest_shell_gap_m_, session_, from_sample);
}

/// DDS does not say when both ends know each other: a first message may be lost, or the answer. So it may be asked again.
bool SceneUpdateServer::answered_before(std::uint64_t id) {
  if (id == 0) return false;
  const auto found = std::find_if(answered_.begin(), answered_.end(), [&](const Answered& a) { return a.id == id; });
  if (found != answered_.end()) {
    send(*found);
    return true;
  }
  return std::any_of(outstanding_.begin(), outstanding_.end(),
                     [&](const Outstanding& o) { return o.request.id == id; });
}

void SceneUpdateServer::send(const Answered& answer) {
  if (!speaks_.load(std::memory_order_acquire)) return;
  msg::EffectChanged m{};
  m.request = answer.id;
  m.session_id = session_;
  m.from_sample = answer.sample;
  m.result = answer.result;
  m.sentence = runtime::lend(answer.sentence);
  answers_.write(m);
}

void SceneUpdateServer::answer(const Request& request, std::uint32_t result, std::uint64_t sample,
                        const std::string& sentence) {
  constexpr std::size_t kRemembered = 256;
  std::erase_if(answered_, [&](const Answered& a) { return a.id == request.id; });
  answered_.push_back({request.id, sample, result, sentence});
  if (answered_.size() > kRemembered) answered_.pop_front();
  send(answered_.back());
}

void SceneUpdateServer::refuse(const Request& request, const std::string& sentence) {
  refused_.fetch_add(1);
  answer(request, result::kResultRefused, 0, sentence);
}

runtime::Figures SceneUpdateServer::figures() const {
  return {{"warnings", {warnings_.load(), "warnings"}},
          {"changes", {done_.load(), "changes"}},
          {"refused_changes", {refused_.load(), "changes"}},
          {"reloads", {reloads_.load(), "reloads"}}};
}

std::string SceneUpdateServer::refusal() const {
  const std::lock_guard lock(refusal_mutex_);
  return refusal_;
}

}  // namespace voxtouch::rendering_node
