#include "core/scene/map_reader.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>

#include "core/types/number.hpp"

namespace voxtouch::scene {
namespace {

/// Edits (insert, delete, replace) between two words.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0U : 1U)});
      diagonal = above;
    }
  }
  return row.back();
}

[[noreturn]] void mistyped(const SceneSource& source, const YamlNode& node, std::string_view what,
                           std::string_view requested) {
  source.fail(node.place,
              fmt::format("'{}' must be {}, but is {}.", what, requested, describe(node)));
}

bool is_word(const YamlNode& node) { return node.kind == YamlNode::Kind::kScalar && !node.quoted; }

bool is_not_finite_word(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z')
      c = static_cast<char>(c - 'A' + 'a');
  if (!text.empty() && (text[0] == '+' || text[0] == '-'))
    text.erase(0, 1);
  if (!text.empty() && text[0] == '.')
    text.erase(0, 1);
  return text == "inf" || text == "infinity" || text == "nan";
}

/// Retired keys and values with their replacements.
struct Renamed {
  std::string_view old_name, name;
};
constexpr std::array kRenamed{
    Renamed{"damper_share", "damping_force_ratio"}, Renamed{"damping_floor", "min_damping_ratio"},
    Renamed{"lost_in_a_row", "consecutive_losses"}, Renamed{"model_alone", "memoryless"},
    Renamed{"rotation_damping_floor", "rotation_min_damping_ratio"}};

std::vector<std::string_view> with_keys_of(const KeyGroup& group,
                                           std::vector<std::string_view> words) {
  for (const Key& key : group.keys)
    words.push_back(key.name);
  return words;
}

}  // namespace

std::string_view nearest_word(std::string_view word, const std::vector<std::string_view>& allowed) {
  std::string_view best;
  std::size_t best_edits = std::min<std::size_t>(3, (word.size() + 2) / 3) + 1;
  if (word.size() > 64)
    return best;
  for (const std::string_view candidate : allowed) {
    std::size_t edits = edit_distance(word, candidate);
    // A unit left off or put on is the commonest slip: stiffness for stiffness_n_per_m,
    // voxel_size_m for voxel_size.
    const auto [shorter, longer] =
        word.size() < candidate.size() ? std::pair{word, candidate} : std::pair{candidate, word};
    if (shorter.size() >= 4 && longer.starts_with(shorter) && longer[shorter.size()] == '_')
      edits = 1;
    if (edits < best_edits)
      best = candidate, best_edits = edits;
  }
  return best;
}

std::string suggestion(std::string_view word, const std::vector<std::string_view>& allowed) {
  for (const auto& [old_name, name] : kRenamed)
    if (word == old_name && std::ranges::find(allowed, name) != allowed.end())
      return fmt::format("; its name is '{}'.", name);
  const std::string_view near = nearest_word(word, allowed);
  return near.empty() ? std::string() : fmt::format("; did you mean '{}'?", near);
}

std::string listed(const std::vector<std::string_view>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

double read_number(const SceneSource& source, const YamlNode& node, std::string_view what) {
  if (!is_word(node))
    mistyped(source, node, what, "a number");
  if (is_not_finite_word(node.text))
    mistyped(source, node, what, "a finite number");
  std::string_view digits = node.text;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-' && digits[1] != '+')
    digits.remove_prefix(1);
  const auto value = parse_number<double>(digits);
  if (!value && value.error() == std::errc::result_out_of_range)
    mistyped(source, node, what, "a finite number within the range of a double");
  if (!value)
    mistyped(source, node, what, "a number");
  return *value;
}

std::string read_text(const SceneSource& source, const YamlNode& node, std::string_view what) {
  if (node.kind != YamlNode::Kind::kScalar)
    mistyped(source, node, what, "a text");
  if (node.text.empty())
    source.fail(node.place, fmt::format("'{}' is empty.", what));
  return node.text;
}

std::string fault_of_name(std::string_view name) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.';
  };
  if (name.empty())
    return "is empty";
  if (name.size() > kLongestName)
    return fmt::format("is longer than {} characters", kLongestName);
  if (name.front() == '.')
    return "begins with a '.'";
  if (!std::all_of(name.begin(), name.end(), plain))
    return "has characters other than letters, digits, '_', '-' and '.'";
  return {};
}

Vec3 read_vec3(const SceneSource& source, const YamlNode& node, std::string_view what) {
  if (node.kind != YamlNode::Kind::kSequence || node.items.size() != 3)
    mistyped(source, node, what, "a list of 3 numbers [x, y, z]");
  return {read_number(source, node.items[0], what), read_number(source, node.items[1], what),
          read_number(source, node.items[2], what)};
}

std::size_t read_choice(const SceneSource& source, const YamlNode& node, std::string_view what,
                        const std::vector<std::string_view>& allowed) {
  if (node.kind != YamlNode::Kind::kScalar)
    mistyped(source, node, what, fmt::format("one of: {}", listed(allowed)));
  const auto found = std::find(allowed.begin(), allowed.end(), node.text);
  if (found == allowed.end())
    source.fail(
        node.place,
        fmt::format("'{}' must be one of: {}; it is {}{}", what, listed(allowed), describe(node),
                    suggestion(node.text, allowed).empty() ? "." : suggestion(node.text, allowed)));
  return static_cast<std::size_t>(found - allowed.begin());
}

const std::vector<YamlNode>& read_list(const SceneSource& source, const YamlNode& node,
                                       std::string_view what) {
  if (node.kind != YamlNode::Kind::kSequence)
    mistyped(source, node, what, "a list");
  return node.items;
}

namespace {

double read_within(const SceneSource& source, const YamlNode& node, std::string_view what,
                   double low, double high) {
  const double value = read_number(source, node, what);
  if (value < low)
    source.fail(node.place, fmt::format("'{}' is {}; it must be {} or above.", what, value, low));
  if (value > high)
    source.fail(node.place, fmt::format("'{}' is {}; limits {} to {}.", what, value, low, high));
  return value;
}

std::uint64_t read_count(const SceneSource& source, const YamlNode& node, std::string_view what) {
  if (!is_word(node))
    mistyped(source, node, what, "a whole number from 0");
  const auto value = parse_number<std::uint64_t>(node.text);
  if (!value)
    mistyped(source, node, what, "a whole number from 0");
  return *value;
}

}  // namespace

void read_value(const SceneSource& source, const YamlNode& node, const Key& key, double& out) {
  if (key.kind != KeyKind::kPositive)
    return void(out = read_within(source, node, key.name, key.low, key.high));
  out = read_number(source, node, key.name);
  if (!(out > 0.0))
    source.fail(node.place, fmt::format("'{}' is {}; it must be above 0.", key.name, out));
}

void read_value(const SceneSource& source, const YamlNode& node, const Key& key, std::size_t& out) {
  out = read_count(source, node, key.name);
  if (static_cast<double>(out) > key.high)
    source.fail(node.place, fmt::format("'{}' is {}; limits 0 to {}.", key.name, out, key.high));
}

void read_value(const SceneSource& source, const YamlNode& node, const Key& key,
                std::uint32_t& out) {
  const std::uint64_t button = read_count(source, node, key.name);
  if (button > kLastButton)
    source.fail(node.place, fmt::format("'{}' is {}; button numbers are 0 to {}.", key.name, button,
                                        kLastButton));
  out = static_cast<std::uint32_t>(button);
}

void read_value(const SceneSource& source, const YamlNode& node, const Key& key, bool& out) {
  if (!is_word(node) || (node.text != "true" && node.text != "false"))
    mistyped(source, node, key.name, "true or false");
  out = node.text == "true";
}

void read_value(const SceneSource& source, const YamlNode& node, const Key& key, std::string& out) {
  if (!key.words.empty())
    read_choice(source, node, key.name, words_of(key.words));
  out = read_text(source, node, key.name);
  if (key.kind != KeyKind::kName)
    return;
  if (const std::string fault = fault_of_name(out); !fault.empty())
    source.fail(node.place,
                fmt::format("'{}' is a name, and {} {}.", key.name, describe(node), fault));
}

void read_value(const SceneSource& source, const YamlNode& node, const Key& key,
                std::array<double, 2>& out) {
  if (node.kind != YamlNode::Kind::kSequence || node.items.size() != 2)
    mistyped(source, node, key.name, "a range [low, high]");
  for (std::size_t n = 0; n < 2; ++n)
    out[n] = read_within(source, node.items[n], key.name, 0.0, key.high);
  if (out[0] > out[1])
    source.fail(node.place, fmt::format("'{}' is [{}, {}]; the lower end must be first.", key.name,
                                        out[0], out[1]));
}

void read_value(const SceneSource& source, const YamlNode& node, const Key& key, Vec3& out) {
  out = read_vec3(source, node, key.name);
  if (key.kind == KeyKind::kSize && !(out.minCoeff() > 0.0))
    source.fail(node.place, fmt::format("'{}' must be above 0 along each axis.", key.name));
}

void read_value(const SceneSource& source, const YamlNode& node, const Key& key, Quat& out) {
  if (node.kind != YamlNode::Kind::kSequence || node.items.size() != 4)
    mistyped(source, node, key.name, "a unit quaternion [w, x, y, z]");
  const auto number = [&](std::size_t i) { return read_number(source, node.items[i], key.name); };
  out = Quat(number(0), number(1), number(2), number(3));
  if (!normalise_within(out, 1.0 - 1e-3, 1.0 + 1e-3))
    source.fail(
        node.place,
        fmt::format(
            "'{}' is a quaternion of norm {:.6g}; it must be within 0.001 of 1 (order w, x, y, z).",
            key.name, out.norm()));
}

MapReader::MapReader(const SceneSource& source, const YamlNode& node, std::string_view what,
                     const KeyGroup& group, std::vector<std::string_view> also)
    : MapReader(source, node, what, with_keys_of(group, std::move(also))) {
  group_ = &group;
}

MapReader::MapReader(const SceneSource& source, const YamlNode& node, std::string_view what,
                     std::vector<std::string_view> allowed)
    : source_(source),
      node_(node),
      what_(what),
      allowed_(std::move(allowed)) {
  if (node.kind != YamlNode::Kind::kMap)
    mistyped(source, node, what, fmt::format("a map with the keys: {}", listed(allowed_)));
  for (const YamlEntry& entry : node.entries) {
    if (std::find(allowed_.begin(), allowed_.end(), entry.key) != allowed_.end())
      continue;
    const std::string hint = suggestion(entry.key, allowed_);
    source.fail(entry.key_place, fmt::format("Unknown key '{}' in '{}'{} Allowed: {}.", entry.key,
                                             what_, hint.empty() ? "." : hint, listed(allowed_)));
  }
}

const YamlNode* MapReader::find(std::string_view key) const {
  for (const YamlEntry& entry : node_.entries)
    if (entry.key == key)
      return &entry.value;
  return nullptr;
}

const YamlNode& MapReader::require(std::string_view key) const {
  if (const YamlNode* value = find(key))
    return *value;
  source_.fail(node_.place, fmt::format("'{}' is missing in '{}'.", key, what_));
}

const Key& MapReader::row_of(std::string_view key) const {
  for (const Key& row : group_->keys)
    if (row.name == key)
      return row;
  throw std::logic_error(fmt::format("the table has no key '{}' in '{}'", key, what_));
}

std::size_t MapReader::choice(std::string_view key) const {
  const std::vector<std::string_view> words = words_of(row_of(key).words);
  return static_cast<std::size_t>(std::find(words.begin(), words.end(), get<std::string>(key)) -
                                  words.begin());
}

const std::vector<YamlNode>& MapReader::list(std::string_view key) const {
  static const std::vector<YamlNode> none;
  if (!has(key) && row_of(key).rule != KeyRule::kRequired)
    return none;
  return read_list(source_, require(key), key);
}

void MapReader::refuse(std::string_view key, std::string_view why) const {
  if (has(key))
    source_.fail(place_of(key), fmt::format("'{}' {}", key, why));
}

SourcePlace MapReader::place_of(std::string_view key) const {
  for (const YamlEntry& entry : node_.entries)
    if (entry.key == key)
      return entry.key_place;
  return node_.place;
}

}  // namespace voxtouch::scene
