#pragma once
/// The scenes of deploy/scenes, by name.
#include <string>
#include <vector>

#include "core/scene/scene.hpp"

namespace voxtouch::test {

/// Names without `.yaml`, sorted: all scenes of the folder, including new ones.
std::vector<std::string> shipped_scene_names();
/// Those of penalty contact only, with static objects: the walks of poses render these. The contact
/// of the others is one of these.
std::vector<std::string> resting_scene_names();
scene::Scene shipped_scene(const std::string& name);

}  // namespace voxtouch::test
