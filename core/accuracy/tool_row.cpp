#include "core/accuracy/tool_row.hpp"

#include <algorithm>
#include <cmath>

namespace voxtouch::accuracy {

ToolPress::ToolPress(rendering::BuiltScene& built, double edge_m)
    : renderer_(built.scene_renderer()),
      edge_m_(edge_m) {
  renderer_.set_spring_target(1.0);
}

Wrench ToolPress::into(const ContactPlace& place, double depth_m) {
  constexpr int kFadeFrames = 5, kRestFrames = 100;
  constexpr double kStartEdges = 1.0;
  const double start_m = -kStartEdges * edge_m_, step_m = edge_m_ / 8.0;
  renderer_.reset();
  time_s_ = 0.0;
  for (int n = 0; n < kFadeFrames; ++n)
    at(place.at(start_m), rendering::SceneRenderer::kLongestStepS);
  for (double depth = start_m + step_m; depth < depth_m; depth += step_m)
    at(place.at(depth), rendering::SceneRenderer::kDefaultStepS);
  rendering::SceneFrame frame;
  for (int n = 0; n < kRestFrames; ++n)
    frame = at(place.at(depth_m), rendering::SceneRenderer::kDefaultStepS);
  return frame.wrench;
}

std::vector<SlideFrame> ToolPress::slide(const ContactPlace& place, double depth_m,
                                         const std::function<double()>& cpu_time_s) {
  constexpr int kFrames = 40, kRounds = 3;
  constexpr double kAlong = 0.9;  ///< limit for a direction close to the path in
  Vec3 aside = place.touch.orientation * Vec3::UnitX();  // as random as the tool's attitude
  if (std::abs(aside.dot(place.into)) > kAlong)
    aside = place.touch.orientation * Vec3::UnitY();
  aside = (aside - aside.dot(place.into) * place.into).normalized();
  std::vector<SlideFrame> out(kFrames);
  for (int round = 0; round < (cpu_time_s ? kRounds : 1); ++round) {
    into(place, depth_m);
    Pose hand = place.at(depth_m);
    for (SlideFrame& frame : out) {
      hand.position += kSlideEdges * edge_m_ * aside;
      const double begin = cpu_time_s ? cpu_time_s() : 0.0;
      frame.queries = at(hand, rendering::SceneRenderer::kDefaultStepS).tool.queries;
      const double took = cpu_time_s ? std::max(cpu_time_s() - begin, 0.0) : 0.0;
      frame.time_s = round == 0 ? took : std::min(frame.time_s, took);
    }
  }
  return out;
}

rendering::SceneFrame ToolPress::at(const Pose& hand, double dt_s) {
  rendering::ToolState tool;
  tool.pose = hand;
  return renderer_.render(tool, time_s_ += dt_s);
}

}  // namespace voxtouch::accuracy
