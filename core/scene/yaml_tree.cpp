#include "core/scene/yaml_tree.hpp"

#include <fmt/core.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <sstream>

#include "core/types/number.hpp"
#include "core/types/utf8.hpp"

namespace voxtouch::scene {
namespace {

SourcePlace place_of(const YAML::Mark& mark) {
  if (mark.line < 0)
    return {1, 1};
  return {mark.line + 1, mark.column + 1};
}

/// Builds the tree from the parser's events. Open nodes are on a stack; a node is moved into its
/// parent when it is complete, so no pointer into a growing vector is kept.
class TreeBuilder final : public YAML::EventHandler {
 public:
  TreeBuilder(const std::filesystem::path& file, std::string_view what)
      : file_(file),
        what_(what) {}
  YamlNode take() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    scalar(mark, "", anchor, YamlNode::Kind::kNull, "");
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { refuse_alias(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    scalar(mark, tag, anchor, YamlNode::Kind::kScalar, value);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, YamlNode::Kind::kSequence);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, YamlNode::Kind::kMap);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Open {
    YamlNode node;
    std::string key;
    SourcePlace key_place;
    bool has_key = false;
  };

  [[noreturn]] void fail(SourcePlace place, const std::string& sentence) const {
    throw SceneError(file_, place, sentence);
  }
  [[noreturn]] void refuse_alias(const YAML::Mark& mark) const {
    fail(place_of(mark),
         fmt::format("Anchors (&) and aliases (*) are not allowed in a {}. Write the value.",
                     what_));
  }

  void check(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    if (anchor != 0)
      refuse_alias(mark);
    if (!tag.empty() && tag != "?" && tag != "!")
      fail(place_of(mark), fmt::format("Tags are not allowed in a {}. Remove '{}'.", what_, tag));
    if (++nodes_ > kMaxNodes)
      fail(place_of(mark), fmt::format("The {} has more than {} values.", what_, kMaxNodes));
  }

  bool expects_key() const {
    return !open_.empty() && open_.back().node.kind == YamlNode::Kind::kMap &&
           !open_.back().has_key;
  }

  void scalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
              YamlNode::Kind kind, const std::string& value) {
    check(mark, tag, anchor);
    if (expects_key())
      return key(place_of(mark), kind, value);
    YamlNode node;
    node.kind = kind, node.place = place_of(mark), node.text = value, node.quoted = tag == "!";
    add(std::move(node));
  }

  void key(SourcePlace place, YamlNode::Kind kind, const std::string& word) {
    if (kind == YamlNode::Kind::kNull || word.empty())
      fail(place, "A key is missing before the colon.");
    Open& map = open_.back();
    for (const YamlEntry& entry : map.node.entries)
      if (entry.key == word)
        fail(place, fmt::format("Duplicate key '{}'; the first is in line {}. Remove one.", word,
                                entry.key_place.line));
    map.key = word, map.key_place = place, map.has_key = true;
  }

  void open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
            YamlNode::Kind kind) {
    check(mark, tag, anchor);
    if (expects_key())
      fail(place_of(mark), "A key must be a plain word, not a list or a map.");
    if (open_.size() >= kDeepestNesting)
      fail(place_of(mark),
           fmt::format("The {} is nested more than {} levels deep.", what_, kDeepestNesting));
    open_.emplace_back();
    open_.back().node.kind = kind, open_.back().node.place = place_of(mark);
  }

  void close() {
    YamlNode node = std::move(open_.back().node);
    open_.pop_back();
    add(std::move(node));
  }

  void add(YamlNode node) {
    if (open_.empty())
      return void(root_ = std::move(node));
    Open& parent = open_.back();
    if (parent.node.kind == YamlNode::Kind::kSequence)
      return parent.node.items.push_back(std::move(node));
    if (node.kind == YamlNode::Kind::kNull)
      node.place = parent.key_place;  // the parser reports an omitted value at the next token
    parent.node.entries.push_back({std::move(parent.key), parent.key_place, std::move(node)});
    parent.has_key = false;
  }

  const std::filesystem::path& file_;
  std::string_view what_;
  YamlNode root_;
  std::vector<Open> open_;
  std::size_t nodes_ = 0;
};

/// Refuses bytes that are no text before the parser sees them, with their place.
void check_text(const std::string& text, const std::filesystem::path& file, std::string_view what) {
  SourcePlace place{1, 1};
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const std::size_t length = utf8_length(text, i);
    if (length == 0 || (byte < 0x20 && byte != '\t' && byte != '\n' && byte != '\r') ||
        byte == 0x7F)
      throw SceneError(file, place,
                       fmt::format("Invalid byte 0x{:02x}; a {} is YAML in UTF-8.", byte, what));
    if (byte == '\n')
      ++place.line, place.column = 0;
    ++place.column;
    i += length;
  }
}

}  // namespace

YamlNode parse_yaml(const std::string& text, const std::filesystem::path& file,
                    std::string_view what) {
  check_text(text, file, what);
  // Without the last line's end: at it, this parser takes a quote that is never closed for closed.
  const std::size_t last = text.find_last_not_of(" \t\r\n");
  std::istringstream stream(text.substr(0, last == std::string::npos ? 0 : last + 1));
  TreeBuilder builder(file, what);
  try {
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(builder))
      return {};
    TreeBuilder second(file, what);
    if (parser.HandleNextDocument(second))
      throw SceneError(file, second.take().place,
                       fmt::format("Second YAML document; a {} has one.", what));
  } catch (const YAML::Exception& fault) {
    throw SceneError(file, place_of(fault.mark), fmt::format("Invalid YAML: {}.", fault.msg));
  }
  return builder.take();
}

std::string describe(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::kNull:
      return "nothing";
    case YamlNode::Kind::kSequence:
      return fmt::format("a list of {}", node.items.size());
    case YamlNode::Kind::kMap:
      return "a map";
    case YamlNode::Kind::kScalar:
      break;
  }
  std::size_t cut = 37;  // not within a character: messages go into JSON, which must be UTF-8
  while (cut < node.text.size() && (static_cast<unsigned char>(node.text[cut]) & 0xC0U) == 0x80U)
    --cut;
  const std::string excerpt = node.text.size() > 40 ? node.text.substr(0, cut) + "..." : node.text;
  const bool number = parse_finite(node.text).has_value();
  return fmt::format("{} '{}'",
                     node.quoted ? "the text"
                     : number    ? "the number"
                                 : "the word",
                     excerpt);
}

}  // namespace voxtouch::scene
