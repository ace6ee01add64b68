#include "nodes/view/picture.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <nlohmann/json.hpp>

#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/stamps.hpp"
#include "nodes/view/rounded.hpp"

namespace voxtouch::view {
namespace {

using nlohmann::json;
using runtime::from_msg;

json to_json(const Vec3& v) { return {rounded(v.x()), rounded(v.y()), rounded(v.z())}; }
json to_json(const Pose& p) {
  return {rounded(p.position.x()),    rounded(p.position.y()),    rounded(p.position.z()),
          rounded(p.orientation.x()), rounded(p.orientation.y()), rounded(p.orientation.z()),
          rounded(p.orientation.w())};
}

/// The force of a command in world axes; its norm is that of the device.
Vec3 in_world(const msg::ForceCommand& command, const scene::Scene* scene) {
  const Vec3 force = from_msg(command.wrench.force);
  return scene ? scene->device.pose_WD.orientation * force : force;
}

using FlagName = std::pair<std::uint32_t, const char*>;
constexpr FlagName kContactFlagNames[] = {
    {msg::contact_state::kFlagLatched, "latched"},
    {msg::contact_state::kFlagFast, "fast"},
    {msg::contact_state::kFlagRefusedSample, "sample refused"},
    {msg::contact_state::kFlagSaturated, "saturated"},
    {msg::contact_state::kFlagFading, "fading"},
    {msg::contact_state::kFlagTunnellingSuspected, "tunnelling"},
    {msg::contact_state::kFlagClutched, "clutch"},
    {msg::contact_state::kFlagFallback, "fallback"}};
constexpr FlagName kCommandStatusNames[] = {
    {msg::force_command::kStatusRamping, "ramping"},
    {msg::force_command::kStatusLatchedInput, "input latched"},
    {msg::force_command::kStatusClamped, "clamped"},
    {msg::force_command::kStatusCapped, "capped"},
    {msg::force_command::kStatusGrowing, "growing"},
    {msg::force_command::kStatusBounded, "damping bounded"}};

/// Names of the set bits.
json names_of(std::uint32_t bits, std::span<const FlagName> known) {
  json words = json::array();
  for (const auto& [bit, word] : known)
    if (bits & bit)
      words.push_back(word);
  return words;
}

/// A virtual tool stays outside: the depth is the hand's.
double depth_of(const msg::ContactState& c) {
  if (!(c.flags & msg::contact_state::kFlagConstrained))
    return c.deepest_depth_m;
  return (from_msg(c.tool_pose).position - from_msg(c.object_pose).position).norm();
}

double force_norm(const msg::geometry_msgs_Wrench& wrench) { return from_msg(wrench.force).norm(); }

}  // namespace

void LatencyCounts::sample(std::uint64_t sequence, std::int64_t written_ns) noexcept {
  if (written_ns > 0)
    written_[sequence % kKept] = {sequence, written_ns};
}

void LatencyCounts::command(std::uint64_t sequence, std::int64_t written_ns) noexcept {
  const Written& sample = written_[sequence % kKept];
  if (sample.sequence != sequence || written_ns < sample.at_ns)
    return;
  recent_us_.push_back(static_cast<float>(static_cast<double>(written_ns - sample.at_ns) * 1e-3));
  if (recent_us_.size() > kRecent)
    recent_us_.pop_front();
}

json LatencyCounts::to_json() const {
  if (recent_us_.empty())
    return nullptr;
  std::vector<float> sorted(recent_us_.begin(), recent_us_.end());
  std::ranges::sort(sorted);
  std::vector<int> counts(kBins, 0);
  for (const float us : sorted)
    ++counts[std::min(kBins - 1, static_cast<std::size_t>(us / kBinUs))];
  const auto quantile = [&](double q) {
    return std::round(sorted[static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1))]);
  };
  return {{"bin_us", kBinUs},
          {"counts", counts},
          {"p50_us", quantile(0.5)},
          {"p99_us", quantile(0.99)},
          {"samples", sorted.size()}};
}

void Picture::begin(std::uint64_t session, std::int64_t sample_time_ns) {
  if (session == session_ && begin_ns_)
    return;
  clear();
  session_ = session;
  begin_ns_ = sample_time_ns;
}

void Picture::take(const msg::DeviceState& state, std::int64_t written_ns) {
  begin(state.session_id, state.sample_time_ns);
  state_ = state;
  time_s_ = runtime::seconds_between(*begin_ns_, state.sample_time_ns);
  latency_.sample(state.sequence_number, written_ns);
  has_update_ = true;
}

void Picture::take(const msg::ContactState& contact) {
  if (contact.session_id != session_)
    return;
  if (!contact_) {  // the rendering defines the start of the session
    begin_ns_ = runtime::ns_between(contact.scene_time_ns, contact.sample_time_ns);
    open_.clear();
  }
  contact_ = contact;
  has_update_ = true;
  Row* at = row(contact.sample_time_ns);
  if (!at)
    return;
  const auto peak_of = [](const msg::ContactState& c) {
    return std::pair{depth_of(c), force_norm(c.contact_wrench)};
  };
  if (!at->contact || peak_of(contact) > peak_of(*at->contact))
    at->contact = contact;
}

void Picture::take(const msg::ForceCommand& command, std::int64_t written_ns) {
  if (command.session_id != session_ || !begin_ns_)
    return;
  command_ = command;
  latency_.command(command.sequence_number, written_ns);
  has_update_ = true;
  Row* at = row(command.sample_time_ns);
  if (at && (!at->command || force_norm(command.wrench) > force_norm(at->command->wrench)))
    at->command = command;
}

/// Null for a sample whose row is final, and for invalid time stamps, which any participant can
/// send.
Picture::Row* Picture::row(std::int64_t sample_time_ns) {
  constexpr std::size_t kMaxOpenRows = 4096;
  const std::int64_t index = runtime::ns_between(*begin_ns_, sample_time_ns) / kRowNs;
  if (index <= closed_to_ || (open_.size() >= kMaxOpenRows && !open_.contains(index)))
    return nullptr;
  return &open_[index];
}

/// Closes rows two rows after their end: the command of a sample arrives one pass of the ring after
/// its contact.
void Picture::close_rows(const scene::Scene* scene) {
  constexpr std::int64_t kRowsBehind = 2;
  while (!open_.empty() && open_.begin()->first + kRowsBehind < open_.rbegin()->first) {
    const auto oldest = open_.begin();
    closed_.push_back(row_json(oldest->first, oldest->second, scene));
    closed_to_ = oldest->first;
    ++unsent_rows_;
    open_.erase(oldest);
  }
  const double newest_s = closed_.empty() ? 0.0 : closed_.back()[0].get<double>();
  while (!closed_.empty() && closed_.front()[0].get<double>() < newest_s - kPastS)
    closed_.pop_front();
  unsent_rows_ = std::min(unsent_rows_, closed_.size());
}

/// time [s]; returned force x, y, z and norm, contact force [N]; depth [mm]; energy [mJ]; force of
/// injected damping [N]. Null without a message.
json Picture::row_json(std::int64_t index, const Row& row, const scene::Scene* scene) const {
  json r = {rounded(static_cast<double>(index * kRowNs) * 1e-9)};
  if (row.command) {
    const Vec3 force = in_world(*row.command, scene);
    for (const double x : {force.x(), force.y(), force.z(), force.norm()})
      r.push_back(rounded(x));
  } else {
    r.insert(r.end(), 4, nullptr);
  }
  if (row.contact) {
    r.push_back(rounded(force_norm(row.contact->contact_wrench)));
    r.push_back(rounded(depth_of(*row.contact) * 1e3));
  } else {
    r.insert(r.end(), 2, nullptr);
  }
  if (row.command) {
    r.push_back(rounded(row.command->energy_j * 1e3));
    r.push_back(rounded(row.command->injected_n));
  } else {
    r.insert(r.end(), 2, nullptr);
  }
  return r;
}

json Picture::frame(const scene::Scene* scene) {
  close_rows(scene);
  json f = {{"type", "frame"}, {"session", std::to_string(session_)}, {"t", rounded(time_s_)}};
  if (state_)
    f["sample"] = state_->sequence_number;
  if (contact_) {
    const msg::ContactState& c = *contact_;
    f["tool"] = to_json(from_msg(c.tool_pose));
    f["object"] = to_json(from_msg(c.object_pose));
    f["contact_force"] = to_json(from_msg(c.contact_wrench.force));
    f["effects_force"] = to_json(from_msg(c.effects_wrench.force));
    f["depth"] = rounded(depth_of(c));
    f["hits"] = c.surface_hits + c.interior_hits;
    f["flags"] = names_of(c.flags, kContactFlagNames);
    if (scene)
      for (std::size_t n = 0; n < scene->objects.size(); ++n)
        if (const auto& moves = scene->objects[n].moves)
          f["moved"][std::to_string(n + 1)] =
              to_json(motion_at(*moves, static_cast<double>(c.scene_time_ns) * 1e-9).position);
  }
  if (command_) {
    f["force"] = to_json(in_world(*command_, scene));
    f["limits"] = names_of(command_->status, kCommandStatusNames);
  }
  f["rows"] =
      std::vector<json>(closed_.end() - static_cast<std::ptrdiff_t>(unsent_rows_), closed_.end());
  unsent_rows_ = 0;
  has_update_ = false;
  return f;
}

json Picture::past(const scene::Scene* scene) {
  close_rows(scene);
  return {{"type", "past"}, {"session", std::to_string(session_)}, {"rows", closed_}};
}

}  // namespace voxtouch::view
