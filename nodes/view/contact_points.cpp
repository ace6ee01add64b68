#include "nodes/view/contact_points.hpp"

#include <sys/resource.h>

#include <exception>
#include <utility>

#include "core/rendering/build.hpp"
#include "nodes/mesh_import/mesh_process.hpp"
#include "nodes/runtime/realtime.hpp"

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
      for (const contact::Hit& hit : *kind) all.push_back(object.position + hit.arm);
  }
  if (all.size() <= ContactPoints::kMost) return all;
  std::vector<Vec3> some;
  for (std::size_t n = 0; n < ContactPoints::kMost; ++n) some.push_back(all[n * all.size() / ContactPoints::kMost]);
  return some;
}

}  // namespace

ContactPoints::ContactPoints() : thread_([this] { run(); }) {}

ContactPoints::~ContactPoints() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  something_.notify_one();
  thread_.join();
}

void ContactPoints::scene_is(const scene::Scene& scene) {
  forget();
  const std::lock_guard lock(mutex_);
  scene_ = scene;
  why_not_ = "the scene is being built here once more";
  something_.notify_one();
}

void ContactPoints::forget() {
  const std::lock_guard lock(mutex_);
  ++wanted_;
  scene_.reset(), question_.reset(), points_.reset(), slice_question_.reset(), slice_.reset();
  why_not_ = "the scene's file is not at hand";
}

void ContactPoints::ask(const Pose& object, double scene_time_s) {
  const std::lock_guard lock(mutex_);
  question_ = Question{object, scene_time_s};
  something_.notify_one();
}

void ContactPoints::ask(const SliceQuestion& question) {
  const std::lock_guard lock(mutex_);
  slice_question_ = question;
  something_.notify_one();
}

std::optional<nlohmann::json> ContactPoints::take_slice() {
  const std::lock_guard lock(mutex_);
  return std::exchange(slice_, std::nullopt);
}

std::optional<std::vector<Vec3>> ContactPoints::points() const {
  const std::lock_guard lock(mutex_);
  return points_;
}

std::string ContactPoints::why_not() const {
  const std::lock_guard lock(mutex_);
  return why_not_;
}

void ContactPoints::run() {
  runtime::ordinary_priority();
  setpriority(PRIO_PROCESS, 0, 19);  // this thread alone: building must not take time from a ring on the same machine
  std::unique_ptr<rendering::BuiltScene> built;
  std::uint64_t built_for = 0;
  std::unique_lock lock(mutex_);
  while (!stop_) {
    something_.wait(lock, [&] { return stop_ || scene_ || ((question_ || slice_question_) && built && built_for == wanted_); });
    if (stop_) return;
    const std::uint64_t wanted = wanted_;
    if (auto scene = std::exchange(scene_, std::nullopt)) {
      lock.unlock();
      std::string why_not;
      try {
        built = rendering::build_scene(*scene, serial_for(), {.read = mesh_import::mesh_process()});
      } catch (const std::exception& error) {
        built.reset();
        why_not = error.what();
      }
      lock.lock();
      built_for = wanted;
      if (wanted == wanted_) why_not_ = why_not;
      continue;
    }
    const auto question = std::exchange(question_, std::nullopt);
    const auto slice_question = std::exchange(slice_question_, std::nullopt);
    lock.unlock();
    std::optional<std::vector<Vec3>> found;
    std::optional<nlohmann::json> slice;
    if (question) found = find(*built, question->object, question->scene_time_s);
    if (slice_question) slice = slice_of(built->contacts(), *slice_question);
    lock.lock();
    if (wanted != wanted_) continue;
    if (found) points_ = std::move(found);
    if (slice) slice_ = std::move(slice);
  }
}

}  // namespace voxtouch::view
