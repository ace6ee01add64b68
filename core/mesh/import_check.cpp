#include "core/mesh/import_check.hpp"

#include <algorithm>

#include "core/types/number.hpp"

namespace voxtouch::import {
namespace {

std::string lower_extension(const std::filesystem::path& path) {
  std::string e = path.extension().string();
  if (!e.empty()) e.erase(0, 1);
  for (char& c : e) c = (c >= 'A' && c <= 'Z') ? static_cast<char>(c - 'A' + 'a') : c;
  return e;
}

bool starts_with_word(std::string_view line, std::string_view word) {
  return line.starts_with(word) && (line.size() == word.size() || is_space(line[word.size()]));
}

}  // namespace

void refuse_size(const MeshFile& file, std::uint64_t triangles, const ImportOptions& options) {
  refuse(file.path, "has " + std::to_string(triangles) + " triangles or more, and at most " +
         std::to_string(options.max_triangles) + " are read", "reduce the mesh, or raise max_triangles");
}

void refuse_truncated(const MeshFile& file, const std::string& found) {
  refuse(file.path, "is truncated or damaged: " + found, "copy or export it again");
}

std::string_view next_word(std::string_view text, std::size_t& position) {
  while (position < text.size() && is_space(text[position])) ++position;
  const std::size_t first = position;
  while (position < text.size() && !is_space(text[position])) ++position;
  return text.substr(first, position - first);
}

std::uint32_t little_u32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    value |= std::uint32_t{static_cast<unsigned char>(bytes[at + k])} << (8 * k);
  }
  return value;
}

std::string printable(std::string_view text) {
  std::string plain(text);
  for (char& c : plain) c = (c >= ' ' && c <= '~') ? c : '?';
  return plain;
}

std::optional<std::uint64_t> whole_number(std::string_view word) {
  const auto value = parse_number<std::uint64_t>(word);
  return value ? std::optional(*value) : std::nullopt;
}

/// Objects, groups, materials and smoothing would make assimp sort the faces; as comments they leave the
/// file's order alone.
void check_obj(MeshFile& file) {
  bool continued = false;
  for (std::size_t first = 0; first < file.bytes.size();) {
    const std::size_t end = std::min(file.bytes.find('\n', first), file.bytes.size());
    std::string_view line(file.bytes.data() + first, end - first);
    std::size_t indent = 0;
    while (indent < line.size() && is_space(line[indent])) ++indent;
    const std::string_view text = line.substr(indent);
    for (const std::string_view word : {"o", "g", "s", "mg", "usemtl", "mtllib"}) {
      if (!continued && starts_with_word(text, word)) file.bytes[first + indent] = '#';
    }
    while (!line.empty() && is_space(line.back())) line.remove_suffix(1);
    continued = !line.empty() && line.back() == '\\';
    first = end + 1;
  }
  if (file.bytes.find('\0') != std::string::npos) {
    refuse(file.path, "is no OBJ text: it holds zero bytes",
        "export it as OBJ again, or give it the ending of its format");
  }
}

namespace {

/// Every facet with its three vertices and its end: assimp passes over what is missing.
void check_stl_text(MeshFile& file, const ImportOptions& options) {
  if (file.bytes.find('\0') != std::string::npos) refuse_truncated(file, "zero bytes in an STL text");
  std::uint64_t facets = 0, vertices = 0, ends = 0;
  std::string_view last;
  bool named = false;  // what follows 'solid' or 'endsolid' on its line is a name
  for (std::size_t at = 0;;) {
    const std::size_t before = at;
    const std::string_view word = next_word(file.bytes, at);
    if (word.empty()) break;
    const std::string_view passed = std::string_view(file.bytes).substr(before, at - before);
    const bool new_line = passed.find_first_of("\r\n") != std::string_view::npos;
    if (named && !new_line) continue;
    named = word == "solid" || word == "endsolid";
    facets += word == "facet", vertices += word == "vertex", ends += word == "endfacet";
    if (named || word == "facet") last = word;
  }
  if (last != "endsolid") refuse_truncated(file, "an STL text without its 'endsolid'");
  if (ends != facets || vertices != 3 * facets) {
    refuse_truncated(file, std::to_string(facets) + " facets begin, " + std::to_string(ends) +
        " end, and they have " +
                     std::to_string(vertices) + " vertices");
  }
  if (facets > options.max_triangles) refuse_size(file, facets, options);
  file.faces = facets;
}

}  // namespace

void check_stl(MeshFile& file, const ImportOptions& options) {
  constexpr std::size_t kHeader = 84, kTriangle = 50;
  const std::string_view bytes = file.bytes;
  const std::uint64_t count = bytes.size() >= kHeader ? little_u32(bytes, 80) : 0;
  const bool binary_size = bytes.size() >= kHeader && bytes.size() == kHeader + kTriangle * count;
  const std::string_view start = bytes.substr(0, 1024);
  const bool text = start.substr(start.find_first_not_of(" \t\r\n") == std::string_view::npos
                                     ? 0 : start.find_first_not_of(" \t\r\n")).starts_with("solid") &&
                    start.find('\0') == std::string_view::npos;
  if (text && !binary_size) return check_stl_text(file, options);
  if (bytes.size() < kHeader) refuse_truncated(file, std::to_string(bytes.size()) + " bytes are no STL file");
  if (!binary_size) {
    refuse_truncated(file, "the header speaks of " + std::to_string(count) + " triangles, which need " +
                     std::to_string(kHeader + kTriangle * count) + " bytes, and there are " +
                         std::to_string(bytes.size()));
  }
  if (count > options.max_triangles) refuse_size(file, count, options);
  file.faces = count;
}

MeshFile open_mesh_file(const std::filesystem::path& path, std::string bytes, const ImportOptions& options) {
  MeshFile file{path, lower_extension(path), std::move(bytes), {}, {}};
  const bool known = file.extension == "obj" || file.extension == "stl" || file.extension == "ply" ||
                     file.extension == "gltf" || file.extension == "glb" || file.extension == "dae";
  if (!known) {
    refuse(path, "the format '" + printable(file.extension) + "' is not known",
           "export it as .obj, .stl, .ply, .gltf, .glb or .dae");
  }
  if (file.extension == "obj") check_obj(file);
  if (file.extension == "stl") check_stl(file, options);
  if (file.extension == "ply") check_ply(file, options);
  if (file.extension == "gltf" || file.extension == "glb") check_gltf(file, options);
  if (file.extension == "dae") check_collada(file);
  return file;
}

}  // namespace voxtouch::import
