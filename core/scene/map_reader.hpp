#pragma once
/// Reads one map of a scene strictly: the table of keys lists its keys and their forms; everything
/// else is an error with its place.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/keys.hpp"
#include "core/scene/yaml_tree.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::scene {

/// Shared data of all readers of one file.
struct SceneSource {
  std::filesystem::path file;
  std::vector<std::string> warnings;  ///< `file:line:column: sentence`

  [[noreturn]] void fail(SourcePlace place, const std::string& sentence) const {
    throw SceneError(file, place, sentence);
  }
  /// Keeps a warning about `place`. Allocates.
  void warn(SourcePlace place, const std::string& sentence) {
    warnings.push_back(at_place(file, place, sentence));
  }
};

/// The nearest of `allowed` to `word` if it is close enough to be a typing error; else empty.
std::string_view nearest_word(std::string_view word, const std::vector<std::string_view>& allowed);
/// "; did you mean 'x'?" or an empty string, and "a, b and c".
std::string suggestion(std::string_view word, const std::vector<std::string_view>& allowed);
/// "a, b and c".
std::string listed(const std::vector<std::string_view>& words);

/// Values of one node. `what` names it in messages, for example "voxel_size". All throw SceneError
/// at the node's place.
double read_number(const SceneSource& source, const YamlNode& node,
                   std::string_view what);  ///< finite
std::string read_text(const SceneSource& source, const YamlNode& node,
                      std::string_view what);  ///< not empty
/// The fault of `name`, to follow it in a sentence, or empty. Valid: letters, digits, '_', '-' and
/// '.' (not in front), at most kLongestName; names become parts of file and topic names.
std::string fault_of_name(std::string_view name);
inline constexpr std::size_t kLongestName = 64;
/// Three finite numbers.
Vec3 read_vec3(const SceneSource& source, const YamlNode& node, std::string_view what);
/// Index of the word among `allowed`.
std::size_t read_choice(const SceneSource& source, const YamlNode& node, std::string_view what,
                        const std::vector<std::string_view>& allowed);
/// The nodes of a list, which may be empty.
const std::vector<YamlNode>& read_list(const SceneSource& source, const YamlNode& node,
                                       std::string_view what);

/// A value in the form of the key's row.
void read_value(const SceneSource& source, const YamlNode& node, const Key& key, double& out);
void read_value(const SceneSource& source, const YamlNode& node, const Key& key, std::size_t& out);
void read_value(const SceneSource& source, const YamlNode& node, const Key& key,
                std::uint32_t& out);
void read_value(const SceneSource& source, const YamlNode& node, const Key& key, bool& out);
void read_value(const SceneSource& source, const YamlNode& node, const Key& key, std::string& out);
void read_value(const SceneSource& source, const YamlNode& node, const Key& key,
                std::array<double, 2>& out);
void read_value(const SceneSource& source, const YamlNode& node, const Key& key, Vec3& out);
void read_value(const SceneSource& source, const YamlNode& node, const Key& key,
                Quat& out);  ///< normalised
template <class T>
void read_value(const SceneSource& source, const YamlNode& node, const Key& key,
                std::optional<T>& out) {
  read_value(source, node, key, out.emplace());
}

class MapReader {
 public:
  /// Throws SceneError if `node` is no map or has a key that is neither in `also` nor in `group`.
  /// `what` names the map in messages.
  MapReader(const SceneSource& source, const YamlNode& node, std::string_view what,
            const KeyGroup& group, std::vector<std::string_view> also = {});
  /// The same for keys that are in no table; read their values by the functions above.
  MapReader(const SceneSource& source, const YamlNode& node, std::string_view what,
            std::vector<std::string_view> allowed);

  /// The key's value, or null if it is absent.
  const YamlNode* find(std::string_view key) const;
  /// The key's value; throws at the map's place if it is absent.
  const YamlNode& require(std::string_view key) const;
  bool has(std::string_view key) const { return find(key) != nullptr; }
  /// Throws if the key is present but excluded by another choice; `why` completes "'key' ...".
  void refuse(std::string_view key, std::string_view why) const;
  /// Sets `out` to the key's value; keeps its default if the key is absent. Throws if an absent key
  /// is required.
  template <class T>
  void read(std::string_view key, T& out) const {
    if (!read_if_present(key, out) && row_of(key).rule == KeyRule::kRequired)
      require(key);
  }
  /// The key's value; throws if it is absent.
  template <class T>
  T get(std::string_view key) const {
    T out{};
    if (!read_if_present(key, out))
      require(key);
    return out;
  }
  /// Index of the key's value among the row's words; throws if it is absent.
  std::size_t choice(std::string_view key) const;
  /// The map of the key; throws if it is absent.
  MapReader inner(std::string_view key) const {
    return {source_, require(key), key, *row_of(key).group};
  }
  /// The items of the key's list; empty if an optional key is absent.
  const std::vector<YamlNode>& list(std::string_view key) const;
  /// The key's place, or the map's if it is absent.
  SourcePlace place_of(std::string_view key) const;

 private:
  static constexpr KeyGroup kNoKeys = {};

  const Key& row_of(std::string_view key) const;
  template <class T>
  bool read_if_present(std::string_view key, T& out) const {
    const Key& row = row_of(key);
    const YamlNode* const value = find(key);
    if (value != nullptr)
      read_value(source_, *value, row, out);
    return value != nullptr;
  }

  const SceneSource& source_;
  const YamlNode& node_;
  std::string what_;
  std::vector<std::string_view> allowed_;
  const KeyGroup* group_ = &kNoKeys;
};

}  // namespace voxtouch::scene
