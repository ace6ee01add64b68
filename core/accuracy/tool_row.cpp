#include "core/accuracy/tool_row.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <variant>

#include "core/accuracy/contact_errors.hpp"
#include "core/reference/god_ball.hpp"

namespace voxtouch::accuracy {
namespace {

double radius_of(const scene::Scene& scene) {
  const scene::MeshSpec& tool = scene.dynamic_mesh;
  const auto* ball = tool.primitives.size() == 1 ? std::get_if<scene::SpherePrimitive>(&tool.primitives.front()) : nullptr;
  if (ball == nullptr || (tool.pose * ball->centre).norm() > 1e-9)
    throw std::runtime_error("the exact virtual tool is known for a ball about its origin: dynamic: {parts: [{sphere: ...}]}");
  return ball->radius_m;
}

/// Goes in by an eighth of a voxel a frame, and rests. It begins a voxel before the touch: a virtual tool is placed where nothing touches,
/// and at a rim the touch itself may count as inside.
class Press {
 public:
  Press(rendering::SceneRenderer& renderer, double edge_m) : renderer_(renderer), edge_m_(edge_m), step_m_(edge_m / 8.0) {
    renderer_.aim_for_spring(1.0);
  }

  rendering::SceneFrame into(const ContactPlace& place, double depth_m) {
    constexpr int kFadeFrames = 5, kRestFrames = 100;
    const double start_m = -kStartEdges * edge_m_;
    renderer_.reset();
    time_s_ = 0.0;
    for (int n = 0; n < kFadeFrames; ++n) at(place.at(start_m), rendering::SceneRenderer::kLongestStepS);
    for (double depth = start_m + step_m_; depth < depth_m; depth += step_m_) at(place.at(depth), rendering::SceneRenderer::kDefaultStepS);
    rendering::SceneFrame frame;
    for (int n = 0; n < kRestFrames; ++n) frame = at(place.at(depth_m), rendering::SceneRenderer::kDefaultStepS);
    return frame;
  }
  rendering::SceneFrame at(const Pose& hand, double dt_s) {
    rendering::ToolState tool;
    tool.pose = hand;
    return renderer_.render(tool, time_s_ += dt_s);
  }

 private:
  static constexpr double kStartEdges = 1.0;

  rendering::SceneRenderer& renderer_;
  double edge_m_, step_m_, time_s_ = 0.0;
};

}  // namespace

void judge_tool(const scene::Scene& scene, rendering::BuiltScene& built, const reference::ReferenceScene& reference,
                const std::vector<ContactPlace>& places, const AccuracyOptions& options, AccuracyRow& row) {
  constexpr int kRounds = 5;
  const double radius = radius_of(scene), depth = kHandDepthEdges * row.setting.voxel_m;
  const auto now = [&] { return options.cpu_time_s ? options.cpu_time_s() : 0.0; };
  Press press(built.scene_renderer(), row.setting.voxel_m);
  std::vector<WrenchPair> pairs;
  std::vector<double> times;
  for (const ContactPlace& place : places) {
    const Vec3 hand = place.at(depth).position;
    Wrench truth;
    truth.force = reference::drawn_ball(reference, radius, place.touch.position, hand) - hand;
    pairs.push_back({press.into(place, depth).wrench, truth});
    double best = 1.0;
    for (int n = 1; n <= kRounds; ++n) {  // a hand that moves: frames at rest cost next to nothing
      const double begin = now();
      press.at(place.at(depth + n * row.setting.voxel_m / 40.0), rendering::SceneRenderer::kDefaultStepS);
      best = std::min(best, std::max(now() - begin, 0.0));
    }
    times.push_back(1e6 * best);
  }
  judge_wrenches(pairs, row);
  row.onset_error_m = row.onset_worst_m = std::numeric_limits<double>::quiet_NaN();
  if (!options.cpu_time_s) return;
  row.worst_us = *std::max_element(times.begin(), times.end());
  row.median_us = median_of(std::move(times));
}

}  // namespace voxtouch::accuracy
