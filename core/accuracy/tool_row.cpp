#include "core/accuracy/tool_row.hpp"

#include <algorithm>
#include <stdexcept>
#include <variant>

namespace voxtouch::accuracy {

double drawn_radius_m(const scene::Scene& scene) {
  const scene::MeshSpec& tool = scene.dynamic_mesh;
  const auto* ball = tool.primitives.size() == 1 ? std::get_if<scene::SpherePrimitive>(&tool.primitives.front()) : nullptr;
  if (ball == nullptr || (tool.pose * ball->centre).norm() > 1e-9)
    throw std::runtime_error("the exact virtual tool is known for a ball about its origin: dynamic: {parts: [{sphere: ...}]}");
  return ball->radius_m;
}

ToolPress::ToolPress(rendering::BuiltScene& built, double edge_m) : renderer_(built.scene_renderer()), edge_m_(edge_m) {
  renderer_.aim_for_spring(1.0);
}

Wrench ToolPress::into(const ContactPlace& place, double depth_m) {
  constexpr int kFadeFrames = 5, kRestFrames = 100;
  constexpr double kStartEdges = 1.0;
  const double start_m = -kStartEdges * edge_m_, step_m = edge_m_ / 8.0;
  renderer_.reset();
  time_s_ = 0.0;
  for (int n = 0; n < kFadeFrames; ++n) at(place.at(start_m), rendering::SceneRenderer::kLongestStepS);
  for (double depth = start_m + step_m; depth < depth_m; depth += step_m) at(place.at(depth), rendering::SceneRenderer::kDefaultStepS);
  rendering::SceneFrame frame;
  for (int n = 0; n < kRestFrames; ++n) frame = at(place.at(depth_m), rendering::SceneRenderer::kDefaultStepS);
  return frame.wrench;
}

double ToolPress::frame_s(const ContactPlace& place, double depth_m, const std::function<double()>& cpu_time_s) {
  constexpr int kRounds = 5;
  double best = 1.0;
  for (int n = 1; n <= kRounds; ++n) {
    const double begin = cpu_time_s();
    at(place.at(depth_m + n * edge_m_ / 40.0), rendering::SceneRenderer::kDefaultStepS);
    best = std::min(best, std::max(cpu_time_s() - begin, 0.0));
  }
  return best;
}

rendering::SceneFrame ToolPress::at(const Pose& hand, double dt_s) {
  rendering::ToolState tool;
  tool.pose = hand;
  return renderer_.render(tool, time_s_ += dt_s);
}

}  // namespace voxtouch::accuracy
