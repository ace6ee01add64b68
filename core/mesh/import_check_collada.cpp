/// COLLADA: checks that numbers are valid, counts are true, and references exist. assimp gets
/// geometry and the nodes that place it. Content that assimp ignores although it changes the shape
/// is refused. Polygons with holes become polygons with a bridge to each hole.
#include <algorithm>
#include <map>
#include <pugixml.hpp>
#include <set>
#include <sstream>

#include "core/mesh/import_check.hpp"
#include "core/types/number.hpp"

namespace voxtouch::mesh::import {
namespace {

std::string in_quotes(std::string_view text) { return "'" + printable(text.substr(0, 40)) + "'"; }

/// The numbers of an array: one more or less would move all behind it.
std::uint64_t count_numbers(const MeshFile& file, const pugi::xml_node& array) {
  const std::uint64_t count = array.attribute("count").as_uint();
  const std::string_view text = array.child_value();
  std::uint64_t words = 0;
  for (std::size_t p = 0; !next_word(text, p).empty();)
    ++words;
  if (words == count)
    return count;
  refuse_truncated(file, "an array declares " + std::to_string(count) + " numbers, it has " +
                             std::to_string(words));
}

/// assimp reads a minus as zero, and truncates numbers that are too long.
void check_indices(const MeshFile& file, std::string_view text) {
  std::string_view word;
  for (std::size_t p = 0; !(word = next_word(text, p)).empty();) {
    if (whole_number(word).value_or(~0ULL) > 0xffffffff)
      refuse_truncated(file, in_quotes(word) + " is not a number");
  }
}

/// `array`: how many numbers there are to access.
void check_accessor(const MeshFile& file, const pugi::xml_node& accessor, std::uint64_t array) {
  const std::uint64_t begin = accessor.attribute("offset").as_uint(),
                      count = accessor.attribute("count").as_uint();
  const std::uint64_t stride = accessor.attribute("stride").as_uint(1),
                      params = accessor.select_nodes("param").size();
  if (begin + (std::max(count, std::uint64_t{1}) - 1) * stride + std::max(params, stride) > array)
    refuse_truncated(file,
                     "an accessor exceeds the " + std::to_string(array) + " numbers of its array");
}

/// The text after the '#'.
std::string named_by(const pugi::xml_attribute& link) {
  const std::string text = link.value();
  return text.substr(text.starts_with('#'));
}

[[noreturn]] void refuse_shape(const MeshFile& file, const std::string& what,
                               const pugi::xml_node& node) {
  const std::string id = node.attribute("id").value();
  refuse(file.path,
         what + (id.empty() ? "" : " in " + in_quotes(id)) +
             ", which is not supported and changes its shape",
         "export plain meshes, with all modifiers applied");
}

/// Refuses what bends or shears a mesh, or is a surface of another kind. assimp reads a fan as one
/// polygon.
void check_shape(const MeshFile& file, const pugi::xml_document& doc) {
  const std::pair<const char*, const char*> kinds[] = {
      {"//instance_controller", "has a skinned or morphed part"},
      {"//node/skew", "has a node that shears"},
      {"//mesh/trifans", "has triangle fans"},
      {"//geometry/convex_mesh", "has a convex hull"},
      {"//geometry/brep", "has a surface of curves"}};
  for (const auto& [path, what] : kinds) {
    if (const auto found = doc.select_node(path))
      refuse_shape(file, what, found.node().parent());
  }
}

/// assimp takes a unit that is no number, or not above 0, for 0 or for metres.
void check_unit(const MeshFile& file, const pugi::xml_document& doc) {
  const auto found = doc.select_node("/COLLADA/asset/unit/@meter");
  if (!found)
    return;
  const std::string text = found.attribute().value();
  std::size_t p = 0;
  if (parse_finite(next_word(text, p)).value_or(0.0) <= 0.0)
    refuse(file.path, "declares a unit of " + in_quotes(text) + " m, not a length > 0",
           "correct <unit meter=...> in it");
}

/// The words of a list, `stride` of them per corner, with the first corner repeated at the end.
std::string closed_path(std::string_view text, std::uint64_t stride) {
  std::string first, all;
  std::uint64_t words = 0;
  for (std::size_t p = 0; p < text.size();) {
    const std::string word(next_word(text, p));
    if (word.empty())
      break;
    if (words++ < stride)
      first += word + " ";
    all += word + " ";
  }
  return all + first;
}

/// `<ph>`: an outline and its holes, each walked from the outline's first corner and back.
void join_holes(const pugi::xml_document& doc) {
  for (const auto& found : doc.select_nodes("//polygons/ph")) {
    const pugi::xml_node with_holes = found.node();
    pugi::xml_node polygons = with_holes.parent();
    std::uint64_t stride = 1;
    for (const pugi::xml_node& input : polygons.children("input")) {
      stride = std::max<std::uint64_t>(stride, input.attribute("offset").as_uint() + 1);
    }
    const std::string_view outline = with_holes.child_value("p");
    std::string path;
    std::string start;
    std::size_t p = 0;
    for (std::uint64_t k = 0; k < stride; ++k)
      start += std::string(next_word(outline, p)) + " ";
    path = closed_path(outline, stride);
    for (const pugi::xml_node& hole : with_holes.children("h")) {
      path += closed_path(hole.child_value(), stride) + start;
    }
    polygons.insert_child_before("p", with_holes).text().set(path.c_str());
    polygons.remove_child(with_holes);
  }
}

}  // namespace

void check_collada(MeshFile& file) {
  pugi::xml_document doc;
  const pugi::xml_parse_result parsed = doc.load_buffer(file.bytes.data(), file.bytes.size());
  if (!parsed)
    refuse_truncated(file, std::string("its XML is invalid (") + parsed.description() + ")");
  check_unit(file, doc);
  check_shape(file, doc);
  join_holes(doc);
  pugi::xpath_node_set no_geometry = doc.select_nodes(
      "//extra | //instance_camera | //instance_light | //bind_material | "
      "/COLLADA/*[starts-with(name(), "
      "'library_') and name() != 'library_geometries' and name() != 'library_nodes' and name() != "
      "'library_visual_scenes']");
  no_geometry.sort(true);  // nested ones first
  for (const pugi::xpath_node& found : no_geometry)
    found.parent().remove_child(found.node());

  std::map<std::string, std::uint64_t> arrays;
  for (const auto& found : doc.select_nodes("//float_array"))
    arrays[found.node().attribute("id").value()] = count_numbers(file, found.node());
  for (const auto& found : doc.select_nodes("//p"))
    check_indices(file, found.node().child_value());
  for (const auto& found : doc.select_nodes("//accessor"))
    check_accessor(file, found.node(), arrays[named_by(found.node().attribute("source"))]);
  std::set<std::string> parts;
  for (const auto& found : doc.select_nodes("//node/@id | //geometry/@id"))
    parts.insert(found.attribute().value());
  for (const auto& found : doc.select_nodes("//instance_node/@url | //instance_geometry/@url")) {
    const std::string name = named_by(found.attribute());
    if (!parts.contains(name))
      refuse(file.path, "a node references " + in_quotes(name) + ", which does not exist",
             "export it again");
  }
  std::ostringstream kept;
  doc.save(kept, "", pugi::format_raw);
  file.bytes = std::move(kept).str();
}

}  // namespace voxtouch::mesh::import
