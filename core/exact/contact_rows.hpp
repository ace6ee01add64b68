#pragma once
/// The tool against all objects: poses, near pairs of features, and their rows.
#include <cstdint>
#include <span>
#include <vector>

#include "core/exact/opposite.hpp"
#include "core/exact/projection.hpp"
#include "core/exact/touches.hpp"
#include "core/exact/work.hpp"

namespace voxtouch::exact {

/// A row, in addition to what the projection needs of it.
struct Row {
  Vec3 normal = Vec3::Zero();     ///< W, from the object to the tool
  Vec3 arm = Vec3::Zero();        ///< from the tool's origin to its point, W [m]
  Vec3 on_object = Vec3::Zero();  ///< the object's point, in its frame [m]
  double gap_m = 0.0;
  double closes_m = 0.0;  ///< decrease of the gap by the object's motion in this step
  double missed_m = 0.0;  ///< error of the straight row's gap in a rejected step
  std::uint32_t object = 0;
  std::uint32_t owner = 0;  ///< numbered over all objects
};

/// State: the poses of tool and objects, and lists that are a cache. The constructor allocates all
/// memory; all else is real-time safe. Bodies must outlive it.
class ContactRows {
 public:
  /// `lever_m`: converts rotations to displacements in the jacobians.
  ContactRows(const ToolBody& tool, std::span<const ObjectBody* const> objects,
              std::size_t pair_capacity, double lever_m);

  std::size_t size() const noexcept { return opposites_.size(); }
  std::size_t owners() const noexcept { return owners_; }
  std::size_t bytes() const noexcept;

  const Pose& tool() const noexcept { return tool_; }
  /// Poses of the objects in the contact; may lag behind their targets.
  std::span<const Pose> objects() const noexcept { return objects_; }
  std::span<Opposite> opposites() noexcept { return opposites_; }
  /// Places all without a step, which discards all lists. `objects` in the order of construction.
  void put(const Pose& tool, std::span<const Pose> objects) noexcept;

  void set_targets(std::span<const Pose> objects) noexcept;
  /// Whether an object is not at its target.
  bool objects_move() const noexcept;
  /// Largest remaining path of an object to its target, relative to the tool [m].
  double object_path() noexcept;
  /// Sets the fraction of the remaining motion that the objects make in the next step.
  void plan_objects(double ratio) noexcept;
  /// Updates Row::closes_m after `plan_objects`, if the rows are used again.
  void renew_closes() noexcept;

  /// Makes the rows of all pairs within `reach_m`. Returns false, incomplete, without room for all
  /// of them or at the limit of work.
  bool collect(double reach_m, Work& work) noexcept;
  std::span<const Row> rows() const noexcept { return rows_; }
  /// One a row; the caller sets `least_m`.
  std::span<Halfspace> halfspaces() noexcept { return halfspaces_; }
  std::size_t pairs() const noexcept { return near_.size(); }

  /// Sets the step to try: the tool moves to `tool`, the objects to their planned poses.
  void try_step(const Pose& tool) noexcept;
  /// Whether the features of a pair pass through each other on that step; also true at the limit of
  /// work. Adds a row for each such pair, with the error of its straight row as second-order
  /// correction (Nocedal and Wright 2006, 18.3). `delta`: the step in the units of the jacobians.
  bool passes_something(const Vec6& delta, Work& work) noexcept;
  /// Takes the tried step.
  void accept() noexcept;

 private:
  void add_row(const Touch& touch, const NearPair& pair) noexcept;
  double closes(const Row& row) const noexcept;

  double lever_m_;
  std::vector<Opposite> opposites_;
  std::vector<std::uint32_t> first_owners_;  ///< of each object
  std::size_t owners_ = 0;
  Pose tool_, tried_;
  std::vector<Pose> objects_, targets_, planned_;  ///< in the contact; real; after the step
  std::vector<NearPair> near_;
  std::vector<Row> rows_;
  std::vector<Halfspace> halfspaces_;
};

/// Whether both poses are equal in each number, without tolerance.
bool same(const Pose& a, const Pose& b) noexcept;

}  // namespace voxtouch::exact
