#include "core/reference/plain_mesh_files.hpp"

#include <strings.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <stdexcept>

namespace voxtouch::reference {
namespace {

constexpr std::string_view kBlanks = " \t\r\n\v\f";

/// Removes the next word from `text`; empty at its end.
std::string_view take_word(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
  text.remove_prefix(word.size());
  return word;
}

template <class Number>
Number number(std::string_view word) {
  if (word.starts_with('+'))
    word.remove_prefix(1);
  Number value{};
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (fault != std::errc() || end == word.data())
    throw std::runtime_error("'" + std::string(word.substr(0, 40)) + "' is not a number");
  return value;
}

Vec3 take_place(std::string_view& text) {
  Vec3 place;
  for (int axis = 0; axis < 3; ++axis)
    place[axis] = number<float>(take_word(text));
  return place;
}

bool is(std::string_view word, std::string_view keyword) {
  return word.size() == keyword.size() &&
         ::strncasecmp(word.data(), keyword.data(), word.size()) == 0;
}

/// The text without a byte order mark.
std::string_view without_mark(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf"))
    text.remove_prefix(3);
  return text;
}

/// Removes the next statement, which a backslash at the end of a line continues.
std::string take_statement(std::string_view& text) {
  std::string statement;
  for (bool more = true; more && !text.empty();) {
    std::string_view line = text.substr(0, text.find_first_of("\r\n"));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    while (!line.empty() && kBlanks.contains(line.back()))
      line.remove_suffix(1);
    more = line.ends_with('\\');
    if (more) {
      line.remove_suffix(1);
      if (text.starts_with('\n'))
        text.remove_prefix(1);  // a line end of two characters
    }
    statement.append(line).append(" ");
  }
  return statement;
}

void add_face(std::string_view words, PlainFile& file) {
  std::vector<std::uint32_t> face;
  for (std::string_view word; !(word = take_word(words)).empty();) {
    const auto count = static_cast<std::int64_t>(file.vertices.size());
    const auto named = number<std::int64_t>(word.substr(0, word.find('/')));
    const std::int64_t index = named < 0 ? count + named : named - 1;
    if (index < 0 || index >= count)
      throw std::runtime_error("a face has vertex index " + std::to_string(named) +
                               ", which does not exist");
    face.push_back(static_cast<std::uint32_t>(index));
  }
  if (face.size() >= 3)
    file.faces.push_back(std::move(face));
}

/// Every three vertices form a triangle.
PlainFile triangles(std::vector<Vec3> vertices) {
  PlainFile file{.vertices = std::move(vertices), .faces = {}};
  if (file.vertices.size() % 3 != 0)
    throw std::runtime_error("a facet does not have three vertices");
  for (std::uint32_t v = 0; v < file.vertices.size(); v += 3)
    file.faces.push_back({v, v + 1, v + 2});
  return file;
}

}  // namespace

PlainFile read_obj(std::string_view text) {
  PlainFile file;
  text = without_mark(text);
  while (!text.empty()) {
    const std::string statement = take_statement(text);
    std::string_view words = statement;
    const std::string_view keyword = take_word(words);
    if (is(keyword, "v")) {
      Vec3 place = take_place(words);
      const std::string_view weight = take_word(words);
      if (!weight.empty() && take_word(words).empty())
        place /= number<float>(weight);  // four: homogeneous
      file.vertices.push_back(place);
    } else if (is(keyword, "f")) {
      add_face(words, file);
    }
  }
  return file;
}

PlainFile read_stl(std::string_view bytes) {
  constexpr std::size_t kHeader = 84, kTriangle = 50, kNormal = 12;
  std::uint32_t count = 0;
  if (bytes.size() >= kHeader)
    std::memcpy(&count, bytes.data() + kHeader - sizeof count, sizeof count);
  std::vector<Vec3> vertices;
  if (count > 0 && bytes.size() >= kHeader + kTriangle * std::uint64_t{count}) {
    for (std::size_t t = 0; t < count; ++t) {
      std::array<float, 9> x{};
      std::memcpy(x.data(), bytes.data() + kHeader + t * kTriangle + kNormal, sizeof x);
      for (std::size_t k = 0; k < 9; k += 3)
        vertices.emplace_back(x[k], x[k + 1], x[k + 2]);
    }
    return triangles(std::move(vertices));
  }
  std::string_view text = without_mark(bytes);
  if (!is(text.substr(0, 5), "solid"))
    throw std::runtime_error("incomplete STL");
  for (std::string_view word; !(word = take_word(text)).empty();) {
    const bool named = is(word, "solid") || is(word, "endsolid");
    if (named)
      text.remove_prefix(std::min(text.find_first_of("\r\n"), text.size()));
    if (is(word, "vertex"))
      vertices.push_back(take_place(text));
  }
  return triangles(std::move(vertices));
}

}  // namespace voxtouch::reference
