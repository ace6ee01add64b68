#pragma once
/// The scenes of deploy/scenes, by name.
#include <string>
#include <vector>

#include "core/scene/scene.hpp"

namespace voxtouch::test {

/// Names without `.yaml`, sorted; all that is in the folder, so that a new scene takes part by itself.
std::vector<std::string> shipped_scene_names();
/// Those whose tool is where the hand is and whose objects rest: what can be walked through by poses alone.
std::vector<std::string> resting_scene_names();
Scene shipped_scene(const std::string& name);

}  // namespace voxtouch::test
