#include "nodes/replay/recording.hpp"

#include <algorithm>
#include <deque>
#include <limits>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "nodes/bag/bag_reader.hpp"
#include "nodes/bus/message_bytes.hpp"
#include "nodes/rendering/kept_change.hpp"
#include "nodes/runtime/device_message.hpp"
#include "qos/topics.hpp"

namespace voxtouch::replay {
namespace {

std::string text_of(const char* text) { return text ? text : ""; }

template <class... Args>
[[noreturn]] void cannot(fmt::format_string<Args...> form, Args&&... args) {
  throw std::runtime_error(fmt::format(form, std::forward<Args>(args)...));
}

enum class Kind : std::uint8_t {
  kNone,
  kState,
  kContact,
  kCommand,
  kDevice,
  kPlan,
  kDesign,
  kChange,
  kChanged,
  kStatus,
  kExternal,
  kMade
};

struct KindOfTopic {
  const qos::Topic& topic;
  Kind kind;
};
constexpr KindOfTopic kKinds[] = {
    {qos::kDeviceState, Kind::kState},    {qos::kContactState, Kind::kContact},
    {qos::kForceCommand, Kind::kCommand}, {qos::kDeviceDescription, Kind::kDevice},
    {qos::kScenePlan, Kind::kPlan},       {qos::kCouplingDesign, Kind::kDesign},
    {qos::kEffectChange, Kind::kChange},  {qos::kEffectChanged, Kind::kChanged},
    {qos::kNodeStatus, Kind::kStatus},    {qos::kExternalSample, Kind::kExternal},
    {qos::kEffectMade, Kind::kMade}};

/// The rig of a topic "/<rig>/<path>"; empty for other topics.
std::string rig_in(const std::string& name, std::string_view path) {
  const std::string end = "/" + std::string(path);
  return name.size() > end.size() + 1 && name.ends_with(end)
             ? name.substr(1, name.size() - end.size() - 1)
             : "";
}

std::string chosen_rig(const bag::BagReader& bag, const std::filesystem::path& path,
                       const std::string& requested) {
  std::set<std::string> rigs;
  for (const bag::TopicInfo& topic : bag.topics())
    if (const std::string rig = rig_in(topic.name, qos::kDeviceState.path);
        !rig.empty() && topic.type == qos::kDeviceState.type)
      rigs.insert(rig);
  if (rigs.empty())
    cannot("{} has no device samples (topic /<rig>/{}): it is not the recording of a ring.",
           path.string(), qos::kDeviceState.path);
  if (!requested.empty() && !rigs.contains(requested))
    cannot("{} has no rig '{}'. Recorded rigs: {}.", path.string(), requested,
           fmt::join(rigs, ", "));
  if (requested.empty() && rigs.size() > 1)
    cannot("{} has several rigs: {}. Choose one with --rig.", path.string(), fmt::join(rigs, ", "));
  return requested.empty() ? *rigs.begin() : requested;
}

/// Takes the bag's messages one after the other.
class Collector {
 public:
  Collector(const bag::BagReader& bag, const std::filesystem::path& path, const std::string& rig)
      : path_(path) {
    out_.rig = chosen_rig(bag, path, rig);
    for (const bag::TopicInfo& topic : bag.topics()) {
      kinds_.push_back(Kind::kNone);
      for (const KindOfTopic& known : kKinds)
        if (topic.name == "/" + out_.rig + "/" + std::string(known.topic.path) &&
            topic.type == known.topic.type)
          kinds_.back() = known.kind;
    }
    records_changes_ = std::ranges::find(kinds_, Kind::kMade) != kinds_.end();
  }

  void take(const bag::BagMessage& m) {
    switch (kinds_[m.topic]) {
      case Kind::kState:
        return stream<msg::DeviceState>(m, &RecordedSample::state);
      case Kind::kContact:
        return stream<msg::ContactState>(m, &RecordedSample::contact);
      case Kind::kCommand:
        return stream<msg::ForceCommand>(m, &RecordedSample::command);
      case Kind::kExternal:
        return stream<msg::ExternalSample>(m, &RecordedSample::external);
      case Kind::kDevice:
        return text<msg::DeviceDescription>(m, [&](const auto& d) { device(d, m.bytes); });
      case Kind::kPlan:
        return text<msg::ScenePlan>(m, [this](const auto& p) { plan(p); });
      case Kind::kDesign:
        return text<msg::CouplingDesign>(m, [this](const auto& d) { design(d); });
      case Kind::kChange:
        return text<msg::EffectChange>(m, [this](const auto& c) { change(c); });
      case Kind::kChanged:
        return text<msg::EffectChanged>(m, [this](const auto& c) { changed(c); });
      case Kind::kMade:
        return text<msg::EffectChange>(m, [this](const auto& c) { made(c); });
      case Kind::kStatus:
        return text<msg::NodeStatus>(m, [this](const auto& s) { status(s); });
      case Kind::kNone:
        return;
    }
  }

  Recording finish() && {
    std::erase_if(out_.sessions, [](const RecordedSession& s) {
      return std::ranges::none_of(s.samples,
                                  [](const auto& one) { return one.second.state.has_value(); });
    });
    if (out_.sessions.empty())
      cannot("{} has no device samples to replay.", path_.string());
    for (RecordedSession& session : out_.sessions) {
      const auto described = devices_.find(session.id);
      if (described == devices_.end())
        cannot(
            "{} has no device description (/{}/{}) for session {}: the coupling cannot be "
            "designed.",
            path_.string(), out_.rig, qos::kDeviceDescription.path, session.id);
      session.device = described->second;
      session.described_anew = anew_.contains(session.id);
      const auto& first = std::ranges::find_if(session.samples, [](const auto& one) {
                            return one.second.state.has_value();
                          })->second;
      out_.lockstep = (first.state->flags & msg::device_state::kFlagLockstep) != 0;
      for (coupling_node::Adoption& design : designs_)
        if (design.session == session.id)
          session.designs.push_back(std::move(design));
    }
    out_.designs = designs_.size();
    if (doubled_ > 0)
      out_.warnings.push_back(
          fmt::format("{} duplicate sequence numbers. Repeated commands are replayed; of other "
                      "messages the first is used.",
                      doubled_));
    return std::move(out_);
  }

 private:
  RecordedSession& session(std::uint64_t id) {
    const auto found = std::ranges::find(out_.sessions, id, &RecordedSession::id);
    if (found != out_.sessions.end())
      return *found;
    out_.sessions.emplace_back().id = id;
    return out_.sessions.back();
  }

  [[noreturn]] void refuse_unreadable(std::string_view type) const {
    cannot(
        "{} has a {} that this version cannot read: it was recorded by another version of "
        "voxtouch, or is damaged.",
        path_.string(), type);
  }

  template <class T>
  void stream(const bag::BagMessage& m, std::optional<T> RecordedSample::*where) {
    T message;
    if (!bus::read_stream(m.bytes, message))
      refuse_unreadable(msg::Type<T>::ros_name);
    RecordedSample& sample = session(message.session_id).samples[message.sequence_number];
    if (sample.*where) {
      ++doubled_;
      if constexpr (std::is_same_v<T, msg::ForceCommand>)
        sample.again.push_back(message);
      return;
    }
    sample.*where = message;
  }

  template <class T, class F>
  void text(const bag::BagMessage& m, F&& f) {
    if (!bus::read_message<T>(m.bytes, f))
      refuse_unreadable(msg::Type<T>::ros_name);
  }

  void device(const msg::DeviceDescription& m, std::span<const std::byte> bytes) {
    DeviceDescription device = runtime::from_msg(m);
    const std::string wrong = validate(device);
    if (!wrong.empty())
      return void(out_.warnings.push_back("Device description refused: " + wrong));
    devices_.try_emplace(m.session_id, device);
    if (!std::ranges::equal(
            described_.try_emplace(m.session_id, bytes.begin(), bytes.end()).first->second, bytes))
      anew_.insert(m.session_id);
  }

  void plan(const msg::ScenePlan& m) {
    out_.plans.push_back({m.session_id, m.from_sample, text_of(m.scene_hash)});
  }

  void design(const msg::CouplingDesign& m) {
    designs_.push_back(coupling_node::adoption_of(m));
    const coupling_node::AdoptedCoupling& design = designs_.back().coupling;
    if (!design.runs)
      return;
    for (const coupling::CouplingIssue& issue :
         coupling::validate(design.spec, design.limits, m.sample_time_s))
      if (issue.refuse)
        cannot("{} has a coupling that cannot run: {}", path_.string(), issue.sentence);
  }

  static RecordedChange requested_by(const msg::EffectChange& m) {
    return {.requested = true,
            .action = m.action,
            .effect = text_of(m.effect),
            .parameter = text_of(m.parameter),
            .model = text_of(m.model),
            .value = {m.value[0], m.value[1], m.value[2]},
            .voxel_size_m = m.voxel_size_m};
  }

  /// The rendering's record of its changes. If a bag has this topic, the others are ignored, so
  /// that each change is made once.
  void made(const msg::EffectChange& m) {
    RecordedChange done = requested_by(m);
    done.session = m.session_id, done.from_sample = m.from_sample;
    done.sentence =
        fmt::format("{}: active from sample {}", rendering_node::in_words(m), m.from_sample);
    out_.changes.push_back(std::move(done));
  }

  /// In bags of before, without that topic: the question, and below the answer, which names the
  /// sample.
  void change(const msg::EffectChange& m) {
    if (records_changes_)
      return;
    RecordedChange requested = requested_by(m);
    if (m.request != 0)
      requests_.insert_or_assign(m.request, std::move(requested));
    else
      nameless_.push_back(std::move(requested));
  }

  /// A repeated request is answered twice and applied once. Requests without a number are answered
  /// in their order.
  void changed(const msg::EffectChanged& m) {
    using namespace msg::effect_changed;
    if (records_changes_)
      return;
    if (m.result == kResultPending || (m.request != 0 && !answered_.insert(m.request).second))
      return;
    RecordedChange made;
    if (m.request == 0 && !nameless_.empty()) {
      made = std::move(nameless_.front());
      nameless_.pop_front();
    } else if (const auto found = requests_.find(m.request); found != requests_.end()) {
      made = found->second;
    }
    made.session = m.session_id, made.from_sample = m.from_sample,
    made.sentence = text_of(m.sentence);
    if (m.result == kResultDone)
      out_.changes.push_back(std::move(made));
  }

  void status(const msg::NodeStatus& m) {
    runtime::Figures& figures = out_.figures[text_of(m.node)];
    out_.processes[text_of(m.node)].insert(m.pid);
    for (std::uint32_t i = 0; i < m.figures._length; ++i)
      figures[text_of(m.figures._buffer[i].name)] =
          runtime::Figure(m.figures._buffer[i].value, text_of(m.figures._buffer[i].unit));
    if (text_of(m.node) != "rendering")
      return;
    for (std::uint32_t i = 0; i < m.values._length; ++i) {
      const std::string key = text_of(m.values._buffer[i].key),
                        value = text_of(m.values._buffer[i].value);
      if (key == "scene_file" && out_.scene_file.empty())
        out_.scene_file = value;
      if (key == "scene" && out_.scene.empty())
        out_.scene = value;
      if (key == "scene_hash" && out_.scene_hash.empty())
        out_.scene_hash = value;
    }
  }

  const std::filesystem::path& path_;
  Recording out_;
  std::vector<Kind> kinds_;  ///< of the bag's topics, by index
  bool records_changes_ = false;
  std::map<std::uint64_t, DeviceDescription> devices_;
  std::map<std::uint64_t, std::vector<std::byte>> described_;  ///< the first description's bytes
  std::set<std::uint64_t> anew_, answered_;
  std::vector<coupling_node::Adoption> designs_;
  std::map<std::uint64_t, RecordedChange> requests_;  ///< by request
  std::deque<RecordedChange> nameless_;
  std::uint64_t doubled_ = 0;
};

}  // namespace

Recording read_recording(const std::filesystem::path& path, const std::string& rig) {
  const auto bag = bag::BagReader::open(path);
  if (!bag)
    throw std::runtime_error(bag.error().sentence);
  Collector collector(*bag, path, rig);
  using Times = std::numeric_limits<std::int64_t>;
  const auto read =
      bag->for_each_between(Times::min(), Times::max(),
                            [&](const bag::BagMessage& m) { return collector.take(m), true; });
  if (!read)
    throw std::runtime_error(read.error().sentence);
  Recording recording = std::move(collector).finish();
  recording.losses = bag->losses();
  return recording;
}

}  // namespace voxtouch::replay
