#pragma once
/// A second pose of the tool (proxy) that stays outside the scene and follows the hand's pose; the
/// displayed force is the spring between both.
///
/// Virtual coupling with a constraint-based tool (Wan and McNeely 2003; Ortega et al. 2007; Barbic
/// and James 2008; Xu and Barbic 2016). Let d = [hand - tool; lever * rotation vector from tool to
/// hand], 6 numbers in metres. A frame moves the tool to a minimum of
///
///     E = |d|^2 / 2 + rho/2 sum of the squared depths of the rows
///
/// (constraint_rows.hpp; rho is kRowStiffness), and the spring pulls the hand by k d. There is no
/// mass, velocity or time step, and k does not affect the tool. Without an active row, the pose of
/// the tool is bit-identical to the hand's.
///
/// Between two queries no point of the tool moves more than half a voxel, however far away the hand
/// is. No tool passes a wall of 1.5 voxels, and a tool that is at least three voxels thick
/// everywhere passes no wall. A smaller tool may pass a foil (core/rendering/wall_watch.hpp). A
/// frame ends at the pose of least E that it found (kHysteresisRatio), so a resting hand has a
/// resting tool. In contact the tool moves in a frame no farther than the hand plus a fraction of d
/// (kCatchUpRatio), so an edge that gives way becomes a ramp.
#include <cstdint>
#include <span>
#include <vector>

#include "core/contact/constraint_rows.hpp"
#include "core/contact/equilibrium_step.hpp"

namespace voxtouch::contact {

/// A static object of the virtual tool. All queries of a tool use the same shell.
struct ToolGround {
  const ContactQuery* query = nullptr;
  const voxmap::DistanceField* field = nullptr;
  Vec3 displacement = Vec3::Zero();  ///< Displacement of the object from the position of its
                                     ///< voxmap, in W, in this frame [m].
  /// Points of its sharp edges and rims, relative to its grid's origin, queried in the tool's
  /// voxmap; null: no edges.
  const ContactQuery* edges = nullptr;
  /// With `edges`: distances to the tool, in T.
  const voxmap::DistanceField* tool_field = nullptr;
};

struct VirtualToolOptions {
  std::size_t points = 0;       ///< number of shell points
  std::size_t edge_points = 0;  ///< of all objects together
  std::size_t objects = 1;      ///< largest number of grounds in a frame
  double reach_m =
      0.0;  ///< largest distance of a shell point from the tool's origin, ContactQuery::reach_m
  double edge_m = 0.0;   ///< voxel edge, the smallest of all objects
  double lever_m = 0.0;  ///< weights rotations relative to displacements; 0: `reach_m`
  double fade_s = 0.2;   ///< duration of the fade-in of the force after the tool was placed
};

/// Input of one frame.
struct HandSample {
  Pose pose;               ///< T in W
  double period_s = 1e-3;  ///< since the last frame: for the fade only
  double friction = 0.0;   ///< Coulomb coefficient, >= 0
};

/// Result of one frame, in W; torques about the tool's origin.
struct VirtualToolFrame {
  Pose tool;  ///< the virtual tool; bit-identical to the hand's pose without contact
  Vec3 shift = Vec3::Zero();  ///< from the virtual tool to the hand [m]
  Vec3 turn = Vec3::Zero();   ///< from the virtual tool to the hand, rotation vector [rad]
  double lever_m = 0.0;
  /// Displayed fraction of the spring, 0 to 1, during the fade-in; 0 if `not_initialised` or
  /// `not_converged`.
  double fraction = 0.0;
  /// Displayed stiffness over k, in the metres of d: spring and contact in series, 0 to 1.
  Mat6 displayed = Mat6::Zero();
  double worst_depth_m = 0.0;  ///< of the rows at `tool`; 0: no point is inside
  double residual_m =
      0.0;  ///< bound of the remaining path of the tool's points at the end of the frame
  Vec3 contact_point = Vec3::Zero();  ///< of the row with the largest force
  Vec3 contact_normal =
      Vec3::Zero();  ///< its direction, out of the static object; zero without contact
  std::uint32_t contact_object = 0;  ///< index into the frame's grounds
  std::uint32_t surface_hits = 0, interior_hits = 0, points_tested = 0;  ///< at `tool`
  std::uint32_t rows = 0;                                                ///< number of active rows
  int queries = 0;     ///< number of queries, each of all grounds
  int iterations = 0;  ///< of all steps
  PoseStatus pose_status = PoseStatus::kUsable;
  bool constrained = false;  ///< rows constrain the tool
  bool not_converged =
      false;  ///< no contact, and the hand moves faster than a frame can follow: no force
  bool not_initialised =
      false;               ///< there is no virtual tool: the hand has not been outside the scene
  bool saturated = false;  ///< the distance to the hand exceeds kPullEdges
  bool moved_too_far = false;  ///< An object moved more than half a voxel in this frame: it may
                               ///< have passed the tool.

  /// Displayed wrench with a spring of `k` [N/m]: k d, faded in.
  Wrench wrench(double k) const noexcept {
    const double weighted = fraction * k;
    return {-weighted * shift, -(weighted * lever_m * lever_m) * turn};
  }
  /// -d(wrench)/d(hand's pose) [N/m, N, Nm/rad]: (1/k + 1/contact)^-1, at most k (k lever^2 for
  /// rotations).
  Mat6 stiffness(double k) const noexcept;
};

/// State of the virtual tool: its pose and rows, and the last poses of hand and objects. The
/// constructor allocates all memory; `frame` and `reset` neither allocate, throw nor lock. One
/// thread at a time. Equal frames give bit-identical results.
class VirtualTool {
 public:
  /// Throws std::invalid_argument for options that are not finite or not usable.
  explicit VirtualTool(const VirtualToolOptions& options);

  /// Computes one frame against `grounds`: at most `objects`, the same ones in the same order until
  /// `reset`.
  /// An invalid or out-of-range pose gives no force and leaves the tool in place. Without a tool
  /// (at first, after `reset`) there is no force until the hand is outside. That requires no point
  /// in an interior voxel, none deeper than half a voxel, and no wall, however thin, deeper than
  /// that inside the tool (wall_inside.hpp). The force then fades in over `fade_s`.
  VirtualToolFrame frame(const HandSample& hand, std::span<const ToolGround> grounds) noexcept;

  /// Force of each ground on the tool in the last `frame`, over k: force [m], torque [m^2]. Times k
  /// they sum to the wrench, except for friction and while the tool is still moving. Times k and an
  /// object's velocity they give its power.
  std::span<const Wrench> pushes() const noexcept { return pushes_; }

  /// Removes the tool: a new session, the clutch, a jump of the device, samples refused for longer
  /// than a hold.
  void reset() noexcept;
  /// Starts from `tool` with the full force: a rebuilt scene takes over the tool of its
  /// predecessor. Returns false, without a tool, if that pose is not a valid start (see `frame`).
  bool place(const Pose& tool, std::span<const ToolGround> grounds) noexcept;

  bool placed() const noexcept { return placed_; }
  const VirtualToolOptions& options() const noexcept { return options_; }

 private:
  /// Displacements in a frame [m].
  struct Reach {
    double hand_m = 0.0;  ///< of the hand, including objects
    double tool_m = 0.0;  ///< allowed for the tool
  };
  /// A pose with computed rows.
  struct Kept {
    Pose tool;
    double energy = 0.0, rows_energy = 0.0, worst_depth_m = 0.0;
    std::uint32_t surface_hits = 0, interior_hits = 0, points_tested = 0;
  };
  PoseStatus status_of(Pose& hand, std::span<const ToolGround> grounds) const noexcept;
  RowFrame row_frame(const Vec3& position, std::span<const ToolGround> grounds,
                     std::size_t n) const noexcept;
  void look_up(const Pose& tool, std::span<const ToolGround> grounds, bool smooth,
               VirtualToolFrame& out) noexcept;
  bool wall_inside(const Pose& tool, std::span<const ToolGround> grounds) noexcept;
  bool start(const Pose& tool, std::span<const ToolGround> grounds, VirtualToolFrame& out) noexcept;
  double objects_moved(std::span<const ToolGround> grounds) noexcept;
  Vec6 spring_to(const Pose& hand) noexcept;
  double length_of(const Vec6& delta) const noexcept;
  double longest_step(std::span<const ToolGround> grounds) const noexcept;
  EquilibriumStep solve(const Vec6& spring, double friction) const noexcept;
  void go_back_to(const Kept& kept, VirtualToolFrame& out) noexcept;
  EquilibriumStep follow(const Pose& hand, double friction, std::span<const ToolGround> grounds,
                         const Reach& reach, VirtualToolFrame& out) noexcept;
  EquilibriumStep balance(const Pose& hand, double friction, VirtualToolFrame& out) noexcept;
  void report_step(const EquilibriumStep& step, VirtualToolFrame& out) noexcept;

  VirtualToolOptions options_;
  HitList hits_;
  std::vector<ConstraintRow> rows_, others_;
  std::vector<Wrench> pushes_;
  std::vector<Vec3> displacements_;
  Pose tool_, hand_;
  Vec3 turn_ = Vec3::Zero();    ///< of the last frame: near half a turn its axis is kept
  double rows_energy_ = 0.0;    ///< rho/2 sum of squared depths, all rows at `tool_`
  double worst_depth_m_ = 0.0;  ///< of the rows at `tool_`
  double placed_s_ = 0.0;
  bool placed_ = false, rows_known_ = false;
  bool pressed_ = false;  ///< the last frame had a force
  /// The last frame returned to a better pose than the further motion gave.
  bool blocked_ = false;
};

}  // namespace voxtouch::contact
