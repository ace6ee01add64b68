#pragma once
/// The tool against one object: their relative pose and the lists of near pairs.
#include <algorithm>

#include "core/exact/pair_lists.hpp"
#include "core/exact/start_check.hpp"

namespace voxtouch::exact {

/// Both bodies must outlive it. The constructor allocates all memory; all else is real-time safe.
class Opposite {
 public:
  Opposite(const ToolBody& tool, const ObjectBody& object, std::size_t pair_capacity)
      : tool_(&tool),
        object_(&object),
        now_(tool.features().points),
        next_(tool.features().points),
        vertex_face_(tool, object, pair_capacity),
        face_vertex_(tool, object, pair_capacity),
        edge_edge_(tool, object, pair_capacity) {}

  const ToolBody& tool() const noexcept { return *tool_; }
  const ObjectBody& object() const noexcept { return *object_; }
  /// The tool's points in the object's frame, now and after the tried step.
  PosedPoints& now() noexcept { return now_; }
  PosedPoints& next() noexcept { return next_; }
  StartCheck& start_check() noexcept { return start_check_; }

  /// Places the tool without a step, which discards all lists.
  void put(const Pose& tool_in_object) noexcept {
    now_.set_pose(tool_in_object);
    vertex_face_.reset();
    face_vertex_.reset();
    edge_edge_.reset();
    start_check_.restart();
    path_m_ = rotation_m_ = 0.0;
  }

  /// Bound of the displacement of any point of the tool between two relative poses [m].
  double path_between(const Pose& from, const Pose& to) const noexcept {
    const Quat rotation = to.orientation * from.orientation.conjugate();
    const double angle = 2.0 * std::atan2(rotation.vec().norm(), std::abs(rotation.w()));
    return (to.position - from.position).norm() + angle * tool_->features().reach_m;
  }

  std::size_t bytes() const noexcept {
    return vertex_face_.bytes() + face_vertex_.bytes() + edge_edge_.bytes() + 2 * now_.bytes();
  }

  /// Takes the step that was tried.
  void accept() noexcept {
    const double path = path_between(now_.pose(), next_.pose());
    path_m_ += path;
    rotation_m_ += path - (next_.pose().position - now_.pose().position).norm();
    std::swap(now_, next_);
  }

  void renew(double need_m, double radius_m, Work& work) noexcept {
    const Renewal renewal{path_m_, rotation_m_, need_m, radius_m, need_m};
    vertex_face_.renew(now_, renewal, work);
    edge_edge_.renew(now_, renewal, work);
    face_vertex_.renew(now_, renewal, work);
  }

  /// Whether a pair farther than `seen_m` may touch on the step that is tried, of `length_m`.
  StepVerdict check_step(double length_m, double seen_m, Work& work) noexcept {
    const Step step{path_m_, rotation_m_, length_m, seen_m};
    StepVerdict verdict = vertex_face_.check_step(now_, next_, step, work);
    if (verdict == StepVerdict::kClear)
      verdict = edge_edge_.check_step(now_, next_, step, work);
    if (verdict == StepVerdict::kClear)
      verdict = face_vertex_.check_step(now_, next_, step, work);
    return verdict;
  }

  /// Largest step before an unlisted pair can touch [m].
  double allowed_m() const noexcept {
    return std::min({vertex_face_.holds_for_m(path_m_, rotation_m_),
                     face_vertex_.holds_for_m(path_m_, rotation_m_),
                     edge_edge_.holds_for_m(path_m_, rotation_m_)});
  }
  /// Further path before which no listed pair can touch [m].
  double nearest_m() const noexcept {
    const double at =
        std::min({vertex_face_.nearest_m(), face_vertex_.nearest_m(), edge_edge_.nearest_m()});
    return at - path_m_;
  }

  /// Calls `visit(kind, element, item, distance, plane)` for each listed pair within `reach_m`.
  template <class Visit>
  bool visit_near(double reach_m, Visit&& visit, Work& work) noexcept {
    const auto of = [&](PairKind kind) {
      return [&visit, kind](std::uint32_t element, std::uint32_t item, double distance,
                            const SeparatingPlane& plane) {
        return visit(kind, element, item, distance, plane);
      };
    };
    return vertex_face_.visit_near(now_, path_m_, reach_m, of(PairKind::kVertexFace), work) &&
           edge_edge_.visit_near(now_, path_m_, reach_m, of(PairKind::kEdgeEdge), work) &&
           face_vertex_.visit_near(now_, path_m_, reach_m, of(PairKind::kFaceVertex), work);
  }

 private:
  const ToolBody* tool_;
  const ObjectBody* object_;
  PosedPoints now_, next_;
  PairLists<VertexProbe> vertex_face_;
  PairLists<FaceProbe> face_vertex_;
  PairLists<EdgeProbe> edge_edge_;
  StartCheck start_check_;
  double path_m_ = 0.0, rotation_m_ = 0.0;  ///< path of the tool; part due to rotations
};

}  // namespace voxtouch::exact
