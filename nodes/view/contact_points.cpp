#include "nodes/view/contact_points.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "nodes/runtime/realtime.hpp"
#include "nodes/scene_build/build_here.hpp"
#include "nodes/view/rounded.hpp"

namespace voxtouch::view {
namespace {

std::vector<Vec3> contact_points_at(rendering::BuiltScene& built, const Pose& object,
                                    double scene_time_s) {
  std::vector<Vec3> all;
  rendering::ObjectContacts& contacts = built.contacts();
  for (std::size_t n = 0; n < contacts.size(); ++n) {
    const rendering::StaticObject& resting = contacts.object(n);
    const Vec3 moved =
        resting.moves ? motion_at(*resting.moves, scene_time_s).position : Vec3::Zero();
    Pose pose = object;
    pose.position -= moved;
    contact::ContactRenderer& renderer = *contacts.object(n).renderer;
    (void)renderer.probe(pose);
    const contact::HitList& hits = renderer.hits();
    for (const auto* kind : {&hits.surface, &hits.interior})
      for (const contact::Hit& hit : *kind)
        all.push_back(object.position + hit.arm);
  }
  if (all.size() <= ContactPoints::kMaxPoints)
    return all;
  std::vector<Vec3> selected;
  for (std::size_t n = 0; n < ContactPoints::kMaxPoints; ++n)
    selected.push_back(all[n * all.size() / ContactPoints::kMaxPoints]);
  return selected;
}

nlohmann::json shell_of(rendering::BuiltScene& built) {
  const pointshell::Pointshell& shell = built.renderer().query().shell();
  const std::size_t count = std::min(shell.size(), ContactPoints::kMaxShellPoints);
  nlohmann::json points = nlohmann::json::array();
  for (std::size_t n = 0; n < count; ++n) {
    const Vec3 point = shell.point(n * shell.size() / count);
    for (const double x : {point.x(), point.y(), point.z()})
      points.push_back(rounded(x));
  }
  return {{"type", "shell"}, {"points", std::move(points)}};
}

/// Lowers the priority of the calling thread, so that it takes no time from a ring.
void lower_priority() {
  runtime::ordinary_priority();
  setpriority(PRIO_PROCESS, 0, 19);
}

template <class T>
bool is_ready(const std::future<T>& future) {
  return future.valid() && future.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

}  // namespace

void ContactPoints::set_scene(const scene::Scene& scene) {
  scene_ = scene;
  pose_request_.reset(), points_.reset(), slice_request_.reset(), slice_.reset();
  shell_ = nullptr;
  missing_reason_ = "the page's copy of the scene is being built";
}

void ContactPoints::request(const Pose& object, double scene_time_s) {
  pose_request_ = PoseRequest{object, scene_time_s};
}
void ContactPoints::request(const SliceRequest& request) { slice_request_ = request; }
std::optional<nlohmann::json> ContactPoints::take_slice() {
  return std::exchange(slice_, std::nullopt);
}

void ContactPoints::poll() {
  if (is_ready(building_)) {
    std::string reason;
    try {
      built_ = building_.get();
      if (!scene_)
        shell_ = shell_of(*built_);
    } catch (const std::exception& error) {
      reason = error.what();
    }
    if (!scene_)
      missing_reason_ = reason;
  }
  if (is_ready(query_)) {
    Result result = query_.get();
    if (!scene_ && result.points)
      points_ = std::move(result.points);
    if (!scene_ && result.slice)
      slice_ = std::move(result.slice);
  }
  if (building_.valid() || query_.valid())
    return;
  if (scene_) {
    built_.reset();
    building_ = std::async(std::launch::async, [scene = *std::exchange(scene_, std::nullopt)] {
      lower_priority();
      return scene_build::build_here(
          scene, {.who = "view", .loop = serial_for(), .reports_progress = false});
    });
  } else if (built_ && (pose_request_ || slice_request_)) {
    query_ = std::async(
        std::launch::async, [this, request = std::exchange(pose_request_, std::nullopt),
                             slice_request = std::exchange(slice_request_, std::nullopt)] {
          lower_priority();
          Result result;
          if (request)
            result.points = contact_points_at(*built_, request->object, request->scene_time_s);
          if (slice_request)
            result.slice = slice_of(built_->contacts(), *slice_request);
          return result;
        });
  }
}

}  // namespace voxtouch::view
