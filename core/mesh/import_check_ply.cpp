/// PLY: the header's promises against the bytes behind it. assimp makes up faces where rows are missing.
#include <algorithm>
#include <array>
#include <cstring>
#include <map>

#include "core/mesh/import_check.hpp"

namespace voxtouch::import {
namespace {

struct Property {
  std::size_t count_bytes = 0;  ///< of a list's length; 0: no list
  bool count_signed = false;
  std::size_t item_bytes = 0;
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  bool has_list() const {
    return std::any_of(properties.begin(), properties.end(),
        [](const Property& p) { return p.count_bytes > 0; });
  }
  /// Fewest bytes a row takes: as text a digit and a blank each.
  std::uint64_t least_bytes(bool text) const {
    std::uint64_t sum = 0;
    for (const Property& p : properties) sum += text ? 2 : (p.count_bytes > 0 ? p.count_bytes : p.item_bytes);
    return std::max<std::uint64_t>(sum, 1);
  }
};

struct Header {
  bool text = true, big_endian = false;
  std::vector<Element> elements;
  std::size_t end = 0;  ///< where the data begins
};

std::size_t type_bytes(const MeshFile& file, std::string_view type) {
  static const std::map<std::string_view, std::size_t> kBytes = {
      {"char", 1},  {"uchar", 1},  {"int8", 1},  {"uint8", 1},  {"short", 2}, {"ushort", 2},
      {"int16", 2}, {"uint16", 2}, {"int", 4},   {"uint", 4},   {"int32", 4}, {"uint32", 4},
      {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  const auto found = kBytes.find(type);
  if (found == kBytes.end()) {
    refuse(file.path, "the PLY header has the unknown type '" + printable(type.substr(0, 40)) + "'",
        "export it again");
  }
  return found->second;
}

Property read_property(const MeshFile& file, std::string_view line, std::size_t& at) {
  const std::string_view type = next_word(line, at);
  if (type != "list") return {0, false, type_bytes(file, type)};
  const std::string_view length = next_word(line, at);
  if (length.starts_with("float") || length == "double") {
    refuse(file.path, "the PLY header gives a list a length that is no whole number", "export it again");
  }
  Property p{type_bytes(file, length), !length.starts_with('u'), 0};
  p.item_bytes = type_bytes(file, next_word(line, at));
  return p;
}

/// Plain characters and no more words than belong: assimp never comes back from some headers that have
/// others.
void check_line(const MeshFile& file, std::string_view line, std::string_view word, std::size_t used) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  const bool free_text = word == "comment" || word == "obj_info";
  const bool plain = free_text || std::all_of(line.begin(), line.end(),
      [](char c) { return (c >= ' ' && c <= '~') || c == '\t'; });
  if (!plain || (!free_text && !next_word(line, used).empty())) {
    refuse(file.path, "the PLY header has a line that is not understood: '" + printable(line.substr(0, 60)) +
        "'", "export it again");
  }
}

Header read_header(const MeshFile& file) {
  const std::string_view bytes = file.bytes;
  Header header;
  bool format = false;
  std::size_t at = 0;
  for (int number = 0; number < 10000; ++number) {
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string_view::npos) break;
    const std::string_view line = bytes.substr(at, end - at);
    at = end + 1;
    std::size_t p = 0;
    const std::string_view word = next_word(line, p);
    if (number == 0 && word != "ply") {
      refuse(file.path, "does not begin with 'ply'", "give it the ending of its format");
    }
    if (word == "format") {
      const std::string_view kind = next_word(line, p);
      header.text = kind == "ascii";
      header.big_endian = kind == "binary_big_endian";
      format = (header.text || header.big_endian || kind == "binary_little_endian") &&
          next_word(line, p) == "1.0";
    } else if (word == "element") {
      const std::string_view name = next_word(line, p);
      const auto count = whole_number(next_word(line, p));
      if (!count) refuse(file.path, "the PLY header has an element without a count", "export it again");
      header.elements.push_back({std::string(name), *count, {}});
    } else if (word == "property") {
      if (header.elements.empty()) {
        refuse(file.path, "the PLY header has a property of no element", "export it again");
      }
      header.elements.back().properties.push_back(read_property(file, line, p));
      if (next_word(line, p).empty()) {
        refuse(file.path, "the PLY header has a property without a name", "export it again");
      }
    } else if (word == "end_header") {
      if (!format) {
        refuse(file.path, "the PLY header has no format that is known", "export it as ascii or binary PLY");
      }
      check_line(file, line, word, p);
      header.end = at;
      return header;
    } else if (word != "ply" && word != "comment" && word != "obj_info") {
      refuse(file.path, "the PLY header has the unknown line '" + printable(line.substr(0, 60)) + "'",
          "export it again");
    }
    check_line(file, line, word, p);
  }
  refuse_truncated(file, "a PLY header without its end");
}

[[noreturn]] void refuse_rows(const MeshFile& file, const Element& e, std::uint64_t rows) {
  refuse_truncated(file, "the header speaks of " + std::to_string(e.count) + " elements '" +
      printable(e.name.substr(0, 40)) +
                   "', and after " + std::to_string(rows) + " of them the file ends");
}

void walk_text(const MeshFile& file, const Header& header) {
  std::size_t at = header.end;
  for (const Element& e : header.elements) {
    for (std::uint64_t row = 0; row < e.count; ++row) {
      for (const Property& p : e.properties) {
        std::string_view word = next_word(file.bytes, at);
        if (word.empty()) refuse_rows(file, e, row);
        if (p.count_bytes == 0) continue;
        const auto items = whole_number(word);
        if (!items) {
          refuse_truncated(file, "a list of the element '" + printable(e.name.substr(0, 40)) +
              "' has no length");
        }
        for (std::uint64_t k = 0; k < *items; ++k) {
          if (next_word(file.bytes, at).empty()) refuse_rows(file, e, row);
        }
      }
    }
  }
}

std::uint64_t list_length(const MeshFile& file, const Header& header, const Property& p, std::size_t at) {
  std::uint64_t value = 0;
  for (std::size_t k = 0; k < p.count_bytes; ++k) {
    const std::size_t shift = 8 * (header.big_endian ? p.count_bytes - 1 - k : k);
    value |= std::uint64_t{static_cast<unsigned char>(file.bytes[at + k])} << shift;
  }
  if (p.count_signed && (value >> (8 * p.count_bytes - 1)) != 0) {
    refuse_truncated(file, "a list has a negative length");
  }
  return value;
}

void walk_binary(const MeshFile& file, const Header& header) {
  std::uint64_t at = header.end;
  const std::uint64_t size = file.bytes.size();
  for (const Element& e : header.elements) {
    for (std::uint64_t row = 0; row < e.count; ++row) {
      if (!e.has_list()) {  // every row is as long as the next
        const std::uint64_t room = (size - at) / e.least_bytes(false);
        if (room < e.count) refuse_rows(file, e, room);
        at += e.count * e.least_bytes(false);
        break;
      }
      for (const Property& p : e.properties) {
        if (size - at < std::max(p.count_bytes, p.item_bytes * (p.count_bytes == 0))) {
          refuse_rows(file, e, row);
        }
        const std::uint64_t items = p.count_bytes > 0 ? list_length(file, header, p, at) : 1;
        at += p.count_bytes;
        if ((size - at) / p.item_bytes < items) refuse_rows(file, e, row);
        at += items * p.item_bytes;
      }
    }
  }
}

}  // namespace

void check_ply(MeshFile& file, const ImportOptions& options) {
  const Header header = read_header(file);
  const std::uint64_t room = file.bytes.size() - header.end;
  bool vertices = false;
  for (const Element& e : header.elements) {
    if (e.properties.empty() && e.count > 0) {
      refuse(file.path, "a PLY element has no properties", "export it again");
    }
    if (e.count > room / e.least_bytes(header.text) + 1) {
      refuse_truncated(file, "the header speaks of " + std::to_string(e.count) + " elements '" +
          printable(e.name.substr(0, 40)) +
                       "', and " + std::to_string(room) + " bytes follow");
    }
    vertices = vertices || (e.name == "vertex" && e.count > 0);
    if (e.name == "face" && e.count > options.max_triangles) refuse_size(file, e.count, options);
  }
  if (!vertices) refuse(file.path, "has no vertices", "export the mesh again");
  header.text ? walk_text(file, header) : walk_binary(file, header);
}

}  // namespace voxtouch::import
