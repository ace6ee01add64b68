#include "tests/validator/shipped_scenes.hpp"

#include <algorithm>
#include <filesystem>

#include "core/scene/scene_file.hpp"

namespace voxtouch::test {
namespace {

const std::filesystem::path kScenes = std::filesystem::path(VOXTOUCH_DEPLOY) / "scenes";

}  // namespace

std::vector<std::string> shipped_scene_names() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kScenes))
    if (entry.path().extension() == ".yaml")
      names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> resting_scene_names() {
  std::vector<std::string> names = shipped_scene_names();
  std::erase_if(names, [](const std::string& name) {
    const scene::Scene scene = shipped_scene(name);
    return !scene.effects.empty() || !scene.objects.empty() || scene.virtual_tool();
  });
  return names;
}

scene::Scene shipped_scene(const std::string& name) {
  return scene::load_scene(kScenes / (name + ".yaml"));
}

}  // namespace voxtouch::test
