#include "core/mesh/import_check.hpp"

#include <algorithm>

#include "core/types/number.hpp"

namespace voxtouch::mesh::import {
std::string extension_of(const std::filesystem::path& path) {
  std::string e = path.extension().string();
  if (!e.empty())
    e.erase(0, 1);
  for (char& c : e)
    c = (c >= 'A' && c <= 'Z') ? static_cast<char>(c - 'A' + 'a') : c;
  return e;
}

void refuse_truncated(const MeshFile& file, const std::string& found) {
  refuse(file.path, "is truncated or damaged: " + found, "copy or export it again");
}

std::string_view next_word(std::string_view text, std::size_t& position) {
  while (position < text.size() && is_space(text[position]))
    ++position;
  const std::size_t first = position;
  while (position < text.size() && !is_space(text[position]))
    ++position;
  return text.substr(first, position - first);
}

std::uint32_t little_u32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 4; k-- > 0;)
    value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
  return value;
}

std::string printable(std::string_view text) {
  std::string plain(text);
  for (char& c : plain)
    c = (c >= ' ' && c <= '~') ? c : '?';
  return plain;
}

std::optional<std::uint64_t> whole_number(std::string_view word) {
  const auto value = parse_number<std::uint64_t>(word);
  return value ? std::optional(*value) : std::nullopt;
}

namespace {

/// Objects, groups, materials and smoothing would make assimp sort the faces; as comments they
/// leave the file's order alone.
void check_obj(MeshFile& file) {
  if (file.bytes.find('\0') != std::string::npos)
    refuse(file.path, "is no OBJ text: it holds zero bytes",
           "export it as OBJ again, or give it the ending of its format");
  bool continued = false;
  for (std::size_t first = 0; first < file.bytes.size();) {
    const std::size_t end = std::min(file.bytes.find('\n', first), file.bytes.size());
    std::string_view line(file.bytes.data() + first, end - first);
    std::size_t p = 0;
    const std::string_view word = next_word(line, p);
    for (const std::string_view sorts : {"o", "g", "s", "mg", "usemtl", "mtllib"}) {
      if (!continued && word == sorts)
        file.bytes[first + p - word.size()] = '#';
    }
    while (!line.empty() && is_space(line.back()))
      line.remove_suffix(1);
    continued = line.ends_with('\\');
    first = end + 1;
  }
}

/// Every facet with its three vertices and its end: assimp passes over what is missing.
void check_stl_text(MeshFile& file) {
  if (file.bytes.find('\0') != std::string::npos)
    refuse_truncated(file, "zero bytes in an STL text");
  std::uint64_t facets = 0, vertices = 0, ends = 0;
  std::string_view last;
  bool named = false;  // what follows 'solid' or 'endsolid' on its line is a name
  for (std::size_t at = 0;;) {
    const std::size_t before = at;
    const std::string_view word = next_word(file.bytes, at);
    if (word.empty())
      break;
    const std::string_view passed = std::string_view(file.bytes).substr(before, at - before);
    if (named && passed.find_first_of("\r\n") == std::string_view::npos)
      continue;
    named = word == "solid" || word == "endsolid";
    facets += word == "facet", vertices += word == "vertex", ends += word == "endfacet";
    if (named || word == "facet")
      last = word;
  }
  if (last != "endsolid")
    refuse_truncated(file, "an STL text without its 'endsolid'");
  if (ends != facets || vertices != 3 * facets)
    refuse_truncated(file, std::to_string(facets) + " facets begin, " + std::to_string(ends) +
                               " end, and they have " + std::to_string(vertices) + " vertices");
  file.faces = facets;
}

void check_stl(MeshFile& file) {
  constexpr std::size_t kHeader = 84, kTriangle = 50;
  const std::uint64_t size = file.bytes.size(),
                      count = size >= kHeader ? little_u32(file.bytes, 80) : 0;
  const std::string_view start = std::string_view(file.bytes).substr(0, 1024);
  std::size_t p = 0;
  if (size >= kHeader && size == kHeader + kTriangle * count) {
    file.faces = count;
  } else if (next_word(start, p).starts_with("solid") &&
             start.find('\0') == std::string_view::npos) {
    check_stl_text(file);
  } else {
    refuse_truncated(file, "the header speaks of " + std::to_string(count) +
                               " triangles, which need " +
                               std::to_string(kHeader + kTriangle * count) +
                               " bytes, and there are " + std::to_string(size));
  }
}

}  // namespace

MeshFile open_mesh_file(const std::filesystem::path& path, std::string bytes) {
  MeshFile file{path, extension_of(path), std::move(bytes), {}, {}};
  const std::string& format = file.extension;
  if (format == "obj")
    check_obj(file);
  else if (format == "stl")
    check_stl(file);
  else if (format == "ply")
    check_ply(file);
  else if (format == "gltf" || format == "glb")
    check_gltf(file);
  else if (format == "dae")
    check_collada(file);
  else
    refuse(path, "the format '" + printable(format) + "' is not known",
           "export it as .obj, .stl, .ply, .gltf, .glb or .dae");
  return file;
}

}  // namespace voxtouch::mesh::import
