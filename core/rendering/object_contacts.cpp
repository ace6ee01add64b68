#include "core/rendering/object_contacts.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <stdexcept>

namespace voxtouch::rendering {
namespace {

/// Sum of the normals of the colliding points over their number, from `coherence` and
/// `mean_normal`.
Vec3 normal_sum(const contact::ContactResult& c) noexcept {
  return (c.coherence * c.surface_hits) * c.mean_normal;
}

/// The members of each solid whose contact uses a mean normal or latches depths.
std::vector<std::vector<contact::ContactRenderer*>> solids_in(
    const std::vector<std::unique_ptr<StaticObject>>& objects) {
  std::map<std::size_t, std::vector<contact::ContactRenderer*>> members;
  for (const auto& object : objects)
    if (object->solid && contact::remembers(object->renderer->model()))
      members[*object->solid].push_back(&*object->renderer);
  std::vector<std::vector<contact::ContactRenderer*>> solids;
  for (auto& [first, renderers] : members)
    solids.push_back(std::move(renderers));
  return solids;
}

}  // namespace

void add_contact(const contact::ContactResult& other, contact::ContactResult& sum) noexcept {
  const Vec3 normals = normal_sum(sum) + normal_sum(other);
  sum.wrench.force += other.wrench.force, sum.wrench.torque += other.wrench.torque;
  sum.surface_hits += other.surface_hits, sum.interior_hits += other.interior_hits;
  const double length = normals.norm();
  sum.coherence = sum.surface_hits > 0 ? length / sum.surface_hits : 0.0;
  sum.mean_normal = length > 0.0 ? Vec3(normals / length) : Vec3::Zero();
  if (other.deepest_depth_m > sum.deepest_depth_m) {
    sum.deepest_depth_m = other.deepest_depth_m;
    sum.deepest_point = other.deepest_point;
  }
  sum.stiffness_bound_n_per_m += other.stiffness_bound_n_per_m;
  sum.stiffness += other.stiffness;
  sum.fallback |= other.fallback, sum.saturated |= other.saturated;
  if (sum.pose_status == contact::PoseStatus::kUsable)
    sum.pose_status = other.pose_status;
  sum.points_tested += other.points_tested;
}

ObjectContacts::ObjectContacts(std::vector<std::unique_ptr<StaticObject>> objects)
    : objects_(std::move(objects)) {
  if (objects_.empty() || objects_.size() > scene::kMaxObjects)
    throw std::invalid_argument(fmt::format("number of static objects: limits 1 to {}, not {}",
                                            scene::kMaxObjects, objects_.size()));
  for (const auto& object : objects_) {
    moves_ = moves_ || object->moves;
    parts_.push_back({.object = object->id, .contact = nullptr, .twist = {}});
  }
  if (objects_.size() == 1 && !moves_) {
    alone_ = &*objects_[0]->renderer;
    return;
  }
  solids_ = solids_in(objects_);
  motions_.resize(objects_.size());
  results_.resize(objects_.size());
  for (std::size_t n = 0; n < objects_.size(); ++n)
    parts_[n].contact = &results_[n];
}

/// Finds the hits of an object at its position at `time_s`; returns its motion then.
MotionPoint ObjectContacts::find(StaticObject& object, const Pose& tool, double time_s) noexcept {
  const MotionPoint at = object.moves ? motion_at(*object.moves, time_s) : MotionPoint{};
  object.renderer->find({tool.position - at.position, tool.orientation});
  return at;
}

contact::StageResult ObjectContacts::render_all(const Pose& tool, double time_s) noexcept {
  contact::StageResult all;
  power_w_ = 0.0;
  for (std::size_t n = 0; n < objects_.size(); ++n) {
    motions_[n] = find(*objects_[n], tool, time_s);
    parts_[n].twist.linear = motions_[n].velocity;
  }
  for (const auto& solid : solids_) {
    contact::ContactRenderer::share_normals(solid);
    contact::ContactRenderer::share_memory(solid);
  }
  for (std::size_t n = 0; n < objects_.size(); ++n) {
    contact::StageResult one = objects_[n]->renderer->render_found();
    if (one.contact.deepest_depth_m > 0.0)
      one.contact.deepest_point += motions_[n].position;
    results_[n] = one.contact;
    power_w_ += one.contact.wrench.force.dot(motions_[n].velocity);
    if (n == 0) {
      all = one;
    } else {
      add_contact(one.contact, all.contact);
      all.latched |= one.latched, all.fast |= one.fast,
          all.tunnelling_suspected |= one.tunnelling_suspected,
          all.passed_through |= one.passed_through;
    }
  }
  if (all.contact.pose_status != contact::PoseStatus::kUsable && objects_.size() > 1) {
    const contact::PoseStatus why = all.contact.pose_status;
    all = {};
    all.contact.pose_status = why;
    power_w_ = 0.0;
    for (std::size_t n = 0; n < objects_.size(); ++n)
      results_[n] = all.contact;
  }
  return all;
}

void ObjectContacts::soften(double part) noexcept {
  for (contact::ContactResult& result : results_)
    result.stiffness_bound_n_per_m *= part, result.stiffness *= part;
}

void ObjectContacts::reset() noexcept {
  for (auto& object : objects_)
    object->renderer->reset();
  power_w_ = 0.0;
}

contact::ContactResult ObjectContacts::probe(const Pose& tool,
                                             std::vector<std::uint32_t>& surface_ids) {
  surface_ids.clear();
  std::vector<std::uint32_t> of_one;
  contact::ContactResult sum;
  for (auto& object : objects_)
    find(*object, tool, 0.0);
  for (const auto& solid : solids_)
    contact::ContactRenderer::share_normals(solid);
  for (std::size_t n = 0; n < objects_.size(); ++n) {
    const contact::ContactResult one = objects_[n]->renderer->probe_found(of_one);
    surface_ids.insert(surface_ids.end(), of_one.begin(), of_one.end());
    if (n == 0) {
      sum = one;
    } else {
      add_contact(one, sum);
    }
  }
  std::sort(surface_ids.begin(), surface_ids.end());
  surface_ids.erase(std::unique(surface_ids.begin(), surface_ids.end()), surface_ids.end());
  return sum;
}

}  // namespace voxtouch::rendering
