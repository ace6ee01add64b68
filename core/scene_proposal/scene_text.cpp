#include "core/scene_proposal/scene_text.hpp"

#include <cctype>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace voxtouch::scene_proposal {
namespace {

constexpr std::size_t kLongestName = 64;

/// A text of JSON is one of YAML, whatever characters it holds.
std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string path_text(const std::vector<Vec3>& path) {
  std::string text;
  for (const Vec3& x : path)
    text +=
        fmt::format("{}[{:.6g}, {:.6g}, {:.6g}]", text.empty() ? "" : ", ", x.x(), x.y(), x.z());
  return "[" + text + "]";
}

}  // namespace

std::string scene_name(const std::string& text) {
  std::string name = text.substr(0, kLongestName);
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-' && c != '.')
      c = '_';
  if (name.empty() || name.front() == '.')
    name.insert(name.begin(), 's');
  return name.substr(0, kLongestName);
}

std::string scene_text(const ProposedScene& scene, const SceneNames& names) {
  std::string text;
  for (const std::string& reason : scene.reasons)
    text += "# " + reason + "\n";
  text +=
      fmt::format("scene: {}\nvoxel_size: {:.4g}  # m\n", quoted(names.scene), scene.voxel_size_m);
  text += fmt::format("static:\n  - {{mesh: {}, scale: {:.6g}}}\n", quoted(names.part_file),
                      names.part_scale);
  text += fmt::format("dynamic:\n  mesh: {}\n  scale: {:.6g}\n  shell: exact\n",
                      quoted(names.tool_file), names.tool_scale);
  if (scene.tool.sphere)
    text += fmt::format("  parts: [{{sphere: {{centre: [0, 0, 0], radius: {:.6g}}}}}]\n",
                        scene.tool.reach_m);
  text += "contact: {model: field, rendering: virtual_tool}\n";
  text += "effects: []  # friction, texture, guides, ...: see voxtouch schema\n";
  text += "coupling: {design: auto}  # fitted to the device: voxtouch design --scene\n";
  text +=
      "motions:  # of the simulated hand: target of the tool's origin in the part's frame [m]\n";
  text += fmt::format("  press: {{path: {}, speed_m_per_s: {:.3g}, hold_s: 0.3, repeat_from: 0}}\n",
                      path_text(scene.press_W), scene.press_speed_m_per_s);
  text += fmt::format("  slide: {{path: {}, speed_m_per_s: {:.3g}, hold_s: 0.1, repeat_from: 0}}\n",
                      path_text(scene.slide_W), scene.slide_speed_m_per_s);
  return text;
}

}  // namespace voxtouch::scene_proposal
