#include "nodes/rendering/scene_update_server.hpp"

#include <fmt/format.h>
#include <string.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/rendering/reload_check.hpp"
#include "core/scene/scene_file.hpp"
#include "nodes/rendering/effect_action.hpp"
#include "nodes/rendering/plan_message.hpp"
#include "nodes/runtime/realtime.hpp"
#include "nodes/runtime/strings.hpp"
#include "nodes/scene_build/build_here.hpp"

namespace voxtouch::rendering_node {
namespace {

using namespace msg::effect_change;
namespace result = msg::effect_changed;

constexpr std::size_t kMaxNameBytes = 64;
/// What waits for a sample holds up all that is asked for later: no longer than a person would
/// wait.
constexpr double kMaxWaitS = 10.0;
constexpr const char* kTooMany = "too many changes wait already; wait for their answers";

bool too_long(const char* text) {
  return text && ::strnlen(text, kMaxNameBytes + 1) > kMaxNameBytes;
}
std::string_view view(const char* text) { return text ? text : ""; }

/// Of a change that came by a service: as good as never that of another.
std::uint64_t request_number() {
  static thread_local std::random_device random;
  return (std::uint64_t{random()} << 32U | random()) | 1U;
}

}  // namespace

SceneUpdateServer::SceneUpdateServer(const bus::Participant& participant, const Options& options,
                                     const scene::Scene& scene,
                                     std::unique_ptr<rendering::BuiltScene> first, ChangeLine& line,
                                     std::function<void(const scene::Scene&)> swapped,
                                     std::function<void(std::uint64_t)> begun)
    : options_(options),
      line_(line),
      swapped_(std::move(swapped)),
      changes_(participant, qos::kEffectChange, options.rig,
               qos::profile_in(qos::kEffectChange, options.mode())),
      asked_by_service_(participant, qos::kEffectChange, options.rig,
                        qos::profile_in(qos::kEffectChange, options.mode())),
      answers_(participant, qos::kEffectChanged, options.rig,
               qos::profile_in(qos::kEffectChanged, options.mode())),
      made_(participant, qos::kEffectMade, options.rig,
            qos::profile_in(qos::kEffectMade, options.mode())),
      plans_(participant, qos::kScenePlan, options.rig,
             qos::profile_in(qos::kScenePlan, options.mode())),
      wait_set_(participant),
      scene_(scene),
      settled_(scene.effects),
      reach_(effects::at_rest(settled_)),
      begun_(std::move(begun)),
      services_(participant, options.rig, handler()),
      speaks_(!options.standby.is_standby),
      spoke_(!options.standby.is_standby) {
  set_plan(*first);
  sum_up();
  scenes_.push_back(std::move(first));
  wait_set_.attach(changes_.condition());
  services_.attach_to(wait_set_);
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
    const bool waits = !outstanding_.empty() || reload_ || services_.waits();
    wait_set_.wait(waits ? 1'000'000 : session_ == 0 ? 5'000'000 : 20'000'000);
    try {
      cycle();
    } catch (const std::exception&) {
      // Out of memory, say. One change is lost; an exception that left this thread would end the
      // process, and the ring with it.
      if (!reload_)
        line_.resume();
    }
  }
}

void SceneUpdateServer::cycle() {
  look_after_device();
  ChangeReport report;
  while (line_.next_report(report))
    handle_report(report);
  look_after_build();
  if (const bool begins_to_speak = speaks_.load(std::memory_order_acquire) && !spoke_;
      remind_.exchange(false) || begins_to_speak)
    republish();
  spoke_ = speaks_.load(std::memory_order_acquire);
  changes_.take_each([this, own = asked_by_service_.handle()](const msg::EffectChange& m,
                                                              dds_instance_handle_t writer) {
    if (writer != own)
      receive(m, {m.request, m.session_id, m.from_sample, {}});
  });
  services_.serve(spoke_);
}

ChangeHandler SceneUpdateServer::handler() {
  return {[this](std::span<const msg::EffectChange> asked, bool together, const ChangeTold& told) {
            ask_for(asked, together, told);
          },
          [this] { return parameters_of(scene_, settled_); }};
}

/// What came by a service goes on as if it had come as a message. A standby, which answers no
/// service, hears it as one.
void SceneUpdateServer::ask_for(std::span<const msg::EffectChange> asked, bool together,
                                const ChangeTold& told) {
  std::vector<msg::EffectChange> all(asked.begin(), asked.end());
  std::vector<Request> requests;
  for (std::size_t n = 0; n < all.size(); ++n) {
    all[n].request = request_number();
    asked_by_service_.write(all[n]);
    requests.push_back({all[n].request, all[n].session_id, all[n].from_sample, in_words(all[n]),
                        [told, n](bool done, std::uint64_t sample, const std::string& sentence) {
                          told(n, done, sample, sentence);
                        },
                        KeptChange(all[n])});
  }
  if (!together) {
    for (std::size_t n = 0; n < all.size(); ++n)
      receive(all[n], std::move(requests[n]));
    return;
  }
  std::string why;
  for (const msg::EffectChange& m : all)
    if (why.empty())
      why = m.action == kActionReload
                ? "a scene is built anew by itself, and not together with other changes"
                : why_not(m);
  if (why.empty() && outstanding_.size() + all.size() > ChangeLine::kCapacity)
    why = kTooMany;
  if (why.empty())
    return receive_effects(all, std::move(requests));
  for (const Request& request : requests)
    refuse(request, why);
}

/// The plan goes out first, for the coupling waits for it, and in real time makes its fit
/// meanwhile. Then what runs is judged on the device, and what was asked for before the device was
/// known as well: the loop makes none of it before. In lockstep sample 0 waits for that.
void SceneUpdateServer::look_after_device() {
  const std::unique_ptr<DescribedDevice> device(described_.exchange(nullptr));
  if (!device)
    return;
  const bool begins = device->session != session_;
  session_ = device->session;
  if (begins) {
    plan_from_sample_ = 0;
    publish(0);
    if (!options_.lockstep)
      begun_(session_);
  }
  on_device_.device_is(device->model);
  judge_running();
  judge_outstanding();
  line_.found_good_for(session_);
  if (begins && options_.lockstep)
    begun_(session_);
}

void SceneUpdateServer::judge_outstanding() {
  if (outstanding_.empty())
    return;
  const Next all = next();
  const std::string why = on_device_.why_not(all.scene, all.contact_alone, all.reach);
  if (why.empty())
    return;
  for (Outstanding& waits : outstanding_)
    waits.why_not = why;
  line_.cancel(ticket_);
}

/// What holds whatever is asked for.
std::string SceneUpdateServer::why_not(const msg::EffectChange& m) const {
  if (too_long(m.effect) || too_long(m.parameter) || too_long(m.model))
    return fmt::format("a name is longer than {} characters", kMaxNameBytes);
  if (m.action < kActionSwitch || m.action > kActionReload)
    return fmt::format(
        "there is no action {}; 1 switches, 2 sets a gain, 3 a parameter, 4 builds the scene anew",
        m.action);
  const std::uint64_t runs = session_;
  if (m.session_id != 0 && m.session_id != runs)
    return fmt::format("session {} does not run{}; 0 means whichever does", m.session_id,
                       runs == 0 ? ", no device has begun one" : fmt::format(" ({} does)", runs));
  const auto farthest =
      static_cast<std::uint64_t>(kMaxWaitS / std::clamp(on_device_.period_s(), 1e-5, 1.0));
  if (m.from_sample > line_.answering() + farthest)
    return fmt::format(
        "sample {} is more than {} samples away, {:g} s: changes are made in order, and all others "
        "would wait",
        m.from_sample, farthest, kMaxWaitS);
  if (m.from_sample > 0 && !outstanding_.empty() &&
      m.from_sample < outstanding_.back().change.from_sample)
    return fmt::format(
        "a change asked for earlier waits for sample {}, and changes are made in order",
        outstanding_.back().change.from_sample);
  if (outstanding_.size() >= ChangeLine::kCapacity)
    return kTooMany;
  return {};
}

void SceneUpdateServer::receive(const msg::EffectChange& m, Request request) {
  if (answered_before(m.request))
    return;
  if (const std::string why = why_not(m); !why.empty())
    return refuse(request, why);
  request.what = in_words(m), request.change = KeptChange(m);
  if (m.action == kActionReload)
    return receive_reload(m, std::move(request));
  receive_effects(std::span(&m, 1), {std::move(request)});
}

/// All of them hold from the same sample, or are refused together. They ask for the same session
/// and sample.
void SceneUpdateServer::receive_effects(std::span<const msg::EffectChange> all,
                                        std::vector<Request> requests) {
  const std::uint64_t from_sample = requests.front().from_sample;
  std::string why;
  if (reload_ && reload_->from_sample > 0)
    why = fmt::format("the scene is being built anew for sample {}; ask again after it",
                      reload_->from_sample);
  else if (options_.lockstep && from_sample > 0 && !pause_before(requests.front()))
    why = fmt::format("sample {} has passed", from_sample);
  else
    why = give(all, requests), line_.resume();
  for (const Request& request : requests) {
    if (!why.empty())
      refuse(request, why);
    else if (outstanding_.back().change.from_sample > 0)
      answer(request, result::kResultWaiting, outstanding_.back().change.from_sample,
             wait_text(request));
  }
}

/// Judges and hands over to the loop; a sentence why not.
std::string SceneUpdateServer::give(std::span<const msg::EffectChange> all,
                                    std::span<const Request> requests) {
  Next after = next();
  std::vector<effects::EffectRequest> asked;
  for (const msg::EffectChange& m : all)
    asked.push_back({.action = effect_action(m.action),
                     .effect = view(m.effect),
                     .parameter = view(m.parameter),
                     .value = {m.value[0], m.value[1], m.value[2]}});
  const auto commands = effects::judge(after.effects, asked);
  if (!commands)
    return commands.error();
  std::vector<Outstanding> outstanding;
  for (const effects::EffectCommand& command : *commands) {
    effects::EffectSpec& effect = after.effects[command.effect];
    voxtouch::effects::carry_out(effect, command);
    after.reach[command.effect].widen(effect);
    outstanding.push_back({requests[outstanding.size()], {}});
    outstanding.back().change.effect = command;
  }
  if (std::string why = on_device_.why_not(after.scene, after.contact_alone, after.reach);
      !why.empty())
    return why;
  return ask(std::move(outstanding)) ? "" : kTooMany;
}

/// Lockstep: from here on the loop answers no sample from the request's on. False, and nothing
/// pauses, where it has passed.
bool SceneUpdateServer::pause_before(const Request& request) {
  line_.pause_before(request.from_sample);
  if (line_.answering() < request.from_sample)
    return true;
  line_.resume();
  return false;
}

std::string SceneUpdateServer::wait_text(const Request& request) const {
  const std::uint64_t sample = outstanding_.back().change.from_sample, now = line_.answering();
  const double wait_s =
      sample > now ? static_cast<double>(sample - now) * on_device_.period_s() : 0.0;
  return fmt::format(
      "{}: waits for sample {}, {:.1f} s of the device's time from now{}", request.what, sample,
      wait_s,
      request.from_sample > 0
          ? ""
          : ", behind a change that was asked for earlier: changes are made in order");
}

SceneUpdateServer::Next SceneUpdateServer::next() const {
  const Outstanding* swap = nullptr;
  for (const Outstanding& waits : outstanding_)
    if (waits.scene)
      swap = &waits;
  Next all = swap ? Next{*swap->scene, swap->change.scene->plan().of_contact_alone, swap->effects,
                         effects::at_rest(swap->effects)}
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

/// All of `asked` are made in the same sample. False where the loop's queue has no room for them.
bool SceneUpdateServer::ask(std::vector<Outstanding> asked) {
  std::vector<Change> changes;
  for (Outstanding& one : asked) {
    one.change.ticket = ticket_ + 1 + changes.size();
    one.change.epoch = epoch_;
    one.change.session = one.request.session;
    one.change.from_sample = one.request.from_sample;
    one.change.following = static_cast<std::uint32_t>(asked.size() - 1 - changes.size());
    changes.push_back(one.change);
  }
  // One that goes at once goes after what waits; in the report it then stands for the same sample.
  if (!line_.ask(changes))
    return false;
  ticket_ += changes.size();
  for (Outstanding& one : asked) {
    if (one.change.from_sample == 0 && !outstanding_.empty())
      one.change.from_sample = outstanding_.back().change.from_sample;
    outstanding_.push_back(std::move(one));
  }
  return true;
}

void SceneUpdateServer::receive_reload(const msg::EffectChange& m, Request request) {
  if (reload_)
    return refuse(request, "the scene is being built anew already; wait for its answer");
  if (m.voxel_size_m != 0.0 && !(std::isfinite(m.voxel_size_m) && m.voxel_size_m > 0.0))
    return refuse(request, "'voxel_size_m' must be a number above 0 [m], or 0 for the scene's own");
  contact::ContactModelKind kind{};
  if (!view(m.model).empty() && !contact::parse_contact_model(view(m.model), kind))
    return refuse(
        request,
        fmt::format("there is no contact model '{}'; there are original, adapted and field",
                    effects::quotable(view(m.model))));
  if (!outstanding_.empty() && outstanding_.back().change.from_sample > 0)
    return refuse(request, fmt::format("a change waits for sample {}; ask again after it",
                                       outstanding_.back().change.from_sample));
  if (options_.lockstep && request.from_sample > 0 && !pause_before(request))
    return refuse(request, fmt::format("sample {} has passed", request.from_sample));
  reload_ = request;
  answer(request, result::kResultWaiting, request.from_sample,
         "the scene is being built beside the loop");
  under_way_ = std::async(std::launch::async,
                          [this, voxel = m.voxel_size_m, model = std::string(view(m.model))] {
                            runtime::ordinary_priority();
                            return build(voxel, model);
                          });
}

/// In a thread of its own; of the members it only reads the running scene, which does not change
/// before it ends.
SceneUpdateServer::Built SceneUpdateServer::build(double voxel_size_m,
                                                  const std::string& model) const {
  Built out;
  try {
    out.scene = scene::load_scene(options_.scene);
    out.refusal = rendering::why_not_reloaded(scene_, out.scene);
    if (!out.refusal.empty())
      return out;
    if (voxel_size_m > 0.0)
      out.scene.voxel_size_m = voxel_size_m;
    if (!model.empty() && out.scene.virtual_tool() && model != out.scene.contact.model) {
      out.refusal = fmt::format("a virtual tool goes with the contact model {}, not with {}",
                                out.scene.contact.model, model);
      return out;
    }
    if (!model.empty())
      out.scene.contact.model = model;
    const auto go_on = [this] {
      if (stop_.load(std::memory_order_acquire))
        throw std::runtime_error("the ring has stopped");
    };
    // On one thread: the ring runs meanwhile.
    out.built = scene_build::build_here(out.scene, {.who = "rendering",
                                                    .cache = options_.cache,
                                                    .loop = serial_for(),
                                                    .go_on = go_on,
                                                    .tells_progress = false});
  } catch (const std::exception& error) {
    out.refusal = error.what();
  }
  return out;
}

void SceneUpdateServer::look_after_build() {
  if (!under_way_.valid() ||
      under_way_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return;
  // What is outstanding must have settled, for the new scene begins with it.
  if (!outstanding_.empty()) {
    return;
  }
  Built result = under_way_.get();
  const Request request = *reload_;
  std::vector<effects::EffectSpec> effects;
  if (result.refusal.empty()) {
    effects = rendering::carried_over(scene_.effects, settled_, result.scene.effects);
    result.refusal = on_device_.why_not(result.scene, result.built->plan().of_contact_alone,
                                        effects::at_rest(effects));
  }
  if (!result.refusal.empty()) {
    line_.resume();
    reload_.reset();
    return refuse(request, "the old scene goes on: " + result.refusal);
  }
  result.built->scene_renderer().effects() = effects::EffectChain(effects);
  std::vector<Outstanding> asked;
  asked.push_back({request, {}, std::move(result.scene), std::move(effects)});
  asked.front().change.scene = result.built.get();
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
  if (report.what == What::kApplied)
    return applied(done, report);
  if (report.scene) {
    std::erase_if(scenes_, [&](const auto& scene) { return scene.get() == report.scene; });
    reload_.reset();
  }
  refuse(done.request, !done.why_not.empty() ? done.why_not
                       : report.what == What::kLate
                           ? fmt::format("sample {} has passed, the next one is {}",
                                         done.request.from_sample, report.sample)
                           : "another session has begun, or a change asked for before this one was "
                             "not made; ask again");
}

void SceneUpdateServer::set_plan(const rendering::BuiltScene& built) {
  plan_ = built.plan();
  largest_shell_gap_m_ = built.largest_shell_gap_m();
  warnings_.store(plan_.warnings.size());
}

/// What the effects may show as they are set now, which is not as the plan's scene file has them.
/// True where that is another thing than before.
bool SceneUpdateServer::sum_up() {
  const rendering::StiffnessBounds bounds =
      rendering::with_effects(plan_.of_contact_alone, settled_);
  fitting::DeviceDemand shown = fitting::demand_of(scene_, reach_);
  if (fading_)
    shown = fitting::larger_of(*fading_, shown);
  const bool another =
      shown != shown_ ||
      bounds != rendering::StiffnessBounds{plan_.contact_n_per_m, plan_.contact_nm_per_rad};
  plan_.contact_n_per_m = bounds.translation, plan_.contact_nm_per_rad = bounds.rotation;
  shown_ = std::move(shown);
  return another;
}

/// First the coupling is told, which may have to be designed anew; what the device says to it is
/// found out meanwhile.
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

void SceneUpdateServer::applied(Outstanding& done, const ChangeReport& report) {
  if (done.scene) {
    scene_ = std::move(*done.scene);
    settled_ = std::move(done.effects), reach_ = effects::at_rest(settled_);
    fading_ = shown_;
    set_plan(*done.change.scene);
    reload_.reset();  // the next one may be built while the old scene fades out; the loop takes it
                      // after that
    reloads_.fetch_add(1);
    swapped_(scene_);
  } else {
    effects::EffectSpec& effect = settled_[done.change.effect.effect];
    voxtouch::effects::carry_out(effect, done.change.effect);
    reach_[done.change.effect.effect].widen(effect);
  }
  done_.fetch_add(1);
  if (done.change.following ==
      0) {  // what is made together is shown as a whole: its parts by themselves nobody has judged
    show(report.sample, done.change.scene != nullptr);
    services_.parameters_changed();
  }
  record(done.request, report);
  answer(done.request, result::kResultDone, report.sample,
         fmt::format("{}: holds from sample {} on", done.request.what, report.sample));
  line_.settle(done.change.ticket);
}

/// With the sample from which the scene and what it shows hold; what is demanded no longer, since a
/// ramp or a fade is over, is told with that of the change that began it.
void SceneUpdateServer::republish() {
  if (session_ == 0)
    return;  // the first one tells
  publish(plan_from_sample_);
  // In lockstep the loop waits for this: whoever reads the plan has it before the first sample that
  // it holds for.
  if (options_.lockstep)
    plans_.wait_for_acknowledgments(DDS_SECS(2));
}

void SceneUpdateServer::publish(std::uint64_t from_sample) {
  if (speaks_.load(std::memory_order_acquire))
    publish_plan(plans_, scene_, plan_, shown_, largest_shell_gap_m_, session_, from_sample);
}

/// DDS does not say when both ends know each other: a first message may be lost, or the answer. So
/// it may be asked again.
bool SceneUpdateServer::answered_before(std::uint64_t id) {
  if (id == 0)
    return false;
  const auto found = std::find_if(answered_.begin(), answered_.end(),
                                  [&](const Answered& a) { return a.id == id; });
  if (found != answered_.end()) {
    send(*found);
    return true;
  }
  return std::any_of(outstanding_.begin(), outstanding_.end(),
                     [&](const Outstanding& o) { return o.request.id == id; });
}

void SceneUpdateServer::send(const Answered& answer) {
  if (!speaks_.load(std::memory_order_acquire))
    return;
  msg::EffectChanged m{};
  m.request = answer.id;
  m.session_id = session_;
  m.from_sample = answer.sample;
  m.result = answer.result;
  m.sentence = runtime::lend(answer.sentence);
  answers_.write(m);
}

/// The question may have come from somebody whom a recorder did not know yet; this writer it knows.
void SceneUpdateServer::record(const Request& request, const ChangeReport& report) {
  if (!speaks_.load(std::memory_order_acquire))
    return;
  made_.write(request.change.made(report.session, report.sample));
}

void SceneUpdateServer::answer(const Request& request, std::uint32_t result, std::uint64_t sample,
                               const std::string& sentence) {
  constexpr std::size_t kRemembered = 256;
  std::erase_if(answered_, [&](const Answered& a) { return a.id == request.id; });
  answered_.push_back({request.id, sample, result, sentence});
  if (answered_.size() > kRemembered)
    answered_.pop_front();
  send(answered_.back());
  if (request.told && result != result::kResultWaiting)
    request.told(result == result::kResultDone, sample, sentence);
}

void SceneUpdateServer::refuse(const Request& request, const std::string& sentence) {
  refused_.fetch_add(1);
  answer(request, result::kResultRefused, 0, sentence);
}

runtime::Figures SceneUpdateServer::figures() const {
  return {{"warnings", {warnings_.load(), "warnings"}},
          {"changes", {done_.load(), "changes"}},
          {"refused_changes", {refused_.load(), "changes"}},
          {"reloads", {reloads_.load(), "reloads"}},
          {"refused_requests", {services_.refused(), "requests"}}};
}

std::string SceneUpdateServer::refusal() const {
  const std::lock_guard lock(refusal_mutex_);
  return refusal_;
}

}  // namespace voxtouch::rendering_node
