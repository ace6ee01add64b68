#include "nodes/mesh_import/answer.hpp"

#include <algorithm>
#include <stdexcept>

namespace voxtouch::mesh_import {
namespace {

struct Head {
  std::uint64_t mark = 0x6873656d786f7609;  ///< absent in a file that was never written
  std::uint64_t refused = 0, vertices = 0, triangles = 0, text = 0;
  std::uint64_t points = 0, lines = 0;
  double spacing = 0.0, largest = 0.0;
};
using Triangle = std::array<std::uint32_t, 3>;
static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(std::uint32_t));

std::string with_parts(const Head& head, const mesh::TriangleMesh& mesh, const std::string& text) {
  std::string bytes(reinterpret_cast<const char*>(&head), sizeof head);
  bytes.append(reinterpret_cast<const char*>(mesh.vertices.data()), head.vertices * sizeof(Vec3));
  bytes.append(reinterpret_cast<const char*>(mesh.triangles.data()),
               head.triangles * sizeof(Triangle));
  return bytes + text;
}

}  // namespace

std::string encode(const mesh::FileTriangles& read) {
  std::string text;
  for (const std::string& warning : read.warnings)
    text += warning + '\n';
  return with_parts({.vertices = read.mesh.vertices.size(),
                     .triangles = read.mesh.triangles.size(),
                     .text = text.size(),
                     .points = read.points,
                     .lines = read.lines,
                     .spacing = read.spacing,
                     .largest = read.largest},
                    read.mesh, text);
}

std::string encode_refusal(const std::string& sentence) {
  return with_parts({.refused = 1, .text = sentence.size()}, {}, sentence);
}

mesh::FileTriangles decode(std::string_view answer) {
  Head head{.mark = 0};
  const auto take = [&answer](auto* to, std::size_t count) {
    const std::size_t size = count * sizeof *to;
    std::copy_n(answer.data(), size, reinterpret_cast<char*>(to));
    answer.remove_prefix(size);
  };
  if (answer.size() >= sizeof head)
    take(&head, 1);
  // Checked individually first, so that the sum cannot overflow.
  if (head.mark != Head{}.mark ||
      std::max({head.text, head.vertices, head.triangles}) > answer.size() ||
      answer.size() !=
          head.vertices * sizeof(Vec3) + head.triangles * sizeof(Triangle) + head.text) {
    throw std::runtime_error("incomplete reply of the reader process");
  }
  std::string text(answer.substr(answer.size() - head.text));
  if (head.refused != 0)
    throw mesh::MeshError(text);
  mesh::FileTriangles read{
      .mesh = {std::vector<Vec3>(head.vertices), std::vector<Triangle>(head.triangles)},
      .points = head.points,
      .lines = head.lines,
      .spacing = head.spacing,
      .largest = head.largest,
      .warnings = {}};
  take(read.mesh.vertices.data(), head.vertices), take(read.mesh.triangles.data(), head.triangles);
  const bool finite =
      std::ranges::all_of(read.mesh.vertices, [](const Vec3& v) { return v.allFinite(); });
  const bool there = std::ranges::all_of(
      read.mesh.triangles, [&](const Triangle& t) { return std::ranges::max(t) < head.vertices; });
  if (!finite || !there)
    throw std::runtime_error(
        "the reader process returned NaN, infinity or an invalid vertex index");
  for (std::size_t end; (end = text.find('\n')) != std::string::npos; text.erase(0, end + 1)) {
    read.warnings.push_back(text.substr(0, end));
  }
  return read;
}

}  // namespace voxtouch::mesh_import
