#pragma once
/// The tool against all objects: where they meet, which features are near, and the rows of these.
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
  double closes_m = 0.0;  ///< gap that the object's motion closes in this step
  double missed_m = 0.0;  ///< gap that the straight row missed in a rejected step
  std::uint32_t object = 0;
  std::uint32_t owner = 0;  ///< numbered over all objects
};

/// State: the poses at which tool and objects meet, and lists that are a cache. All memory is taken
/// at construction; everything else is real-time safe. Bodies must outlive it.
class ContactRows {
 public:
  /// `lever_m` weighs rotations against shifts in the jacobians.
  ContactRows(const ToolBody& tool, std::span<const ObjectBody* const> objects,
              std::size_t pair_capacity, double lever_m);

  std::size_t size() const noexcept { return opposites_.size(); }
  std::size_t owners() const noexcept { return owners_; }
  std::size_t bytes() const noexcept;

  const Pose& tool() const noexcept { return tool_; }
  /// Where the tool meets the objects; they may have gone on to their targets.
  std::span<const Pose> objects() const noexcept { return objects_; }
  std::span<Opposite> opposites() noexcept { return opposites_; }
  /// Puts all there without a step: forgets all lists. `objects` as at construction.
  void put(const Pose& tool, std::span<const Pose> objects) noexcept;

  void set_targets(std::span<const Pose> objects) noexcept;
  /// Whether an object is not at its target.
  bool objects_move() const noexcept;
  /// What the objects still have to go, seen from the tool [m].
  double object_path() noexcept;
  /// In the next step the objects go this ratio of the way to their targets.
  void plan_objects(double ratio) noexcept;
  /// After `plan_objects`, where rows are kept.
  void renew_closes() noexcept;

  /// Makes the rows of all pairs within `reach_m`; false, and incomplete, where there are more than
  /// there is room for, or at the limit of work.
  bool collect(double reach_m, Work& work) noexcept;
  std::span<const Row> rows() const noexcept { return rows_; }
  /// One a row; the caller sets `least_m`.
  std::span<Halfspace> halfspaces() noexcept { return halfspaces_; }
  std::size_t pairs() const noexcept { return near_.size(); }

  /// The step that is tried: the tool goes to `tool`, the objects where they are planned.
  void try_step(const Pose& tool) noexcept;
  /// Whether a pair passes through each other on that step. Adds a row for each that does, with
  /// what a straight row missed of its gap: second-order correction (Nocedal and Wright 2006,
  /// 18.3). `delta` is the step, as the jacobians count. True where it is not known.
  bool passes_something(const Vec6& delta, Work& work) noexcept;
  /// Takes that step.
  void accept() noexcept;

 private:
  void add_row(const Touch& touch, const NearPair& pair) noexcept;
  double closes(const Row& row) const noexcept;

  double lever_m_;
  std::vector<Opposite> opposites_;
  std::vector<std::uint32_t> first_owners_;  ///< of each object
  std::size_t owners_ = 0;
  Pose tool_, tried_;
  std::vector<Pose> objects_, targets_, planned_;  ///< now; where they are; after the step
  std::vector<NearPair> near_;
  std::vector<Row> rows_;
  std::vector<Halfspace> halfspaces_;
};

/// Bit for bit.
bool same(const Pose& a, const Pose& b) noexcept;

}  // namespace voxtouch::exact
