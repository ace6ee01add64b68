// Largest contact force along a scene's motion `slide`, without a ring. usage: contact SCENE
#include <algorithm>
#include <cstdio>

#include "core/rendering/build.hpp"
#include "core/scene/scene_file.hpp"
#include "core/types/motion.hpp"

using namespace voxtouch;

int main(int count, char** arguments) {
  if (count != 2)
    return 2;
  const scene::Scene scene = scene::load_scene(arguments[1]);
  const auto built = rendering::build_scene(scene, serial_for());
  double largest_n = 0.0;
  for (double time_s = 0.0; time_s < 5.0; time_s += 0.001) {
    const rendering::ToolState tool{.pose = {motion_at(scene.motions.at("slide"), time_s).position},
                                    .twist = {}};
    largest_n =
        std::max(largest_n, built->scene_renderer().render(tool, time_s).wrench.force.norm());
  }
  std::printf("%.3f N at most\n", largest_n);
}
