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

std::vector<Vec3> find(rendering::BuiltScene& built, const Pose& object, double scene_time_s) {
  std::vector<Vec3> all;
  rendering::ObjectContacts& contacts = built.contacts();
  for (std::size_t n = 0; n < contacts.size(); ++n) {
    const rendering::StaticObject& rests = contacts.object(n);
    const Vec3 moved = rests.moves ? motion_at(*rests.moves, scene_time_s).position : Vec3::Zero();
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
  std::vector<Vec3> some;
  for (std::size_t n = 0; n < ContactPoints::kMaxPoints; ++n)
    some.push_back(all[n * all.size() / ContactPoints::kMaxPoints]);
  return some;
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

/// This thread alone: what it does must not take time from a ring on the same machine.
void yield_lock() {
  runtime::ordinary_priority();
  setpriority(PRIO_PROCESS, 0, 19);
}

template <class T>
bool is_ready(const std::future<T>& future) {
  return future.valid() && future.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

}  // namespace

void ContactPoints::scene_is(const scene::Scene& scene) {
  scene_ = scene;
  question_.reset(), points_.reset(), slice_question_.reset(), slice_.reset();
  shell_ = nullptr;
  refusal_ = "the page's copy of the scene is being built";
}

void ContactPoints::ask(const Pose& object, double scene_time_s) {
  question_ = Question{object, scene_time_s};
}
void ContactPoints::ask(const SliceQuestion& question) { slice_question_ = question; }
std::optional<nlohmann::json> ContactPoints::take_slice() {
  return std::exchange(slice_, std::nullopt);
}

void ContactPoints::look() {
  if (is_ready(building_)) {
    std::string refusal;
    try {
      built_ = building_.get();
      if (!scene_)
        shell_ = shell_of(*built_);
    } catch (const std::exception& error) {
      refusal = error.what();
    }
    if (!scene_)
      refusal_ = refusal;
  }
  if (is_ready(finding_)) {
    Found found = finding_.get();
    if (!scene_ && found.points)
      points_ = std::move(found.points);
    if (!scene_ && found.slice)
      slice_ = std::move(found.slice);
  }
  if (building_.valid() || finding_.valid())
    return;
  if (scene_) {
    built_.reset();
    building_ = std::async(std::launch::async, [scene = *std::exchange(scene_, std::nullopt)] {
      yield_lock();
      return scene_build::build_here(
          scene, {.who = "view", .loop = serial_for(), .reports_progress = false});
    });
  } else if (built_ && (question_ || slice_question_)) {
    finding_ = std::async(
        std::launch::async, [this, question = std::exchange(question_, std::nullopt),
                             slice_question = std::exchange(slice_question_, std::nullopt)] {
          yield_lock();
          Found found;
          if (question)
            found.points = find(*built_, question->object, question->scene_time_s);
          if (slice_question)
            found.slice = slice_of(built_->contacts(), *slice_question);
          return found;
        });
  }
}

}  // namespace voxtouch::view
