#include "core/mesh/import_check.hpp"

#include <algorithm>

#include "core/types/number.hpp"

namespace voxtouch::mesh::import {

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

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

/// Files that are often given the ending of a mesh format, or of another one.
struct Content {
  std::string_view start;       ///< in lower case
  std::string_view own_ending;  ///< for which it is right; empty: for none
  const char* what;
  const char* remedy;
};
constexpr Content kContents[] = {
    {"version https://git-lfs", "", "is a git-lfs pointer, not the mesh itself",
     "fetch it with 'git lfs pull'"},
    {"\x1f\x8b", "", "is compressed by gzip", "unpack it"},
    {"pk\x03\x04", "", "is a ZIP archive, as 3MF files are", "unpack it, or export another format"},
    {"<!doctype html", "", "is a web page, not a mesh", "download the mesh file itself"},
    {"<html", "", "is a web page, not a mesh", "download the mesh file itself"},
    {"\xff\xfe", "", "is UTF-16 text", "save it as UTF-8"},
    {"\xfe\xff", "", "is UTF-16 text", "save it as UTF-8"},
    {"iso-10303-21", "", "is a STEP file, without triangles", "export a mesh from it"},
    {"kaydara fbx", "", "is an FBX file", "export it as .obj, .stl, .ply, .gltf, .glb or .dae"},
    {"gltf\x02", "glb", "is a binary glTF file", "rename it to .glb"},
    {"ply\n", "ply", "is a PLY file", "rename it to .ply"},
    {"ply\r", "ply", "is a PLY file", "rename it to .ply"},
};

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

void refuse_other_content(const MeshFile& file) {
  std::string start = file.bytes.substr(0, 64);
  std::ranges::transform(start, start.begin(), lower);
  for (const Content& content : kContents) {
    if (start.starts_with(content.start) && file.extension != content.own_ending) {
      refuse(file.path, content.what, content.remedy);
    }
  }
}

/// End of a text, before trailing zero bytes and the end mark of old systems.
std::size_t end_of_text(std::string_view bytes) {
  return bytes.find_last_not_of(std::string_view("\0\x1a", 2)) + 1;
}

void cut_padding(MeshFile& file) {
  const std::size_t end = end_of_text(file.bytes);
  if (end == file.bytes.size())
    return;
  file.warnings.push_back(std::to_string(file.bytes.size() - end) +
                          " padding bytes after its text are skipped");
  file.bytes.resize(end);
}

/// A fourth number of a vertex is the weight of a free-form surface, and a corner of a polygon has
/// none: assimp divides by it.
void check_weight(const MeshFile& file, std::string_view line, std::size_t after_keyword) {
  std::size_t p = after_keyword;
  std::string_view weight;
  int numbers = 0;
  for (std::string_view word;
       !(word = next_word(line, p)).empty() && word[0] != '#' && word != "\\";)
    if (++numbers == 4)
      weight = word;
  if (numbers != 4)  // six: a colour
    return;
  if (const auto value = parse_number<double>(weight); !value || *value != 1.0)
    refuse(file.path, "has a vertex weight '" + printable(weight) + "' after x, y and z",
           "export polygons with three numbers a vertex");
}

/// Objects, groups, materials and smoothing make assimp sort the faces; as comments they keep the
/// file's order. Statements are converted to lower case, since assimp ignores those in capitals.
/// Each line gets a line feed, so that no statement is missed here.
void check_obj(MeshFile& file) {
  cut_padding(file);
  if (file.bytes.find('\0') != std::string::npos)
    refuse(file.path, "is not an OBJ text: it has zero bytes",
           "export it as OBJ again, or rename it to its format's extension");
  for (std::size_t k = 0; (k = file.bytes.find('\r', k)) != std::string::npos; ++k) {
    if (k + 1 == file.bytes.size() || file.bytes[k + 1] != '\n')
      file.bytes[k] = '\n';
  }
  bool continued = false;
  for (std::size_t first = 0; first < file.bytes.size();) {
    const std::size_t end = std::min(file.bytes.find('\n', first), file.bytes.size());
    std::string_view line(file.bytes.data() + first, end - first);
    std::size_t p = 0;
    const std::string_view word = next_word(line, p);
    const std::size_t begin = first + p - word.size();
    if (!continued)
      std::transform(word.begin(), word.end(),
                     file.bytes.begin() + static_cast<std::ptrdiff_t>(begin), lower);
    for (const std::string_view sorts : {"o", "g", "s", "mg", "usemtl", "mtllib"}) {
      if (!continued && word == sorts)
        file.bytes[begin] = '#';
    }
    for (const std::string_view surface : {"surf", "bsp", "bzp", "cdp", "call"}) {
      if (!continued && word == surface)
        refuse(file.path,
               "has a statement '" + std::string(surface) +
                   "': free-form surfaces and references to other files are not supported",
               "export it as polygons");
    }
    if (!continued && word.size() == 1 && lower(word[0]) == 'v')
      check_weight(file, line, p);
    while (!line.empty() && is_space(line.back()))
      line.remove_suffix(1);
    continued = line.ends_with('\\');
    first = end + 1;
  }
}

/// An STL text as assimp takes it: keywords in lower case and in one word, and normals that are
/// numbers. Nothing changes its place.
class StlText {
 public:
  explicit StlText(MeshFile& file) : file_(file), bytes_(file.bytes) {}

  /// Checks every facet for its three vertices and its end: assimp ignores missing ones.
  void check() {
    cut_padding(file_);
    if (bytes_.find('\0') != std::string::npos)
      refuse_truncated(file_, "zero bytes in an STL text");
    std::uint64_t facets = 0, vertices = 0, ends = 0;
    std::string last;
    for (std::string word; !(word = next_keyword()).empty();) {
      if (word == "normal")
        mend_normal();
      const bool named = word == "solid" || word == "endsolid";
      if (named)
        pass_name();
      facets += word == "facet";
      vertices += word == "vertex";
      ends += word == "endfacet";
      if (named || word == "facet")
        last = word;
    }
    if (last != "endsolid")
      refuse_truncated(file_, "an STL text without its 'endsolid'");
    if (ends != facets || vertices != 3 * facets)
      refuse_truncated(file_, std::to_string(facets) + " facets begin, " + std::to_string(ends) +
                                  " end; they have " + std::to_string(vertices) + " vertices");
    file_.faces = facets;
    if (capitals_)
      file_.warnings.push_back("its keywords are in capitals (accepted)");
    if (normals_ > 0) {
      file_.warnings.push_back(
          std::to_string(normals_) +
          " normals are not numbers: orientation follows the order of the corners");
    }
  }

 private:
  std::string_view next() { return next_word(bytes_, at_); }
  std::size_t begin_of(std::string_view word) const { return at_ - word.size(); }
  static std::string in_lower_case(std::string_view word) {
    std::string text(word);
    std::ranges::transform(text, text.begin(), lower);
    return text;
  }

  /// The next word, in lower case. 'end' and the following word are one.
  std::string next_keyword() {
    const std::string_view raw = next();
    const std::size_t begin = begin_of(raw);
    std::string word = in_lower_case(raw);
    if (word == "end") {
      const std::size_t behind = at_;
      const std::string what = in_lower_case(next());
      if (what == "solid" || what == "facet" || what == "loop") {
        word += what;
        std::fill(bytes_.begin() + static_cast<std::ptrdiff_t>(begin),
                  bytes_.begin() + static_cast<std::ptrdiff_t>(at_), ' ');
        bytes_.replace(begin, word.size(), word);
      } else {
        at_ = behind;
      }
    }
    for (const std::string_view keyword : {"solid", "facet", "normal", "outer", "loop", "vertex",
                                           "endloop", "endfacet", "endsolid"}) {
      if (word != keyword || bytes_.compare(begin, word.size(), word) == 0)
        continue;
      bytes_.replace(begin, word.size(), word);
      capitals_ = true;
    }
    return word;
  }

  /// The rest of the line. assimp passes over facets in it.
  void pass_name() {
    const std::size_t end = std::min(bytes_.find_first_of("\r\n", at_), bytes_.size());
    if (in_lower_case(std::string_view(bytes_).substr(at_, end - at_)).contains("facet normal"))
      refuse(file_.path, "has a facet on the line of 'solid' or 'endsolid', whose rest is a name",
             "put a line break before the facet");
    at_ = end;
  }

  void mend_normal() {
    bool mended = false;
    for (int k = 0; k < 3; ++k) {
      const std::size_t before = at_;
      const std::string word = in_lower_case(next());
      if (word == "outer" || word == "vertex" || word.empty()) {
        at_ = before;
        break;
      }
      if (word.find_first_not_of("+-.,0123456789e") == std::string::npos)
        continue;
      std::fill_n(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_of(word)), word.size(), ' ');
      bytes_[begin_of(word)] = '0';
      mended = true;
    }
    normals_ += mended;
  }

  MeshFile& file_;
  std::string& bytes_;
  std::size_t at_ = 0;
  bool capitals_ = false;
  std::uint64_t normals_ = 0;
};

constexpr std::uint64_t kStlHeader = 84, kStlTriangle = 50;

std::uint64_t stl_count(std::string_view bytes) {
  return bytes.size() >= kStlHeader ? little_u32(bytes, 80) : 0;
}

/// Bytes of a binary STL behind its last triangle are left out, unless they are triangles
/// themselves.
void cut_behind_triangles(MeshFile& file, std::uint64_t whole) {
  const std::string_view behind = std::string_view(file.bytes).substr(whole);
  const std::uint64_t more = behind.size() / kStlTriangle;
  const bool zeros = behind.find_first_not_of('\0') == std::string_view::npos;
  if (more > 0 && behind.size() % kStlTriangle == 0 && !zeros) {
    const std::uint64_t count = stl_count(file.bytes);
    refuse_truncated(file, "the header declares " + std::to_string(count) +
                               " triangles, the file has bytes for " +
                               std::to_string(count + more));
  }
  file.warnings.push_back(std::to_string(behind.size()) +
                          " bytes after its last triangle are skipped");
  file.bytes.resize(whole);
}

/// Assimp recognises an STL text by its first byte.
void cut_blank_start(MeshFile& file) {
  file.bytes.erase(0, std::string_view(file.bytes).find_first_not_of(" \t\r\n"));
}

void check_stl(MeshFile& file) {
  const std::uint64_t size = file.bytes.size(), count = stl_count(file.bytes);
  const std::uint64_t whole = kStlHeader + kStlTriangle * count;
  const std::string_view start =
      std::string_view(file.bytes).substr(0, std::min(end_of_text(file.bytes), std::size_t{1024}));
  std::size_t p = 0;
  std::string first(next_word(start, p));
  std::ranges::transform(first, first.begin(), lower);
  if (size >= kStlHeader && (size == whole || (size > whole && count > 0))) {
    if (size > whole)
      cut_behind_triangles(file, whole);
    std::fill_n(file.bytes.begin(), 80,
                ' ');  // any text, and assimp takes some of them for another format
    file.faces = count;
  } else if (first.starts_with("solid") && start.find('\0') == std::string_view::npos) {
    cut_blank_start(file);
    StlText(file).check();
  } else {
    refuse_truncated(file, "the header declares " + std::to_string(count) +
                               " triangles, requiring " + std::to_string(whole) +
                               " bytes, the file has " + std::to_string(size));
  }
}

/// Removes it: otherwise assimp ignores the first statement.
void cut_byte_order_mark(MeshFile& file) {
  if (!file.bytes.starts_with(kByteOrderMark))
    return;
  const bool header_of_binary_stl =
      file.extension == "stl" &&
      file.bytes.size() == kStlHeader + kStlTriangle * stl_count(file.bytes);
  if (header_of_binary_stl)
    return;
  file.bytes.erase(0, kByteOrderMark.size());
  file.warnings.push_back("its byte order mark is skipped");
}

}  // namespace

MeshFile open_mesh_file(const std::filesystem::path& path, std::string bytes) {
  MeshFile file{path, extension_of(path), std::move(bytes), {}, {}};
  const std::string& format = file.extension;
  cut_byte_order_mark(file);
  refuse_other_content(file);
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
    refuse(path, "the format '" + printable(format) + "' is not supported",
           "export it as .obj, .stl, .ply, .gltf, .glb or .dae");
  return file;
}

}  // namespace voxtouch::mesh::import
