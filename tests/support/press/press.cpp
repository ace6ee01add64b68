#include "tests/support/press/press.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/coupling/running_coupling.hpp"
#include "core/device_fit/coupling_input.hpp"
#include "core/device_fit/design_problem.hpp"

namespace voxtouch::test {
namespace {

constexpr int kDepths = 10, kMaxFrames = 4000;
constexpr double kDepthStepM = 0.001, kPressStepM = 5e-5, kBehindApproachS = 4.0, kSettlesInS = 0.7;
constexpr int kStartFrames = 20;

/// The hand's first touch, and the direction against the force there.
struct Touch {
  Pose pose;
  double time_s = 0.0;
  Vec3 onward = Vec3::Zero();
};

class Hand {
 public:
  Hand(rendering::SceneRenderer& renderer, const Motion& motion, double step_m)
      : renderer_(renderer),
        motion_(motion),
        step_m_(step_m) {}

  std::optional<Touch> first_touch() {
    const double end_s = approach_duration(motion_) + kBehindApproachS;
    const double step_s = std::max(step_m_ / motion_.speed_m_per_s, end_s / kMaxFrames);
    renderer_.reset();
    for (double time_s = 0.0; time_s <= end_s; time_s += step_s) {
      const Vec3 push = contact_at(time_s);
      if (push.isZero(0.0))
        continue;
      const double touched_s = bisect(std::max(0.0, time_s - step_s), time_s);
      return Touch{pose_at(touched_s), touched_s, -push.normalized()};
    }
    return std::nullopt;
  }

 private:
  Pose pose_at(double time_s) const {
    return {motion_at(motion_, time_s).position, orientation_at(motion_, time_s).orientation};
  }
  Vec3 contact_at(double time_s) { return contact_at(time_s, pose_at(time_s)); }
  Vec3 contact_at(double time_s, const Pose& pose) {
    return renderer_.render({.pose = pose, .twist = {}}, time_s).touch.contact.wrench.force;
  }

  /// The last time without contact, as near as a thousandth of the step.
  double bisect(double free_s, double touching_s) {
    const double before_s = free_s;
    for (int n = 0; n < 10; ++n) {
      const double middle_s = 0.5 * (free_s + touching_s);
      renderer_.reset();
      for (int start = 0; start < kStartFrames; ++start)  // a virtual tool starts in free space
        contact_at(before_s + start * rendering::SceneRenderer::kLongestStepS, pose_at(before_s));
      (contact_at(middle_s).isZero(0.0) ? free_s : touching_s) = middle_s;
    }
    return free_s;
  }

  rendering::SceneRenderer& renderer_;
  const Motion& motion_;
  double step_m_;
};

}  // namespace

std::vector<Pressed> press(rendering::BuiltScene& built, const scene::Scene& scene,
                           const device_fit::FittedCoupling& fitted,
                           const coupling::design::DeviceModel& device, const Motion& motion) {
  rendering::SceneRenderer& renderer = built.scene_renderer();
  const double step_m = 0.5 * scene.voxel_size_m;
  renderer.set_spring_target(device_fit::spring_n_per_m(
      fitted, scene, device, {built.plan().contact_n_per_m, built.plan().contact_nm_per_rad}));
  renderer.set_series_target(
      device_fit::series_spring(fitted, scene, device, built.plan().of_contact_alone,
                                {built.plan().contact_n_per_m, built.plan().contact_nm_per_rad}));
  std::vector<Pressed> out;
  const std::optional<Touch> touch = fitted.refusal.empty() && !built.effect_ground().body
                                         ? Hand(renderer, motion, step_m).first_touch()
                                         : std::nullopt;
  if (!touch)
    return out;
  const double period_s = device.timing.period_s,
               depth_step_m = kDepthStepM * scene.device.position_scale;
  const int frames = static_cast<int>(
      std::clamp(std::ceil(depth_step_m / std::min(step_m, kPressStepM)), 1.0, 100.0));
  coupling::RunningCoupling running(fitted.spec, device_fit::limits_W(scene.device, device),
                                    period_s, 0.0);
  renderer.reset();
  rendering::ToolState tool{.pose = touch->pose, .twist = {}};
  double time_s = touch->time_s;
  coupling::CouplingInput free;
  free.tool = tool.pose;
  running.step(free, period_s);  // the contact begins from here
  if (scene.virtual_tool())      // it has to begin outside, and its spring fades in
    for (int n = 0; n < kStartFrames; ++n)
      renderer.render(tool, time_s += rendering::SceneRenderer::kLongestStepS);
  for (int depth = 1; depth <= kDepths; ++depth) {
    rendering::SceneFrame frame;
    for (int n = 0; n < frames; ++n) {
      tool.pose.position += depth_step_m / frames * touch->onward;
      frame = renderer.render(tool, time_s += period_s);
      running.step(device_fit::coupling_input(frame, tool.pose), period_s);
    }
    const coupling::CouplingInput input = device_fit::coupling_input(frame, tool.pose);
    Wrench returned;
    for (double t = 0.0; t < kSettlesInS; t += period_s)
      returned = running.step(input, period_s).wrench;
    out.push_back({kDepthStepM * depth, scene.device.force_scale * returned.force.norm()});
  }
  renderer.reset();
  return out;
}

}  // namespace voxtouch::test
