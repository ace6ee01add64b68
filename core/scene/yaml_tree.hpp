#pragma once
/// YAML text as a tree for a strict reader: the place of every key and value, duplicate keys, and
/// whether a scalar was quoted. The parser's own node tree hides duplicate keys.
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/scene_error.hpp"

namespace voxtouch::scene {

struct YamlEntry;

struct YamlNode {
  enum class Kind { kNull, kScalar, kSequence, kMap };
  Kind kind = Kind::kNull;
  SourcePlace place;
  std::string text;                ///< scalar
  bool quoted = false;             ///< scalar: written in quotes, so never a number
  std::vector<YamlNode> items;     ///< sequence
  std::vector<YamlEntry> entries;  ///< map, in the file's order
};

struct YamlEntry {
  std::string key;
  SourcePlace key_place;
  YamlNode value;
};

/// Limits of nesting and of the number of nodes, far above any real scene.
inline constexpr std::size_t kDeepestNesting = 32, kMaxNodes = 200'000;

/// Parses one YAML document. Throws SceneError for invalid YAML or UTF-8, a duplicate key, a key
/// that is not a plain word, several documents, tags, anchors and aliases (a small file could
/// expand to a huge one), and nesting or size over the limits above. Messages name `file` and
/// `what`.
YamlNode parse_yaml(const std::string& text, const std::filesystem::path& file,
                    std::string_view what = "scene");

/// "a map", "a list", "nothing", "the text 'x'": for messages.
std::string describe(const YamlNode& node);

}  // namespace voxtouch::scene
