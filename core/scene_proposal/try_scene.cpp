#include "core/scene_proposal/try_scene.hpp"

#include <fmt/format.h>

namespace voxtouch::scene_proposal {
namespace {

constexpr double kStepS = 0.001, kLongestS = 60.0;
constexpr double kSpring =
    300.0;  ///< of a virtual tool [N/m]; any value works, since only the presence of force matters

bool has_force(const rendering::SceneFrame& frame) {
  return frame.wrench.force.squaredNorm() > 0.0;
}

}  // namespace

std::string validate(const scene::Scene& scene, rendering::BuiltScene& built) {
  rendering::SceneRenderer& renderer = built.scene_renderer();
  for (const auto& [name, motion] : scene.motions) {
    renderer.reset();
    renderer.set_spring_target(kSpring);
    double time_s = 0.0;
    const auto frame = [&] {
      const MotionPoint hand = motion_at(motion, time_s);
      return renderer.render(
          {.pose = {hand.position, motion.orientation}, .twist = {hand.velocity, Vec3::Zero()}},
          time_s);
    };
    if (has_force(frame()))
      return fmt::format("motion '{}' starts inside the part", name);
    const double end_s = std::min(kLongestS, approach_duration(motion));
    bool touched = false;
    for (time_s = kStepS; time_s < end_s && !touched; time_s += kStepS)
      touched = has_force(frame());
    if (!touched)
      return fmt::format("motion '{}' does not touch the part", name);
  }
  return {};
}

}  // namespace voxtouch::scene_proposal
