/// COLLADA: everything but geometry and the nodes that place it is blanked out, and what remains must hold as
/// many numbers as it says. assimp does not check an accessor against its array, and follows nodes that name
/// themselves.
#include <algorithm>
#include <array>
#include <map>

#include "core/mesh/import_check.hpp"

namespace voxtouch::import {
namespace {

struct Tag {
  std::string_view name, attributes;
  std::size_t begin = 0, end = 0;  ///< of the whole tag, with its brackets
  bool opens = false, closes = false;
};

[[noreturn]] void refuse_collada(const MeshFile& file, const std::string& reason) {
  refuse(file.path, "is not a COLLADA file as the format has it: " + reason, "export it again");
}

/// The next tag at or after `at`; comments, declarations and CDATA are passed over. False at the end of the
/// text.
bool next_tag(const MeshFile& file, std::size_t at, Tag& tag) {
  const std::string_view text = file.bytes;
  for (;;) {
    at = text.find('<', at);
    if (at == std::string_view::npos) return false;
    std::string_view ending = ">";
    if (text.substr(at).starts_with("<!--")) ending = "-->";
    else if (text.substr(at).starts_with("<![CDATA[")) ending = "]]>";
    else if (text.substr(at).starts_with("<?")) ending = "?>";
    else if (!text.substr(at).starts_with("<!")) break;
    const std::size_t end = text.find(ending, at);
    if (end == std::string_view::npos) refuse_truncated(file, "its XML does not end");
    if (text.substr(at).starts_with("<!DOCTYPE")) refuse_collada(file, "it declares a document type");
    at = end + ending.size();
  }
  std::size_t end = at + 1;
  for (char quote = '\0'; end < text.size() && (quote != '\0' || text[end] != '>'); ++end) {
    if (quote == '\0' && (text[end] == '"' || text[end] == '\'')) quote = text[end];
    else if (text[end] == quote) quote = '\0';
  }
  if (end >= text.size()) refuse_truncated(file, "its XML does not end");
  std::string_view inside = text.substr(at + 1, end - at - 1);
  tag = {{}, {}, at, end + 1, true, false};
  if (inside.starts_with('/')) tag.opens = false, tag.closes = true, inside.remove_prefix(1);
  if (inside.ends_with('/')) tag.closes = true, inside.remove_suffix(1);
  std::size_t p = 0;
  if (!inside.empty() && !is_space(inside.front())) {
    tag.name = next_word(inside, p);
  }
  if (tag.name.empty()) refuse_collada(file, "it has a tag without a name");
  tag.attributes = inside.substr(p);
  return true;
}

std::string_view attribute(const Tag& tag, std::string_view name) {
  const std::string_view a = tag.attributes;
  for (std::size_t at = 0; (at = a.find(name, at)) != std::string_view::npos; at += name.size()) {
    std::size_t p = at + name.size();
    while (p < a.size() && is_space(a[p])) ++p;
    if (at == 0 || !is_space(a[at - 1]) || p >= a.size() || a[p] != '=') {
      continue;
    }
    p = a.find_first_of("\"'", p);
    if (p == std::string_view::npos) return {};
    const std::size_t end = a.find(a[p], p + 1);
    return end == std::string_view::npos ? std::string_view{} : a.substr(p + 1, end - p - 1);
  }
  return {};
}

/// An attribute that counts something; `fallback` where it is missing.
std::uint64_t number(const MeshFile& file, const Tag& tag, std::string_view name, std::uint64_t fallback) {
  const std::string_view text = attribute(tag, name);
  if (text.empty()) return fallback;
  const auto value = whole_number(text);
  if (!value || *value > file.bytes.size()) {
    refuse_truncated(file, "<" + printable(tag.name.substr(0, 40)) + "> says " + std::string(name) + "=\"" +
                     printable(text.substr(0, 40)) + "\" in a file of " + std::to_string(file.bytes.size()) +
                         " bytes");
  }
  return *value;
}

bool plays_no_part(std::string_view name) {
  static constexpr std::array<std::string_view, 3> kParts = {"library_geometries", "library_nodes",
                                                             "library_visual_scenes"};
  if (name.starts_with("library_")) return std::find(kParts.begin(), kParts.end(), name) == kParts.end();
  return name == "extra" || name == "instance_controller" || name == "instance_camera" ||
      name == "instance_light" ||
         name == "bind_material";
}

/// Checks that tags nest, and blanks out the subtrees that play no part.
void blank_the_rest(MeshFile& file) {
  constexpr std::size_t kDeepest = 128;
  std::vector<std::string> open;
  std::size_t blank_from = 0, blank_depth = 0;  // depth 0: nothing is being blanked
  bool root = false, skinned = false;
  Tag tag;
  for (std::size_t at = 0; next_tag(file, at, tag); at = tag.end) {
    if (open.empty() && root) refuse_collada(file, "it has more than one root");
    root = true;
    if (tag.opens) {
      skinned = skinned || tag.name == "instance_controller";
      open.emplace_back(tag.name);
      if (open.size() > kDeepest) {
        refuse_collada(file, "it is nested more than " + std::to_string(kDeepest) + " deep");
      }
      if (blank_depth == 0 && plays_no_part(tag.name)) blank_from = tag.begin, blank_depth = open.size();
    }
    if (!tag.closes) continue;
    if (open.empty() || open.back() != tag.name) refuse_truncated(file, "its XML tags do not match");
    if (blank_depth == open.size()) {
      std::fill(file.bytes.begin() + static_cast<std::ptrdiff_t>(blank_from),
                file.bytes.begin() + static_cast<std::ptrdiff_t>(tag.end), ' ');
      blank_depth = 0;
    }
    open.pop_back();
  }
  if (!open.empty() || !root) refuse_truncated(file, "its XML does not end");
  if (skinned) {
    file.warnings.push_back("skinned or morphed parts are left out: export them as plain geometry");
  }
}

/// The words between this tag and the next.
std::string_view text_behind(const MeshFile& file, const Tag& tag) {
  const std::size_t end = std::min(file.bytes.find('<', tag.end), file.bytes.size());
  return std::string_view(file.bytes).substr(tag.end, tag.closes ? 0 : end - tag.end);
}

/// Corners of polygons: assimp makes room for their sum before it looks for them.
void check_corner_counts(const MeshFile& file, std::string_view text) {
  std::uint64_t sum = 0;
  for (std::size_t p = 0;;) {
    const std::string_view word = next_word(text, p);
    if (word.empty()) return;
    const auto corners = whole_number(word);
    if (!corners || *corners > file.bytes.size() || (sum += *corners) > file.bytes.size()) {
      refuse_truncated(file, "its polygons have more corners than the file has bytes");
    }
  }
}

/// assimp stands still in front of a word that is no number, and fills memory.
std::uint64_t count_numbers(const MeshFile& file, std::string_view text, bool whole) {
  std::uint64_t words = 0;
  for (std::size_t p = 0;; ++words) {
    const std::string_view word = next_word(text, p);
    if (word.empty()) return words;
    const bool good = whole ? whole_number(word).has_value()
                            : word.find_first_not_of("0123456789+-.eEnaifNAIF") == std::string_view::npos;
    if (!good) {
      const std::string shown = printable(word.substr(0, 40));
      refuse_truncated(file, std::string("'").append(shown).append("' stands where a number should"));
    }
  }
}

struct Accessor { std::string source; std::uint64_t offset = 0, count = 0, stride = 1, params = 0; };

void check_numbers(const MeshFile& file) {
  std::map<std::string, std::uint64_t, std::less<>> arrays;
  std::vector<Accessor> accessors;
  Tag tag;
  for (std::size_t at = 0; next_tag(file, at, tag); at = tag.end) {
    if (!tag.opens) continue;
    for (const char* name : {"count", "stride", "offset"}) number(file, tag, name, 0);
    if (tag.name == "input" && number(file, tag, "offset", 0) > 63) {
      refuse_collada(file, "an input's offset is above 63");
    }
    if (tag.name == "float_array") {
      const std::uint64_t count = number(file, tag, "count", 0);
      const std::string_view text = text_behind(file, tag);
      const std::uint64_t words = count_numbers(file, text, false);
      if (words < count) {
        refuse_truncated(file, "an array speaks of " + std::to_string(count) + " numbers and has " +
            std::to_string(words));
      }
      if (!arrays.emplace(attribute(tag, "id"), count).second) refuse_collada(file, "two arrays have one id");
    } else if (tag.name == "vcount") {
      check_corner_counts(file, text_behind(file, tag));
    } else if (tag.name == "p") {
      count_numbers(file, text_behind(file, tag), true);
    } else if (tag.name == "accessor") {
      std::string_view source = attribute(tag, "source");
      if (source.starts_with('#')) source.remove_prefix(1);
      accessors.push_back({std::string(source), number(file, tag, "offset", 0), number(file, tag, "count", 0),
                           number(file, tag, "stride", 1), 0});
    } else if (tag.name == "param" && !accessors.empty()) {
      ++accessors.back().params;
    }
  }
  for (const Accessor& a : accessors) {
    const auto array = arrays.find(a.source);
    if (array == arrays.end()) {
      refuse_collada(file, "an accessor names the array '" + printable(a.source.substr(0, 40)) +
          "', which is not there");
    }
    const std::uint64_t last = std::max(a.count, std::uint64_t{1}) - 1;
    if (a.offset + last * a.stride + std::max({a.params, a.stride, std::uint64_t{1}}) > array->second) {
      refuse_truncated(file, "an accessor reads beyond the " + std::to_string(array->second) +
          " numbers of its array '" +
                       printable(a.source.substr(0, 40)) + "'");
    }
  }
}

/// Nodes of library_nodes, what each of them instances, and how many instances that comes to.
class NodeLibrary {
 public:
  explicit NodeLibrary(const MeshFile& file) : file_(file) {
    Tag tag;
    std::size_t depth = 0;
    bool in_library = false;
    std::string current;
    for (std::size_t at = 0; next_tag(file, at, tag); at = tag.end) {
      if (tag.name == "library_nodes") in_library = tag.opens && !tag.closes, depth = 0;
      if (tag.name == "node" && tag.opens) {
        if (depth == 0) current = in_library ? std::string(attribute(tag, "id")) : std::string();
        if (depth == 0 && in_library) instances_[current];
        ++depth;
      }
      if (tag.name == "node" && tag.closes) --depth;
      if (tag.name == "instance_node" && tag.opens) {
        std::string_view url = attribute(tag, "url");
        if (url.starts_with('#')) url.remove_prefix(1);
        (in_library ? instances_[current] : roots_).emplace_back(url);
      }
    }
  }

  void check() {
    std::uint64_t total = 0;
    for (const std::string& url : roots_) total += expansion(url, 0);
    for (const auto& [name, unused] : instances_) expansion(name, 0);
    if (total > kMost) {
      refuse_collada(file_, "its nodes come to more than " + std::to_string(kMost) + " instances");
    }
  }

 private:
  static constexpr std::uint64_t kMost = 10000;
  static constexpr int kDeepest = 64;

  std::uint64_t expansion(const std::string& name, int depth) {
    const auto found = instances_.find(name);
    if (found == instances_.end()) {
      refuse_collada(file_, "instance_node names '" + printable(name.substr(0, 40)) +
          "', which is no node of library_nodes");
    }
    if (depth > kDeepest) refuse_collada(file_, "a node instances itself");
    if (const auto known = known_.find(name); known != known_.end()) return known->second;
    std::uint64_t sum = 1;
    for (const std::string& url : found->second) sum = std::min(sum + expansion(url, depth + 1), kMost + 1);
    return known_[name] = sum;
  }

  const MeshFile& file_;
  std::map<std::string, std::vector<std::string>> instances_;
  std::vector<std::string> roots_;
  std::map<std::string, std::uint64_t> known_;
};

}  // namespace

void check_collada(MeshFile& file) {
  // XML has no others; assimp takes a vertical tab for the beginning of a number, and stands still in front of it.
  const auto control = [](char c) { return c >= '\0' && c < ' ' && c != '\t' && c != '\n' && c != '\r'; };
  if (std::any_of(file.bytes.begin(), file.bytes.end(), control)) {
    refuse_truncated(file, "control characters in an XML text");
  }
  blank_the_rest(file);
  check_numbers(file);
  NodeLibrary(file).check();
}

}  // namespace voxtouch::import
