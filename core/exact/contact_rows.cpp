#include "core/exact/contact_rows.hpp"

#include <algorithm>

#include "core/exact/limits.hpp"

namespace voxtouch::exact {
namespace {

bool rests_at_origin(const Pose& pose) noexcept { return same(pose, Pose{}); }

Pose relative(const Pose& tool, const Pose& object) noexcept {
  return rests_at_origin(object) ? tool : object.inverse() * tool;
}

Pose between(const Pose& from, const Pose& to, double ratio) noexcept {
  if (ratio >= 1.0)
    return to;
  return {from.position + ratio * (to.position - from.position),
          from.orientation.slerp(ratio, to.orientation)};
}

}  // namespace

bool same(const Pose& a, const Pose& b) noexcept {
  return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs();
}

ContactRows::ContactRows(const ToolBody& tool, std::span<const ObjectBody* const> objects,
                         std::size_t pair_capacity, double lever_m)
    : lever_m_(lever_m),
      objects_(objects.size()),
      targets_(objects.size()),
      planned_(objects.size()) {
  opposites_.reserve(objects.size());
  for (const ObjectBody* object : objects) {
    opposites_.emplace_back(tool, *object, pair_capacity);
    first_owners_.push_back(static_cast<std::uint32_t>(owners_));
    owners_ += object->owners();
  }
  near_.reserve(limits::kMaxNearPairs);
  rows_.reserve(limits::kMaxRows);
  halfspaces_.reserve(limits::kMaxRows);
}

std::size_t ContactRows::bytes() const noexcept {
  std::size_t sum = near_.capacity() * sizeof(NearPair) + rows_.capacity() * sizeof(Row) +
                    halfspaces_.capacity() * sizeof(Halfspace);
  for (const Opposite& opposite : opposites_)
    sum += opposite.bytes();
  return sum;
}

void ContactRows::put(const Pose& tool, std::span<const Pose> objects) noexcept {
  tool_ = tool;
  for (std::size_t n = 0; n < objects_.size(); ++n) {
    objects_[n] = objects[n];
    opposites_[n].put(relative(tool_, objects_[n]));
  }
}

void ContactRows::set_targets(std::span<const Pose> objects) noexcept {
  std::copy(objects.begin(), objects.end(), targets_.begin());
}

bool ContactRows::objects_move() const noexcept {
  return !std::equal(objects_.begin(), objects_.end(), targets_.begin(), same);
}

double ContactRows::object_path() noexcept {
  double most = 0.0;
  for (std::size_t n = 0; n < opposites_.size(); ++n) {
    if (same(objects_[n], targets_[n]))
      continue;
    const Pose there = relative(tool_, targets_[n]);
    most = std::max(most, opposites_[n].path_between(opposites_[n].now().pose(), there));
  }
  return most;
}

void ContactRows::plan_objects(double ratio) noexcept {
  for (std::size_t n = 0; n < objects_.size(); ++n)
    planned_[n] =
        same(objects_[n], targets_[n]) ? objects_[n] : between(objects_[n], targets_[n], ratio);
}

void ContactRows::renew_closes() noexcept {
  for (Row& row : rows_)
    row.closes_m = closes(row);
}

/// Decrease of a row's gap by the planned motion of its object [m].
double ContactRows::closes(const Row& row) const noexcept {
  const Pose &from = objects_[row.object], &to = planned_[row.object];
  if (same(from, to))
    return 0.0;
  const Vec3 on_object = tool_.position + row.arm - row.gap_m * row.normal;
  return row.normal.dot(to * (from.inverse() * on_object) - on_object);
}

void ContactRows::add_row(const Touch& touch, const NearPair& pair) noexcept {
  const Pose& from = objects_[pair.object];
  Row row;
  row.normal = from.orientation * touch.normal;
  const Vec3 point = from * touch.point;
  row.arm = point - tool_.position;
  row.on_object = touch.point - touch.gap_m * touch.normal;
  row.gap_m = touch.gap_m;
  row.object = pair.object;
  row.owner =
      first_owners_[pair.object] + opposites_[pair.object].object().owner_of(pair.kind, pair.item);
  row.closes_m = closes(row);
  Halfspace halfspace;
  halfspace.jacobian << row.normal, row.arm.cross(row.normal) / lever_m_;
  rows_.push_back(row);
  halfspaces_.push_back(halfspace);
}

bool ContactRows::collect(double reach_m, Work& work) noexcept {
  near_.clear();
  rows_.clear();
  halfspaces_.clear();
  for (std::uint32_t n = 0; n < opposites_.size(); ++n) {
    Opposite& opposite = opposites_[n];
    const auto take = [&](PairKind kind, std::uint32_t element, std::uint32_t item, double distance,
                          const SeparatingPlane& plane) {
      work.add(Work::kTouches);
      if (near_.size() == near_.capacity() || rows_.size() + 8 > rows_.capacity() / 2)
        return false;
      const NearPair pair{kind, element, item, n, distance, plane};
      near_.push_back(pair);
      const Touches touches =
          touches_of(pair, opposite.tool(), opposite.object(), opposite.now(), reach_m);
      for (std::size_t k = 0; k < touches.count; ++k)
        add_row(touches.of[k], pair);
      return true;
    };
    if (!opposite.visit_near(reach_m + 2.0 * limits::kMarginM, take, work))
      return false;
  }
  return true;
}

void ContactRows::try_step(const Pose& tool) noexcept {
  tried_ = tool;
  for (std::size_t n = 0; n < opposites_.size(); ++n)
    opposites_[n].next().set_pose(relative(tool, planned_[n]));
}

bool ContactRows::passes_something(const Vec6& delta, Work& work) noexcept {
  bool passed = false;
  for (const NearPair& pair : near_) {
    Opposite& opposite = opposites_[pair.object];
    PosedPoints &now = opposite.now(), &next = opposite.next();
    if (pair.distance_m > opposite.path_between(now.pose(), next.pose()) + limits::kTouchM)
      continue;
    if (work.done())
      return true;  // not known
    work.add(2);
    if (stays_apart(pair, opposite.tool(), now) && stays_apart(pair, opposite.tool(), next))
      continue;
    work.add(Work::kSwept);
    if (!passes(pair, opposite.tool(), opposite.object(), now, next))
      continue;
    passed = true;
    if (rows_.size() == rows_.capacity())
      continue;
    double found = 0.0;
    const Touch touch = passed_touch(pair, opposite.tool(), opposite.object(), now, next, found);
    add_row(touch, pair);
    Row& row = rows_.back();
    const double predicted = row.gap_m - row.closes_m + halfspaces_.back().jacobian.dot(delta);
    row.missed_m = limits::kCorrection * std::max(0.0, predicted - found);
  }
  return passed;
}

void ContactRows::accept() noexcept {
  for (Opposite& opposite : opposites_)
    opposite.accept();
  tool_ = tried_;
  std::copy(planned_.begin(), planned_.end(), objects_.begin());
}

}  // namespace voxtouch::exact
