#include "devices/operator/hand_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "core/types/number.hpp"

namespace voxtouch {
namespace {

constexpr std::string_view kFormat = "voxtouch-hand-1";

/// One line of the file with what a message about it needs.
struct Line {
  std::string_view file, key, value;
  std::size_t number = 0;

  [[noreturn]] void refuse(const std::string& why) const {
    throw std::runtime_error(fmt::format("{}:{}: {}", file, number, why));
  }
};

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

template <class Number>
Number number_of(const Line& line, std::string_view word) {
  const auto value = parse_number<Number>(word);
  if (!value || *value != *value)  // NaN
    line.refuse(fmt::format("'{}' of {} is no number that fits", word, line.key));
  return *value;
}

std::vector<double> numbers_of(const Line& line) {
  std::vector<double> out;
  for (std::string_view rest = line.value; !rest.empty();) {
    const auto blank = rest.find_first_of(" \t");
    out.push_back(number_of<double>(line, rest.substr(0, blank)));
    rest = blank == std::string_view::npos ? std::string_view() : trimmed(rest.substr(blank));
  }
  return out;
}

std::vector<double> numbers_of(const Line& line, std::size_t count) {
  std::vector<double> out = numbers_of(line);
  if (out.size() != count) line.refuse(fmt::format("{} needs {} numbers, not {}", line.key, count, out.size()));
  return out;
}

Vec3 vector_of(const Line& line) {
  const std::vector<double> v = numbers_of(line, 3);
  return {v[0], v[1], v[2]};
}

Quat quaternion_of(const Line& line) {
  const std::vector<double> v = numbers_of(line, 4);
  const Quat q(v[0], v[1], v[2], v[3]);
  if (!(std::abs(q.norm() - 1.0) < 1e-6)) line.refuse("orientation_wxyz has to be of length 1");
  return q;
}

bool truth_of(const Line& line) {
  if (line.value != "0" && line.value != "1") line.refuse(fmt::format("{} has to be 0 or 1", line.key));
  return line.value == "1";
}

struct Key {
  std::string_view name;
  std::function<void(HandFile&, const Line&)> set;
};

/// A key for a number of the operator or the motion.
template <class Owner>
Key number_key(std::string_view name, Owner HandFile::*owner, double Owner::*field) {
  return {name, [owner, field](HandFile& f, const Line& l) { (f.*owner).*field = numbers_of(l, 1)[0]; }};
}
Key truth_key(std::string_view name, bool OperatorConfig::*field) {
  return {name, [field](HandFile& f, const Line& l) { f.hand.*field = truth_of(l); }};
}

const std::vector<Key>& keys() {
  using O = OperatorConfig;
  static const std::vector<Key> all = {
      {"seed", [](HandFile& f, const Line& l) { f.seed = number_of<std::uint64_t>(l, l.value); }},
      {"posture_rad", [](HandFile& f, const Line& l) { f.posture_rad = numbers_of(l); }},
      {"waypoint_m", [](HandFile& f, const Line& l) { f.motion.path.push_back(vector_of(l)); }},
      number_key("speed_m_per_s", &HandFile::motion, &Motion::speed_m_per_s),
      number_key("hold_s", &HandFile::motion, &Motion::hold_s),
      {"repeat_from", [](HandFile& f, const Line& l) { f.motion.repeat_from = number_of<std::size_t>(l, l.value); }},
      {"circle_centre_m", [](HandFile& f, const Line& l) { f.motion.circle_centre = vector_of(l); }},
      {"circle_axis", [](HandFile& f, const Line& l) { f.motion.circle_axis = vector_of(l); }},
      {"orientation_wxyz", [](HandFile& f, const Line& l) { f.motion.orientation = quaternion_of(l); }},
      truth_key("released", &O::released),
      number_key("let_go_at_s", &HandFile::hand, &O::let_go_at_s),
      number_key("grip_harder_at_s", &HandFile::hand, &O::grip_harder_at_s),
      number_key("grip_factor", &HandFile::hand, &O::grip_factor),
      number_key("mass_kg", &HandFile::hand, &O::mass_kg),
      number_key("damping_ns_per_m", &HandFile::hand, &O::damping_ns_per_m),
      number_key("stiffness_n_per_m", &HandFile::hand, &O::stiffness_n_per_m),
      number_key("inertia_kg_m2", &HandFile::hand, &O::inertia_kg_m2),
      number_key("damping_nms_per_rad", &HandFile::hand, &O::damping_nms_per_rad),
      number_key("stiffness_nm_per_rad", &HandFile::hand, &O::stiffness_nm_per_rad),
      truth_key("carries_tool", &O::carries_tool),
      number_key("tremor_n", &HandFile::hand, &O::tremor_n),
      number_key("tremor_bandwidth_hz", &HandFile::hand, &O::tremor_bandwidth_hz),
  };
  return all;
}

void take(HandFile& file, const Line& line) {
  for (const Key& key : keys())
    if (key.name == line.key) return key.set(file, line);
  line.refuse(fmt::format("there is no key '{}'; the header hand_file.hpp lists them", line.key));
}

template <class... Numbers>
void put(std::string& text, std::string_view key, const Numbers&... numbers) {
  text += fmt::format("{} =", key);
  ((text += fmt::format(" {}", numbers)), ...);  // shortest text that reads back to the same bits; no locale
  text += '\n';
}
void put(std::string& text, std::string_view key, const Vec3& v) { put(text, key, v.x(), v.y(), v.z()); }

}  // namespace

std::string to_text(const HandFile& f) {
  std::string text = fmt::format("format = {}\n", kFormat);
  put(text, "seed", f.seed);
  if (!f.posture_rad.empty()) {
    text += "posture_rad =";
    for (const double q : f.posture_rad) text += fmt::format(" {}", q);
    text += '\n';
  }
  const Motion& m = f.motion;
  for (const Vec3& point : m.path) put(text, "waypoint_m", point);
  put(text, "speed_m_per_s", m.speed_m_per_s);
  put(text, "hold_s", m.hold_s);
  if (m.repeat_from) put(text, "repeat_from", *m.repeat_from);
  if (m.circle_centre) put(text, "circle_centre_m", *m.circle_centre);
  put(text, "circle_axis", m.circle_axis);
  put(text, "orientation_wxyz", m.orientation.w(), m.orientation.x(), m.orientation.y(), m.orientation.z());
  const OperatorConfig& h = f.hand;
  put(text, "released", static_cast<int>(h.released));
  put(text, "let_go_at_s", h.let_go_at_s);
  put(text, "grip_harder_at_s", h.grip_harder_at_s);
  put(text, "grip_factor", h.grip_factor);
  put(text, "mass_kg", h.mass_kg);
  put(text, "damping_ns_per_m", h.damping_ns_per_m);
  put(text, "stiffness_n_per_m", h.stiffness_n_per_m);
  put(text, "inertia_kg_m2", h.inertia_kg_m2);
  put(text, "damping_nms_per_rad", h.damping_nms_per_rad);
  put(text, "stiffness_nm_per_rad", h.stiffness_nm_per_rad);
  put(text, "carries_tool", static_cast<int>(h.carries_tool));
  put(text, "tremor_n", h.tremor_n);
  put(text, "tremor_bandwidth_hz", h.tremor_bandwidth_hz);
  return text;
}

HandFile parse_hand(std::string_view text, std::string_view name) {
  HandFile file;
  std::set<std::string_view> seen;
  std::size_t number = 0;
  bool headed = false;
  while (!text.empty()) {
    const auto end = text.find('\n');
    std::string_view raw = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    ++number;
    raw = trimmed(raw.substr(0, raw.find('#')));
    if (raw.empty()) continue;
    const auto equals = raw.find('=');
    Line line{name, trimmed(raw.substr(0, equals)), {}, number};
    if (equals == std::string_view::npos) line.refuse("a line has to be KEY = VALUE");
    line.value = trimmed(raw.substr(equals + 1));
    if (!headed && (line.key != "format" || line.value != kFormat))
      line.refuse(fmt::format("the first line has to be 'format = {}'", kFormat));
    if (std::exchange(headed, true) == false) continue;
    if (line.value.empty()) line.refuse(fmt::format("{} has no value", line.key));
    if (!seen.insert(line.key).second && line.key != "waypoint_m")
      line.refuse(fmt::format("{} is there twice", line.key));
    take(file, line);
  }
  if (file.motion.path.empty())
    throw std::runtime_error(fmt::format("{}: no waypoint_m; a hand needs at least one", name));
  file.hand.validate();
  return file;
}

void write_hand(const std::filesystem::path& path, const HandFile& file) {
  std::ofstream out(path, std::ios::binary);
  out << to_text(file);
  out.close();
  if (!out) throw std::runtime_error(fmt::format("'{}' cannot be written: check folder and disk", path.string()));
}

HandFile read_hand(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  if (!in) throw std::runtime_error(fmt::format("'{}' cannot be read: check its name and rights", path.string()));
  return parse_hand(text.str(), path.string());
}

}  // namespace voxtouch
