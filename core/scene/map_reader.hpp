#pragma once
/// Reads one map of a scene strictly: it names the keys that it allows, and everything else is an error with its place.
#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/yaml_tree.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch {

/// What all readers of one file share.
struct SceneSource {
  std::filesystem::path file;
  std::vector<std::string> warnings;  ///< `file:line:column: sentence`

  [[noreturn]] void fail(SourcePlace place, const std::string& sentence) const { throw SceneError(file, place, sentence); }
  void warn(SourcePlace place, const std::string& sentence) { warnings.push_back(at_place(file, place, sentence)); }
};

/// The nearest of `allowed` to `word` where it is near enough to be a slip of the hand; empty otherwise.
std::string_view nearest_word(std::string_view word, const std::vector<std::string_view>& allowed);
/// "; did you mean 'x'?" or an empty string, and "a, b and c".
std::string suggestion(std::string_view word, const std::vector<std::string_view>& allowed);
std::string listed(const std::vector<std::string_view>& words);

/// Values of one node. `what` names it in messages, for example "voxel_size". All throw SceneError at the node's place.
double read_number(const SceneSource& source, const YamlNode& node, std::string_view what);  ///< finite
double read_positive(const SceneSource& source, const YamlNode& node, std::string_view what);
double read_not_negative(const SceneSource& source, const YamlNode& node, std::string_view what);
std::uint64_t read_count(const SceneSource& source, const YamlNode& node, std::string_view what);  ///< 0, 1, 2, ...
bool read_flag(const SceneSource& source, const YamlNode& node, std::string_view what);            ///< true or false
/// [low, high] with 0 <= low <= high.
std::array<double, 2> read_range(const SceneSource& source, const YamlNode& node, std::string_view what);
std::string read_text(const SceneSource& source, const YamlNode& node, std::string_view what);     ///< not empty
/// Letters, digits, '_', '-' and '.' (not in front), kLongestName at most: a name becomes part of file and topic names.
std::string read_name(const SceneSource& source, const YamlNode& node, std::string_view what);
/// Empty where `name` is such a name; else what is wrong with it, to follow the name: "holds ...".
std::string fault_of_name(std::string_view name);
inline constexpr std::size_t kLongestName = 64;
Vec3 read_vec3(const SceneSource& source, const YamlNode& node, std::string_view what);
/// [w, x, y, z] with a norm within 1e-3 of 1, normalised.
Quat read_quat(const SceneSource& source, const YamlNode& node, std::string_view what);
/// Index of the word among `allowed`.
std::size_t read_choice(const SceneSource& source, const YamlNode& node, std::string_view what,
                        const std::vector<std::string_view>& allowed);
const std::vector<YamlNode>& read_list(const SceneSource& source, const YamlNode& node, std::string_view what);

class MapReader {
 public:
  /// Throws SceneError if `node` is no map or has a key that is not in `allowed`. `what` names the map in messages.
  MapReader(const SceneSource& source, const YamlNode& node, std::string_view what, std::vector<std::string_view> allowed);

  /// The key's value, or null where it is absent.
  const YamlNode* find(std::string_view key) const;
  /// The key's value; throws at the map's place where it is absent.
  const YamlNode& require(std::string_view key) const;
  bool has(std::string_view key) const { return find(key) != nullptr; }
  /// Throws where a key is there that does not go with another choice; `why` completes "'key' ...".
  void refuse(std::string_view key, std::string_view why) const;
  /// Sets `out` from `read(source, node, key)` if the key is there.
  template <class T, class Read>
  void optional(std::string_view key, T& out, Read read) const {
    if (const YamlNode* value = find(key)) out = read(source_, *value, key);
  }
  /// The key's place, or the map's where it is absent.
  SourcePlace place_of(std::string_view key) const;

 private:
  const SceneSource& source_;
  const YamlNode& node_;
  std::string what_;
  std::vector<std::string_view> allowed_;
};

}  // namespace voxtouch
