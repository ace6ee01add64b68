#pragma once
/// YAML text as a tree that keeps everything a strict reader has to judge: the place of every key
/// and value, keys that come twice, and whether a scalar was quoted. The parser's own node tree
/// hides doubled keys, which is why it is not used.
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

/// Deepest nesting and largest number of nodes that a scene may have: far above any real one.
inline constexpr std::size_t kDeepestNesting = 32, kMaxNodes = 200'000;

/// Parses one YAML document. Throws SceneError for text that is no YAML, bytes that are no text
/// (UTF-8), a doubled key, a key that is no plain word, several documents, tags, anchors and
/// aliases (which a scene has no need of, and which let a small file stand for a huge one), and
/// nesting or size over the limits above. `file` and `what` (a word for what the text is) are for
/// the messages only.
YamlNode parse_yaml(const std::string& text, const std::filesystem::path& file,
                    std::string_view what = "scene");

/// "a map", "a list", "nothing", "the text 'x'": for messages.
std::string describe(const YamlNode& node);

}  // namespace voxtouch::scene
