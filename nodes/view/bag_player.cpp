#include "nodes/view/bag_player.hpp"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "nodes/bag/bag_origin.hpp"
#include "nodes/bus/wire_form.hpp"
#include "nodes/console/log.hpp"
#include "nodes/console/reason.hpp"
#include "nodes/runtime/realtime.hpp"
#include "nodes/view/rounded.hpp"
#include "qos/topics.hpp"
#include "voxtouch_msgs/all_types.hpp"

namespace voxtouch::view {
namespace {

/// Streams of the ring have a fixed size and no padding: their CDR is the struct. `show` receives
/// the message and its record time.
template <class T, class Show>
BagPlayer::Handler stream(Show show) {
  return [show](const bag::BagMessage& m, Picture& picture, Facts&, NodeTable&) {
    constexpr std::size_t kHeader = 4;
    T message;
    if (m.bytes.size() != sizeof message + kHeader)
      return;
    std::memcpy(&message, m.bytes.data() + kHeader, sizeof message);
    show(picture, message, m.time_ns);
  };
}

std::string_view cdr_of(const bag::BagMessage& m) {
  return {reinterpret_cast<const char*>(m.bytes.data()), m.bytes.size()};
}

template <class T>
BagPlayer::Handler fact(const bus::Participant& participant) {
  return [form = std::make_shared<bus::WireForm<T>>(participant.get())](
             const bag::BagMessage& m, Picture&, Facts& facts, NodeTable&) {
    form->read(cdr_of(m), [&](const T& message) { facts.take(message); });
  };
}

std::string_view hash_of(std::string_view type) {
  const auto known = std::ranges::find(msg::kAllTypes, type, &msg::AnyType::ros_name);
  return known == std::end(msg::kAllTypes) ? std::string_view() : known->hash;
}

bag::BagReader open(const std::filesystem::path& path) {
  if (const std::string why = bag::other_layout_error(path, hash_of); !why.empty())
    throw std::runtime_error(why);
  auto reader = bag::BagReader::open(path);
  if (!reader)
    throw std::runtime_error(reader.error().sentence);
  return std::move(*reader);
}

/// The verdict file of `up` next to the bag, for the page; null without one.
nlohmann::json verdict_of_run(const std::filesystem::path& path,
                              const std::vector<std::string>& losses) {
  std::error_code error;
  std::ifstream file((std::filesystem::is_directory(path, error) ? path : path.parent_path()) /
                     "voxtouch_run.json");
  const auto recording = nlohmann::json::parse(file, nullptr, false);
  if (!losses.empty())
    return {{"good", false}, {"problems", losses}};
  if (!recording.is_object() || !recording.contains("ok") || !recording["ok"].is_boolean() ||
      !recording.contains("problems") || !recording["problems"].is_array())
    return nullptr;
  nlohmann::json problems = nlohmann::json::array();
  for (const auto& problem : recording["problems"])
    if (problem.is_string())
      problems.push_back(problem);
  return {{"good", recording["ok"].get<bool>() && recording["problems"].empty()},
          {"problems", std::move(problems)}};
}

}  // namespace

BagPlayer::BagPlayer(const bus::Participant& participant, const std::filesystem::path& path)
    : reader_(open(path)),
      verdict_(verdict_of_run(path, reader_.losses())) {
  const Handler status =
      [this, form = std::make_shared<bus::WireForm<msg::NodeStatus>>(participant.get())](
          const bag::BagMessage& m, Picture&, Facts&, NodeTable& nodes) {
        form->read(cdr_of(m), [&](const msg::NodeStatus& message) {
          runtime::NodeReport report = runtime::to_report(message);
          if (const auto file = report.values.find("scene_file"); file != report.values.end())
            scene_file_ = file->second;
          nodes.update(std::move(report), m.time_ns);
        });
      };
  const std::pair<std::string_view, Topic> known[] = {
      // Record times of the logger. Sample and command are delayed alike, so their difference is
      // the
      // latency of the ring. Simulated time has no latency.
      {qos::kDeviceState.path,
       {stream<msg::DeviceState>([](Picture& picture, const auto& state, std::int64_t time_ns) {
         picture.take(state, state.flags & msg::device_state::kFlagLockstep ? 0 : time_ns);
       })}},
      {qos::kContactState.path,
       {stream<msg::ContactState>(
           [](Picture& picture, const auto& contact, std::int64_t) { picture.take(contact); })}},
      {qos::kForceCommand.path,
       {stream<msg::ForceCommand>([](Picture& picture, const auto& command, std::int64_t time_ns) {
         picture.take(command, time_ns);
       })}},
      {qos::kScenePlan.path, {fact<msg::ScenePlan>(participant), true}},
      {qos::kCouplingDesign.path, {fact<msg::CouplingDesign>(participant), true}},
      {qos::kDeviceDescription.path, {fact<msg::DeviceDescription>(participant), true}},
      {qos::kEffectChange.path, {fact<msg::EffectChange>(participant), true}},
      {qos::kEffectChanged.path, {fact<msg::EffectChanged>(participant), true}},
      {qos::kNodeStatus.path, {status}}};
  bool any = false;
  for (const bag::TopicInfo& topic : reader_.topics()) {
    topics_.emplace_back();
    for (const auto& [name, of] : known)
      if (topic.name.ends_with("/" + std::string(name)))
        topics_.back() = of;
    for (const qos::Topic& stream : {qos::kDeviceState, qos::kContactState})
      any = any || topic.name.ends_with("/" + std::string(stream.path));
  }
  if (!any)
    throw std::runtime_error(fmt::format("{} has no messages of a ring", path.string()));
  const auto times = reader_.times();
  if (!times)
    throw std::runtime_error(times.error().sentence);
  if (!*times)
    throw std::runtime_error(fmt::format("{} is empty", path.string()));
  std::tie(begin_ns_, end_ns_) = **times;
  find_steps();
  collecting_ = std::thread([this, path] {
    runtime::ordinary_priority();
    try {
      collect_facts(path);
    } catch (const std::exception& error) {
      report_damage(console::reason_of(error));
    }
  });
}

/// Searches intervals of kLongestPauseNs; a running ring leaves none empty.
void BagPlayer::find_steps() {
  constexpr std::int64_t kLongestPauseNs = 60'000'000'000;
  const auto first_in = [&](std::int64_t from_ns, std::int64_t to_ns) {
    std::optional<std::int64_t> found;
    (void)reader_.for_each_between(from_ns, to_ns, [&](const bag::BagMessage& m) {
      found = found ? std::min(*found, m.time_ns) : m.time_ns;
      return false;
    });
    return found;
  };
  for (std::int64_t at_ns = begin_ns_; end_ns_ - at_ns > kLongestPauseNs;) {
    if (first_in(at_ns, at_ns + kLongestPauseNs)) {
      at_ns += kLongestPauseNs;
      continue;
    }
    // Files may overlap in time: use the earliest message of all.
    std::int64_t next_ns = end_ns_;
    while (const auto earlier = first_in(at_ns, next_ns))
      next_ns = *earlier;
    std::int64_t last_ns = at_ns;
    (void)reader_.for_each_between(at_ns - kLongestPauseNs, at_ns, [&](const bag::BagMessage& m) {
      last_ns = last_ns == at_ns ? m.time_ns : std::max(last_ns, m.time_ns);
      return true;
    });
    steps_.push_back({last_ns, next_ns - last_ns});
    at_ns = next_ns;
  }
}

double BagPlayer::duration_s() const noexcept {
  std::int64_t all_ns = end_ns_ - begin_ns_;
  for (const ClockStep& step : steps_)
    all_ns -= step.length_ns;
  return static_cast<double>(all_ns) * 1e-9;
}

void BagPlayer::report_damage(const std::string& sentence) {
  const std::lock_guard lock(mutex_);
  if (damage_.empty())
    console::log("warning: view: {}\n", damage_ = sentence);
}

std::string BagPlayer::damage() const {
  const std::lock_guard lock(mutex_);
  return damage_;
}

/// Rare messages may be anywhere in a long recording: a thread of its own collects them.
void BagPlayer::collect_facts(const std::filesystem::path& path) {
  const auto reader = bag::BagReader::open(path);
  if (!reader)
    return report_damage(reader.error().sentence);
  const auto all = reader->for_each_between(begin_ns_, end_ns_ + 1, [&](const bag::BagMessage& m) {
    if (topics_[m.topic].is_rare)
      rare_messages_.push_back({m.time_ns, m.topic, {m.bytes.begin(), m.bytes.end()}});
    return !stop_.load();
  });
  if (!all)
    report_damage(all.error().sentence);
  collected_.store(true, std::memory_order_release);
}

BagPlayer::~BagPlayer() {
  stop_.store(true);
  if (collecting_.joinable())
    collecting_.join();
}

void BagPlayer::play(bool on) {
  if (on && at_s_ >= duration_s())
    seek_s_ = 0.0;  // restart
  playing_ = on;
}
void BagPlayer::speed(double times) { speed_ = std::clamp(times, kSlowest, kFastest); }
void BagPlayer::seek(double to_s) { seek_s_ = std::clamp(to_s, 0.0, duration_s()); }
std::int64_t BagPlayer::now_ns() const noexcept {
  std::int64_t now_ns = begin_ns_ + static_cast<std::int64_t>(at_s_ * 1e9);
  for (const ClockStep& step : steps_)
    if (now_ns > step.from_ns)
      now_ns += step.length_ns;
  return now_ns;
}

bool BagPlayer::advance(double elapsed_s, Picture& picture, Facts& facts, NodeTable& nodes) {
  const bool all_known = collected_.load(std::memory_order_acquire);
  if (all_known && !std::exchange(had_all_facts_, true) && at_s_ > kPastS && !seek_s_)
    seek_s_ = at_s_;  // deliver the rare messages of earlier times
  const bool jump = seek_s_.has_value();
  if (jump) {
    at_s_ = *std::exchange(seek_s_, std::nullopt);
    picture.clear(), nodes.clear(), facts.restart();
    const std::int64_t from_ns = now_ns() - static_cast<std::int64_t>(kPastS * 1e9);
    for (const RareMessage& message :
         all_known ? std::span<const RareMessage>(rare_messages_) : std::span<const RareMessage>())
      if (message.time_ns < from_ns)  // earlier rare messages stay valid
        topics_[message.topic].handle({message.topic, message.time_ns, 0, message.bytes}, picture,
                                      facts, nodes);
    deliver(from_ns, now_ns() + 1, picture, facts, nodes);
  }
  if (!playing_)
    return jump;
  const std::int64_t before_ns = now_ns();
  at_s_ = std::min(at_s_ + elapsed_s * speed_, duration_s());
  if (now_ns() + 1 >= end_ns_)
    playing_ = false;
  deliver(before_ns + 1, now_ns() + 1, picture, facts, nodes);
  return jump;
}

void BagPlayer::deliver(std::int64_t from_ns, std::int64_t to_ns, Picture& picture, Facts& facts,
                        NodeTable& nodes) {
  const auto all = reader_.for_each_between(from_ns, to_ns, [&](const bag::BagMessage& message) {
    if (const Handler& handle = topics_[message.topic].handle)
      handle(message, picture, facts, nodes);
    return true;
  });
  if (!all)
    report_damage(all.error().sentence);
}

std::string BagPlayer::note() const {
  std::string note = damage();
  for (const ClockStep& step : steps_)
    note += fmt::format("{}The logger's clock stepped by {:.0f} s; that time is skipped.",
                        note.empty() ? "" : " ", static_cast<double>(step.length_ns) * 1e-9);
  return note;
}

nlohmann::json BagPlayer::to_json() const {
  nlohmann::json verdict = verdict_;
  if (const std::string sentence = damage(); !sentence.empty()) {
    if (verdict.is_null())
      verdict = {{"problems", nlohmann::json::array()}};
    verdict["good"] = false;
    verdict["problems"].push_back(sentence);
  }
  return {{"t", rounded(at_s_)},
          {"duration", rounded(duration_s())},
          {"playing", playing_},
          {"speed", speed_},
          {"verdict", verdict}};
}

}  // namespace voxtouch::view
