#pragma once
/// Vertices, edges and faces of a tool that are near those of a scene, and which of them a motion
/// brings together first.
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/reference/convex_part.hpp"
#include "core/reference/triangle_tree.hpp"

namespace voxtouch::reference {

/// Where two parts come close between one pose and another.
struct Meeting {
  double time = 0.0;  ///< 0 at the first pose, 1 at the other
  Nearness at;        ///< then, in the scene's frame
};

/// Tests all pairs of parts, of any shape. Triangles have no side, so open scenes, seams and
/// overlapping solids need no rule.
class NearParts {
 public:
  /// `range_m`: at least three times the longest motion between two calls of `move_to`. Allocates.
  NearParts(const ReferenceMesh& tool, const ReferenceMesh& scene, double range_m);

  /// Sets the tool's pose in the scene's frame. Allocates.
  void move_to(const Pose& pose);
  /// Smallest distance of the surfaces [m], at most the range.
  double distance_m();
  /// The first place at which two parts come closer than `closest_m` on the path to `next`; the
  /// surfaces are farther apart at the start. Each point moves straight, so no part passes another
  /// undetected.
  std::optional<Meeting> first_meeting(const Pose& next, double closest_m);

  /// Largest displacement of a point of the tool between two poses, or more [m].
  double displacement_m(const Pose& from, const Pose& to) const;
  double tool_reach_m() const { return reach_m_; }

 private:
  /// Points of a part; with fewer than three, the first is repeated.
  struct Corners {
    std::array<std::uint32_t, 3> points;
    std::uint8_t count;
  };
  /// The parts of a mesh: vertices, edges, faces.
  struct Parts {
    explicit Parts(const ReferenceMesh& mesh);
    ConvexPart part(std::uint32_t which, const std::vector<Vec3>& at) const;
    std::vector<Vec3> points;
    std::vector<Corners> corners;
    std::vector<std::array<std::uint32_t, 7>> of_triangle;
  };
  struct Pair {
    std::uint32_t mine = 0, other = 0;
    double at_least_m = 0.0;  ///< bound of their distance
    std::uint64_t known_at = 0;
    Vec3 direction = Vec3::Zero();  ///< at the pose number `known_at`
  };

  std::vector<Vec3> posed(const Pose& pose) const;
  void find_pairs();
  void measure(Pair& pair);

  Parts tool_, scene_;
  TriangleTree tool_tree_, scene_tree_;
  double range_m_, reach_m_ = 0.0;
  Pose pose_;
  std::vector<Vec3> points_;  ///< of the tool at `pose_`
  std::vector<Pair> pairs_;
  double path_m_ = 0.0;            ///< since the pairs were listed
  std::uint64_t pose_number_ = 0;  ///< 0: none yet
};

}  // namespace voxtouch::reference
