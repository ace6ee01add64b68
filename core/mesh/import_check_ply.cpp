/// PLY: compares the header with the data. assimp invents faces for missing rows, and shifts the
/// columns if it skips a property of an unknown type. It reads polygons only: strips lose most
/// triangles.
#include <algorithm>

#include "core/mesh/import_check.hpp"

namespace voxtouch::mesh::import {
namespace {

struct Property {
  std::size_t length_bytes, item_bytes;
};  ///< `length_bytes` 0: no list

struct Element {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<Property> properties = {};
  std::string names = " ";  ///< of the properties, a blank before and behind each
};

struct Header {
  bool text = true, big_endian = false;
  std::vector<Element> elements;
  std::size_t end = 0;  ///< offset of the data
};

[[noreturn]] void refuse_header(const MeshFile& file, const std::string& reason) {
  refuse(file.path, "the PLY header has " + reason, "export it again");
}

std::size_t type_bytes(const MeshFile& file, std::string_view type) {
  constexpr std::pair<std::string_view, std::size_t> kBytes[] = {
      {" char uchar int8 uint8 ", 1},
      {" short ushort int16 uint16 ", 2},
      {" int uint int32 uint32 float float32 ", 4},
      {" double float64 ", 8}};
  for (const auto& [names, bytes] : kBytes) {
    if (names.find(" " + std::string(type) + " ") != std::string_view::npos)
      return bytes;
  }
  refuse_header(file, "the unknown type '" + printable(type.substr(0, 40)) + "'");
}

Header read_header(const MeshFile& file) {
  const std::string_view bytes = file.bytes;
  Header header;
  for (std::size_t end; (end = bytes.find('\n', header.end)) != std::string_view::npos;) {
    const std::string_view line = bytes.substr(header.end, end - header.end);
    header.end = end + 1;
    std::size_t p = 0;
    const std::string_view word = next_word(line, p), second = next_word(line, p);
    if (word == "end_header")
      return header;
    if (word == "comment" || word == "obj_info")
      continue;
    bool understood = word == "ply";
    if (word == "format") {
      header.text = second == "ascii", header.big_endian = second == "binary_big_endian";
      understood = (header.text || header.big_endian || second == "binary_little_endian") &&
                   next_word(line, p) == "1.0";
    } else if (word == "element") {
      const auto count = whole_number(next_word(line, p));
      if (!count)
        refuse_header(file, "an element without a count");
      header.elements.push_back({.name = second, .count = *count}), understood = true;
    } else if (word == "property" && !header.elements.empty()) {
      const std::size_t length = second == "list" ? type_bytes(file, next_word(line, p)) : 0;
      header.elements.back().properties.push_back(
          {length, type_bytes(file, length > 0 ? next_word(line, p) : second)});
      const std::string_view name = next_word(line, p);
      header.elements.back().names.append(name).append(" "), understood = !name.empty();
    }
    if (!understood || !next_word(line, p).empty())
      refuse_header(file, "an invalid line: '" + printable(line.substr(0, 60)) + "'");
  }
  refuse_truncated(file, "a PLY header without end_header");
}

/// The next number after `at`, if it is an unsigned integer. False if the bytes end before it.
bool next_number(const MeshFile& file, const Header& header, std::size_t size, std::size_t& at,
                 std::optional<std::uint64_t>& value) {
  if (header.text) {
    const std::string_view word = next_word(file.bytes, at);
    value = whole_number(word);
    return !word.empty();
  }
  if (file.bytes.size() - at < size)
    return false;
  value = 0;
  for (std::size_t k = 0; k < size; ++k)
    *value = *value << 8 |
             static_cast<unsigned char>(file.bytes[at + (header.big_endian ? k : size - 1 - k)]);
  at += size;
  return true;
}

}  // namespace

void check_ply(const MeshFile& file) {
  const Header header = read_header(file);
  std::size_t at = header.end;
  std::size_t surfaces = 0;
  for (const Element& e : header.elements) {
    const bool lists =
        std::ranges::any_of(e.properties, [](const Property& p) { return p.length_bytes > 0; });
    if (lists && e.name != "face" && e.names.find(" vertex_ind") != std::string::npos &&
        e.count > 0) {
      refuse(file.path,
             "its surface is stored as '" + printable(e.name.substr(0, 40)) +
                 "', supported: elements 'face'",
             "export it as polygons or triangles");
    }
    surfaces += e.name == "face";
    if (surfaces > 1)
      refuse_header(file, "the element 'face' twice, limit 1");
    for (const char* axis : {" x ", " y ", " z "}) {  // assimp reads missing ones as zero
      if (e.name == "vertex" && e.names.find(axis) == std::string::npos)
        refuse_header(file, "a vertex without its x, y or z");
    }
    const std::string name = "'" + printable(e.name.substr(0, 40)) + "'";
    for (std::uint64_t row = 0; row < e.count; ++row) {
      bool whole = !e.properties.empty();
      for (const Property& p : e.properties) {
        std::optional<std::uint64_t> value, items = 1;
        if (p.length_bytes > 0)
          whole = whole && next_number(file, header, p.length_bytes, at, items);
        if (whole && !items)
          refuse_truncated(file, "a list of the element " + name + " has no length");
        for (std::uint64_t k = 0; whole && k < *items; ++k)
          whole = next_number(file, header, p.item_bytes, at, value);
      }
      if (!whole)
        refuse_truncated(file, "the header declares " + std::to_string(e.count) + " elements " +
                                   name + "; after " + std::to_string(row) +
                                   " of them the file ends");
    }
  }
}

}  // namespace voxtouch::mesh::import
