// The shipped scenes of the effects at the touched point, rendered without a ring.
#include <gtest/gtest.h>

#include "core/rendering/build.hpp"
#include "core/scene/scene_file.hpp"

namespace voxtouch::rendering {
namespace {

scene::Scene shipped(const std::string& name) {
  return scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/" + name + ".yaml");
}

struct Slide {
  double energy_generated_j = 0.0, largest_step_n = 0.0, most_n = 0.0;  ///< by the effects alone
  int touched = 0;
};

/// The tool along the path of the scene's motion `slide`, in steps of 0.05 mm, with the effects'
/// forces.
Slide slide(const scene::Scene& scene) {
  const auto built = build_scene(scene, serial_for());
  constexpr double kStep = 5e-5, kDt = 1e-3;
  Slide out;
  Vec3 last = Vec3::Zero();
  double time = 0.0;
  const std::vector<Vec3>& path = scene.motions.at("slide").path;
  for (std::size_t leg = 0; leg + 1 < path.size(); ++leg) {
    const Vec3 displacement = path[leg + 1] - path[leg];
    const int steps = static_cast<int>(displacement.norm() / kStep);
    const Vec3 step = displacement / steps;
    for (int n = 0; n < steps; ++n) {
      ToolState tool;
      tool.pose.position = path[leg] + n * step;
      tool.twist.linear = step / kDt;
      const SceneFrame frame = built->scene_renderer().render(tool, time += kDt);
      EXPECT_TRUE(frame.wrench.finite());
      const bool touching = !frame.touch.contact.wrench.zero();
      EXPECT_TRUE(touching || frame.effects.wrench.zero());
      const Vec3& force = frame.effects.wrench.force;
      if (n > 0)
        out.energy_generated_j += 0.5 * (last + force).dot(step),
            out.largest_step_n = std::max(out.largest_step_n, (force - last).norm());
      out.most_n = std::max(out.most_n, force.norm()), out.touched += touching ? 1 : 0;
      last = force;
    }
  }
  return out;
}

TEST(CupScenes, RubDampAndHaveARelief) {
  for (const char* name : {"cup_friction", "cup_surface_damping", "cup_texture"}) {
    const scene::Scene scene = shipped(name);
    ASSERT_FALSE(scene.effects.empty()) << name;
    const Slide result = slide(scene);
    RecordProperty(std::string(name) + "_given_j", std::to_string(result.energy_generated_j));
    RecordProperty(std::string(name) + "_largest_step_n", std::to_string(result.largest_step_n));
    RecordProperty(std::string(name) + "_most_n", std::to_string(result.most_n));
    std::printf("%s: %d samples in contact, %.4f J, at most %.3f N, largest step %.4f N\n", name,
                result.touched, result.energy_generated_j, result.most_n, result.largest_step_n);
    EXPECT_GT(result.touched, 300) << name;
    EXPECT_GT(result.most_n, 0.02) << name;
    EXPECT_LT(result.largest_step_n, 0.05) << name;
    if (scene.effects[0].kind->energy == effects::EnergyBehaviour::kDissipative) {
      EXPECT_LT(result.energy_generated_j, -1e-4) << name;
    }
  }
}

}  // namespace
}  // namespace voxtouch::rendering
