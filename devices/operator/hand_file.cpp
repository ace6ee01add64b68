#include "devices/operator/hand_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <concepts>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#include "core/types/number.hpp"

namespace voxtouch::hand {
namespace {

/// Every key with its value: the one list that reader and writer walk.
template <class File, class Visit>
void each_key(File& file, Visit&& visit) {
  auto& m = file.motion;
  auto& h = file.hand;
  visit("seed", file.seed);
  visit("posture_rad", file.posture_rad);
  visit("path_m", m.path);
  visit("speed_m_per_s", m.speed_m_per_s);
  visit("hold_s", m.hold_s);
  visit("repeat_from", m.repeat_from);
  visit("circle_centre_m", m.circle_centre);
  visit("circle_axis", m.circle_axis);
  visit("orientation_wxyz", m.orientation);
  visit("turn_axis", m.turn.axis);
  visit("turn_rad", m.turn.angle_rad);
  visit("turn_from_s", m.turn.from_s);
  visit("turn_to_s", m.turn.to_s);
  visit("released", h.released);
  visit("release_time_s", h.release_time_s);
  visit("grip_change_time_s", h.grip_change_time_s);
  visit("grip_factor", h.grip_factor);
  visit("mass_kg", h.mass_kg);
  visit("damping_ns_per_m", h.damping_ns_per_m);
  visit("stiffness_n_per_m", h.stiffness_n_per_m);
  visit("inertia_kg_m2", h.inertia_kg_m2);
  visit("damping_nms_per_rad", h.damping_nms_per_rad);
  visit("stiffness_nm_per_rad", h.stiffness_nm_per_rad);
  visit("carries_tool", h.carries_tool);
  visit("tremor_n", h.tremor_n);
  visit("tremor_bandwidth_hz", h.tremor_bandwidth_hz);
}

template <class T>
concept Number = std::floating_point<T> || std::unsigned_integral<T>;

/// Sets values from nodes; a wrong one throws with the file, and with its line and column.
class Reader {
 public:
  explicit Reader(std::string_view file) : file_(file) {}

  [[noreturn]] void refuse(const YAML::Mark& at, std::string_view why) const {
    throw std::runtime_error(fmt::format("{}:{}:{}: {}", file_, at.line + 1, at.column + 1, why));
  }
  void read(const YAML::Node& node, bool& value) const {
    value = node.Scalar() == "true";
    if (!value && node.Scalar() != "false")
      refuse(node.Mark(), fmt::format("'{}' is not true or false", node.Scalar()));
  }
  template <Number T>
  void read(const YAML::Node& node, T& value) const {
    const std::string text = node.Scalar() == ".inf" ? "inf" : node.Scalar();  // empty for a list
    const auto number = parse_number<T>(text);
    if (!number || *number != *number)
      refuse(node.Mark(), fmt::format("'{}' is not a valid number", text));
    value = *number;
  }
  template <class T>
  void read(const YAML::Node& node, std::optional<T>& value) const {
    read(node, value.emplace());
  }
  template <class T>
  void read(const YAML::Node& node, std::vector<T>& values) const {
    if (!node.IsSequence())
      refuse(node.Mark(), "this must be a list");
    for (const YAML::Node& item : node)
      read(item, values.emplace_back());
  }
  void read(const YAML::Node& node, Vec3& value) const { read_numbers(node, value.data(), 3); }
  void read(const YAML::Node& node, Quat& value) const {
    double wxyz[4];
    read_numbers(node, wxyz, 4);
    value = Quat(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
    if (!(std::abs(value.norm() - 1.0) < 1e-6))
      refuse(node.Mark(), "an orientation must have norm 1");
  }

 private:
  void read_numbers(const YAML::Node& node, double* values, std::size_t count) const {
    if (!node.IsSequence() || node.size() != count)
      refuse(node.Mark(), fmt::format("this must be {} numbers", count));
    for (std::size_t i = 0; i < count; ++i)
      read(node[i], values[i]);
  }
  std::string_view file_;
};

/// A value as YAML: the shortest text that reads back bit-identically, in any locale. Empty without
/// a value.
template <class T>
std::string yaml_of(const T& value) {
  return fmt::to_string(value);
}
std::string yaml_of(double value) { return std::isinf(value) ? ".inf" : fmt::to_string(value); }
std::string yaml_of(const Vec3& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }
std::string yaml_of(const Quat& q) {
  return fmt::format("[{}, {}, {}, {}]", q.w(), q.x(), q.y(), q.z());
}
template <class T>
std::string yaml_of(const std::optional<T>& value) {
  return value ? yaml_of(*value) : "";
}
template <class T>
std::string yaml_of(const std::vector<T>& values) {
  std::vector<std::string> texts;
  for (const T& value : values)
    texts.push_back(yaml_of(value));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

}  // namespace

std::string to_text(const HandFile& file) {
  std::string text;
  each_key(file, [&](std::string_view key, const auto& value) {
    if (const std::string one = yaml_of(value); !one.empty())
      text += fmt::format("{}: {}\n", key, one);
  });
  return text;
}

HandFile parse_hand(std::string_view text, std::string_view name) {
  const Reader reader(name);
  std::map<std::string, YAML::Node> values;
  std::map<std::string, YAML::Mark> places;
  try {
    // The first document alone: LoadAll does not end with every text.
    const YAML::Node root = YAML::Load(std::string(text));
    // Behind a map in braces, or a mark between documents, anything could follow unread.
    if (!root.IsMap() || root.Style() == YAML::EmitterStyle::Flow ||
        text.find("\n---") != text.npos || text.find("\n...") != text.npos)
      throw std::runtime_error(fmt::format(
          "{}: a hand file is one map with one key a line (path_m ... tremor_bandwidth_hz)", name));
    for (const auto& entry : root) {
      const std::string& key = entry.first.Scalar();
      if (!places.emplace(key, entry.first.Mark()).second)
        reader.refuse(entry.first.Mark(), fmt::format("duplicate key {}", key));
      values.emplace(key, entry.second);
    }
  } catch (const YAML::Exception& error) {
    reader.refuse(error.mark, error.msg);
  }
  HandFile file;
  each_key(file, [&](const char* key, auto& value) {
    if (const auto given = values.extract(key))
      reader.read(given.mapped(), value);
  });
  if (!values.empty()) {
    std::vector<std::string_view> keys;
    each_key(file, [&](const char* key, auto&) { keys.emplace_back(key); });
    const std::string& unknown = values.begin()->first;
    reader.refuse(places.at(unknown),
                  fmt::format("unknown key '{}'. Valid keys: {}", unknown, fmt::join(keys, ", ")));
  }
  if (file.motion.path.empty())
    throw std::runtime_error(fmt::format("{}: path_m needs at least one way point", name));
  file.hand.validate();
  return file;
}

HandFile read_hand(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  if (!in)
    throw std::runtime_error(
        fmt::format("cannot read '{}': check its name and permissions", path.string()));
  return parse_hand(text.str(), path.string());
}

}  // namespace voxtouch::hand
