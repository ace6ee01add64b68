#include "nodes/view/bag_player.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "nodes/bag/bag_origin.hpp"
#include "nodes/bus/wire_form.hpp"
#include "nodes/runtime/realtime.hpp"
#include "nodes/view/rounded.hpp"
#include "qos/topics.hpp"
#include "voxtouch_msgs/all_types.hpp"

namespace voxtouch::view {
namespace {

constexpr std::size_t kHeader = 4;  ///< of CDR

/// The ring's streams are of fixed size and without padding: their CDR is the struct.
template <class T>
bool read_stream(std::span<const std::byte> bytes, T& message) {
  if (bytes.size() != sizeof message + kHeader) return false;
  std::memcpy(&message, bytes.data() + kHeader, sizeof message);
  return true;
}

std::string_view hash_of(std::string_view type) {
  const auto known = std::ranges::find(msg::kAllTypes, type, &msg::AnyType::ros_name);
  return known == std::end(msg::kAllTypes) ? std::string_view() : known->hash;
}

bag::BagReader open(const std::filesystem::path& path) {
  if (const std::string why = bag::why_other_layout(path, hash_of); !why.empty()) throw std::runtime_error(why);
  auto reader = bag::BagReader::open(path);
  if (!reader) throw std::runtime_error(reader.error().sentence);
  return std::move(*reader);
}

/// What `up` has left beside the bag, as the page shows it; null where it left nothing.
nlohmann::json verdict_beside(const std::filesystem::path& path) {
  std::ifstream file((std::filesystem::is_directory(path) ? path : path.parent_path()) / "voxtouch_run.json");
  const auto told = nlohmann::json::parse(file, nullptr, false);
  if (!told.is_object() || !told.contains("ok") || !told["ok"].is_boolean() || !told.contains("problems") || !told["problems"].is_array()) return nullptr;
  nlohmann::json problems = nlohmann::json::array();
  for (const auto& problem : told["problems"])
    if (problem.is_string()) problems.push_back(problem);
  return {{"good", told["ok"].get<bool>() && told["problems"].empty()}, {"problems", std::move(problems)}};
}

}  // namespace

/// What each of the bag's topics holds, and the readers of types with strings.
struct BagPlayer::Types {
  enum class Kind : std::uint8_t { kNone, kState, kContact, kCommand, kPlan, kDesign, kDevice, kChange, kChanged, kStatus };
  explicit Types(dds_entity_t participant)
      : plan(participant), design(participant), device(participant), change(participant), changed(participant), status(participant) {}
  std::vector<Kind> kinds;           ///< of the bag's topics, by index
  std::vector<std::size_t> seldom;   ///< topics whose last message counts however old it is
  bus::WireForm<msg::ScenePlan> plan;
  bus::WireForm<msg::CouplingDesign> design;
  bus::WireForm<msg::DeviceDescription> device;
  bus::WireForm<msg::EffectChange> change;
  bus::WireForm<msg::EffectChanged> changed;
  bus::WireForm<msg::NodeStatus> status;
  struct Seldom {
    std::int64_t time_ns = 0;
    std::size_t topic = 0;
    std::vector<std::byte> bytes;
  };
  std::vector<Seldom> facts;  ///< all messages of those, by time; of the thread that collects them, until it has
};

BagPlayer::BagPlayer(const bus::Participant& participant, const std::filesystem::path& path)
    : reader_(open(path)), verdict_(verdict_beside(path)), types_(std::make_unique<Types>(participant.get())) {
  using Kind = Types::Kind;
  constexpr std::pair<std::string_view, Kind> kKinds[] = {
      {qos::kDeviceState.path, Kind::kState},          {qos::kContactState.path, Kind::kContact},
      {qos::kForceCommand.path, Kind::kCommand},       {qos::kScenePlan.path, Kind::kPlan},
      {qos::kCouplingDesign.path, Kind::kDesign},      {qos::kDeviceDescription.path, Kind::kDevice},
      {qos::kEffectChange.path, Kind::kChange},        {qos::kEffectChanged.path, Kind::kChanged},
      {qos::kNodeStatus.path, Kind::kStatus}};
  bool any = false;
  for (const bag::TopicInfo& topic : reader_.topics()) {
    Kind kind = Kind::kNone;
    for (const auto& [name, of] : kKinds)
      if (topic.name.ends_with("/" + std::string(name))) kind = of;
    any = any || kind == Kind::kState || kind == Kind::kContact;
    const bool seldom = kind >= Kind::kPlan && kind <= Kind::kChanged;
    if (seldom) types_->seldom.push_back(types_->kinds.size());
    types_->kinds.push_back(kind);
  }
  if (!any) throw std::runtime_error(fmt::format("{} holds no messages of a ring", path.string()));
  const auto times = reader_.times();
  if (!times) throw std::runtime_error(times.error().sentence);
  if (!*times) throw std::runtime_error(fmt::format("{} is empty", path.string()));
  std::tie(begin_ns_, end_ns_) = **times;
  collecting_ = std::thread([this, path] {
    runtime::ordinary_priority();
    collect_facts(path);
  });
}

/// What is said seldom may lie anywhere in a long recording: it is looked for beside the picture.
void BagPlayer::collect_facts(const std::filesystem::path& path) {
  const auto reader = bag::BagReader::open(path);
  if (!reader) return;
  (void)reader->for_each_between(begin_ns_, end_ns_ + 1, [&](const bag::BagMessage& m) {
    if (std::ranges::find(types_->seldom, m.topic) != types_->seldom.end())
      types_->facts.push_back({m.time_ns, m.topic, {m.bytes.begin(), m.bytes.end()}});
    return !stop_.load();
  });
  collected_.store(true, std::memory_order_release);
}

BagPlayer::~BagPlayer() {
  stop_.store(true);
  if (collecting_.joinable()) collecting_.join();
}

void BagPlayer::play(bool on) {
  const double end_s = static_cast<double>(end_ns_ - begin_ns_) * 1e-9;
  if (on && at_s_ >= end_s) seek_s_ = 0.0;  // once more from the start
  playing_ = on;
}
void BagPlayer::speed(double times) { speed_ = std::clamp(times, kSlowest, kFastest); }
void BagPlayer::seek(double to_s) { seek_s_ = std::clamp(to_s, 0.0, static_cast<double>(end_ns_ - begin_ns_) * 1e-9); }
std::int64_t BagPlayer::now_ns() const noexcept { return begin_ns_ + static_cast<std::int64_t>(at_s_ * 1e9); }

bool BagPlayer::advance(double elapsed_s, Picture& picture, Facts& facts, NodeTable& nodes) {
  const bool all_known = collected_.load(std::memory_order_acquire);
  if (all_known && !std::exchange(knew_all_, true) && at_s_ > kPastS && !seek_s_) seek_s_ = at_s_;  // the same place, with all that is known
  const bool jump = seek_s_.has_value();
  if (jump) {
    at_s_ = *std::exchange(seek_s_, std::nullopt);
    picture.forget(), nodes.forget(), facts.restart();
    const std::int64_t from_ns = now_ns() - static_cast<std::int64_t>(kPastS * 1e9);
    for (const Types::Seldom& fact : all_known ? std::span<const Types::Seldom>(types_->facts) : std::span<const Types::Seldom>())
      if (fact.time_ns < from_ns)  // whatever was said before holds
        take({fact.topic, fact.time_ns, 0, fact.bytes}, picture, facts, nodes);
    feed(from_ns, now_ns() + 1, picture, facts, nodes);
  }
  if (!playing_) return jump;
  const std::int64_t before_ns = now_ns();
  at_s_ = std::min(at_s_ + elapsed_s * speed_, static_cast<double>(end_ns_ - begin_ns_) * 1e-9);
  if (now_ns() + 1 >= end_ns_) playing_ = false;
  feed(before_ns + 1, now_ns() + 1, picture, facts, nodes);
  return jump;
}

void BagPlayer::feed(std::int64_t from_ns, std::int64_t to_ns, Picture& picture, Facts& facts, NodeTable& nodes) {
  (void)reader_.for_each_between(from_ns, to_ns, [&](const bag::BagMessage& message) {
    take(message, picture, facts, nodes);
    return true;
  });
}

void BagPlayer::take(const bag::BagMessage& m, Picture& picture, Facts& facts, NodeTable& nodes) {
  using Kind = Types::Kind;
  const std::string_view cdr(reinterpret_cast<const char*>(m.bytes.data()), m.bytes.size());
  const auto fact = [&](const auto& message) { facts.take(message); };
  switch (types_->kinds[m.topic]) {
    case Kind::kState:
      // Not written then, but taken by the logger, like its command: between the two lies the way round the ring. Simulated times measure nothing.
      if (msg::DeviceState state; read_stream(m.bytes, state)) picture.take(state, state.flags & msg::device_state::kFlagLockstep ? 0 : m.time_ns);
      break;
    case Kind::kContact:
      if (msg::ContactState contact; read_stream(m.bytes, contact)) picture.take(contact);
      break;
    case Kind::kCommand:
      if (msg::ForceCommand command; read_stream(m.bytes, command)) picture.take(command, m.time_ns);
      break;
    case Kind::kPlan: types_->plan.read(cdr, fact); break;
    case Kind::kDesign: types_->design.read(cdr, fact); break;
    case Kind::kDevice: types_->device.read(cdr, fact); break;
    case Kind::kChange: types_->change.read(cdr, fact); break;
    case Kind::kChanged: types_->changed.read(cdr, fact); break;
    case Kind::kStatus:
      types_->status.read(cdr, [&](const msg::NodeStatus& status) {
        runtime::NodeReport report = runtime::to_report(status);
        if (const auto file = report.values.find("scene_file"); file != report.values.end()) scene_file_ = file->second;
        nodes.update(std::move(report), m.time_ns);
      });
      break;
    case Kind::kNone: break;
  }
}

nlohmann::json BagPlayer::to_json() const {
  return {{"t", rounded(at_s_)}, {"duration", rounded(static_cast<double>(end_ns_ - begin_ns_) * 1e-9)}, {"playing", playing_}, {"speed", speed_},
          {"verdict", verdict_}};
}

}  // namespace voxtouch::view
