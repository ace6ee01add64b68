#pragma once
/// A second pose of the tool that stays outside the scene and is drawn to the hand's: what the
/// device feels is the spring between both.
///
/// Virtual coupling with a constraint-based tool (Wan and McNeely 2003; Ortega et al. 2007; Barbic
/// and James 2008; Xu and Barbic 2016). With d = [hand - tool; lever * rotation vector from tool to
/// hand], 6 numbers in metres, a frame moves the tool to a minimum of
///     E = |d|^2 / 2 + rho/2 sum of the rows' depths squared        (constraint_rows.hpp,
///     kRowStiffness)
/// and the hand is pulled by k d. No mass, no velocity, no time step; k does not enter. Where no
/// row pushes, the tool's pose is bit-identical to the hand's. Between two queries no point of the
/// tool moves more than half a voxel, however far away the hand is. So no tool passes a wall of 1.5
/// voxels, and a tool that is nowhere thinner than three voxels passes none; a smaller one may pass
/// a foil (core/rendering/wall_watch.hpp). A frame ends at the pose of least E that it met
/// (kHysteresisRatio), so that a hand at rest has a tool at rest. In contact the tool goes no
/// farther in a frame than the hand and a fraction of d (kCatchUpRatio), so that an edge that gives
/// way is a ramp.
#include <cstdint>
#include <span>
#include <vector>

#include "core/contact/constraint_rows.hpp"
#include "core/contact/equilibrium_step.hpp"

namespace voxtouch::contact {

/// A static object as the virtual tool meets it. All of a tool's queries hold the same shell.
struct ToolGround {
  const ContactQuery* query = nullptr;
  const voxmap::DistanceField* field = nullptr;
  Vec3 displacement =
      Vec3::Zero();  ///< of the whole object from where its voxmap lies, in W, in this frame [m]
  const ContactQuery* edges = nullptr;  ///< the points of its sharp edges and rims, from its grid's
                                        ///< origin, looked up in the tool's voxmap; null: none are
  const voxmap::DistanceField* tool_field = nullptr;  ///< with them: distances to the tool, in T
};

struct VirtualToolOptions {
  std::size_t points = 0;       ///< of the shell
  std::size_t edge_points = 0;  ///< of all objects together
  std::size_t objects = 1;      ///< the most grounds of a frame
  double reach_m =
      0.0;  ///< largest distance of a shell point from the tool's origin, ContactQuery::reach_m
  double edge_m = 0.0;   ///< voxel edge, the smallest of all objects
  double lever_m = 0.0;  ///< weighs turns against shifts; 0: `reach_m`
  double fade_s = 0.2;   ///< after the tool was placed the force comes in over this time
};

/// What the hand does in one frame.
struct HandSample {
  Pose pose;               ///< T in W
  double period_s = 1e-3;  ///< since the last frame: for the fade only
  double friction = 0.0;   ///< Coulomb's coefficient, at least 0
};

/// One frame. All in W, torques about the tool's origin.
struct VirtualToolFrame {
  Pose tool;  ///< the virtual tool; bit-identical to the hand's pose where nothing is touched
  Vec3 shift = Vec3::Zero();  ///< from the virtual tool to the hand [m]
  Vec3 turn = Vec3::Zero();   ///< likewise, rotation vector [rad]
  double lever_m = 0.0;
  double fraction = 0.0;          ///< of the spring that is displayed, 0 to 1: it fades in; 0 where
                                  ///< `not_initialised` or `not_converged`
  Mat6 displayed = Mat6::Zero();  ///< stiffness over k that the hand feels, in d's metres: series
                                  ///< of spring and contact, 0 to 1
  double worst_depth_m = 0.0;     ///< of the rows at `tool`; 0: none is inside
  double residual_m =
      0.0;  ///< bound of the path that the tool's points had still to go when the frame ended
  Vec3 contact_point = Vec3::Zero();  ///< of the row that pushes most
  Vec3 contact_normal =
      Vec3::Zero();  ///< its direction, out of the static object; zero without contact
  std::uint32_t contact_object = 0;  ///< index into the frame's grounds
  std::uint32_t surface_hits = 0, interior_hits = 0, points_tested = 0;  ///< at `tool`
  std::uint32_t rows = 0;                                                ///< that push
  int queries = 0;     ///< looked up, each of all grounds
  int iterations = 0;  ///< of all steps
  PoseStatus pose_status = PoseStatus::kUsable;
  bool constrained = false;  ///< rows hold the tool back
  bool not_converged =
      false;  ///< nothing is touched, and the hand is faster than a frame can follow: no force
  bool not_initialised =
      false;  ///< there is no virtual tool yet: the hand has not been outside the scene
  bool saturated = false;  ///< the hand is more than kPullEdges away
  bool moved_too_far =
      false;  ///< an object went more than half a voxel in this frame: it may have passed the tool

  /// What the hand feels with a spring of `k` [N/m]: k d, faded.
  Wrench wrench(double k) const noexcept {
    const double weighted = fraction * k;
    return {-weighted * shift, -(weighted * lever_m * lever_m) * turn};
  }
  /// -d(wrench)/d(hand's pose) [N/m, N, Nm/rad]: (1/k + 1/contact)^-1, at most k (k lever^2 for
  /// turns).
  Mat6 stiffness(double k) const noexcept;
};

/// State: the tool's pose with its rows, and where hand and objects were in the last frame. All
/// memory is taken at construction; `frame` and `reset` neither allocate nor throw nor lock. One
/// thread at a time. The same frames give bit-identical results.
class VirtualTool {
 public:
  /// Throws std::invalid_argument for options that are not finite or without which nothing can be
  /// rendered.
  explicit VirtualTool(const VirtualToolOptions& options);

  /// One frame against `grounds`: at most `objects` of them, the same ones in the same order until
  /// `reset`.
  ///
  /// A pose that is none, or that is out of range, gives no force and leaves the tool where it is.
  /// Without a tool (at first, after `reset`) there is no force until the hand is outside: no point
  /// in an interior voxel, none deeper than half a voxel, and no wall, however thin, deeper than
  /// that inside the tool (wall_inside.hpp). Then the force comes in over `fade_s`.
  VirtualToolFrame frame(const HandSample& hand, std::span<const ToolGround> grounds) noexcept;

  /// What each ground pushes the tool with in the last `frame`, over k: force [m], torque [m^2].
  /// Times k they sum to the wrench (less what friction holds, and while the tool is still on its
  /// way). Times k and an object's velocity: its power.
  std::span<const Wrench> pushes() const noexcept { return pushes_; }

  /// Forgets the tool: a new session, the clutch, a jump of the device, samples refused for longer
  /// than a hold.
  void reset() noexcept;
  /// Starts from `tool`, with the whole force at once: what a scene that was built anew takes over
  /// from the one before it. False, and no tool, where that is no start, as `frame` says of the
  /// hand.
  bool place(const Pose& tool, std::span<const ToolGround> grounds) noexcept;

  bool placed() const noexcept { return placed_; }
  const VirtualToolOptions& options() const noexcept { return options_; }

 private:
  /// How far hand and tool may have gone or go in a frame [m].
  struct Reach {
    double hand_m = 0.0;  ///< the hand went, objects included
    double tool_m = 0.0;  ///< the tool may go
  };
  /// A pose that was looked up.
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
  Vec3 turn_ = Vec3::Zero();    ///< of the last frame: near half a turn its axis stays
  double rows_energy_ = 0.0;    ///< rho/2 sum of squared depths, all rows at `tool_`
  double worst_depth_m_ = 0.0;  ///< likewise
  double placed_s_ = 0.0;
  bool placed_ = false, rows_known_ = false;
  bool pressed_ = false;  ///< the last frame gave a force
  bool blocked_ = false;  ///< the last frame went back to a better pose than the way on led to
};

}  // namespace voxtouch::contact
