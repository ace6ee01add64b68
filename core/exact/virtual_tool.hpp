#pragma once
/// The virtual tool on triangles: it follows the hand as far as the meshes allow, and a spring
/// connects both.
///
/// Virtual coupling with a constraint-based tool (Zilles and Salisbury 1995; Ortega et al. 2007). A
/// frame moves the tool to a local minimum of
///
///     |d|^2 / 2,   d = [hand - tool; lever * rotation vector from tool to hand]   [m]
///
/// over the poses at which it does not penetrate any object. It is quasi-static: mass, velocity and
/// stiffness do not enter.
///
/// Terms. A feature is a face, edge or vertex. A row is the linearised non-penetration condition of
/// a pair of features that face each other (touches.hpp). A list holds the pairs within a distance,
/// and is valid until the tool or the object has moved by a part of it. A query renews the lists,
/// makes the rows, projects d on them (projection.hpp) and takes one step. A step on which features
/// would pass through each other is rejected. A frame has several queries.
#include <cstdint>
#include <span>
#include <vector>

#include "core/exact/contact_rows.hpp"
#include "core/exact/friction.hpp"
#include "core/exact/projection.hpp"
#include "core/exact/work.hpp"

namespace voxtouch::exact {

struct VirtualToolOptions {
  double lever_m = 0.0;  ///< length that converts rotations to displacements; 0: the tool's reach
  double fade_s = 0.2;   ///< duration of the fade-in of the force after a start
  /// Limit of a frame, in units of Work. A frame that reaches it has not converged.
  std::uint64_t max_work = Work::kOfFrame;
  std::size_t pair_capacity = 1 << 16;  ///< least room for pairs of each kind and object
};

/// Input of one frame: the pose of the device's tool, which the hand moves.
struct HandSample {
  Pose pose;               ///< T in W
  double period_s = 1e-3;  ///< time since the last frame; used only for the fade-in
  double friction = 0.0;   ///< Coulomb's coefficient, at least 0
};

enum class PoseStatus : std::uint8_t { kUsable, kNotAPose, kOutOfRange };

/// Output of one frame, W axes, torques about the tool's origin.
struct VirtualToolFrame {
  Pose tool;  ///< pose of the virtual tool; bit-identical to the hand without contact
  Vec3 shift = Vec3::Zero();     ///< from the virtual tool to the hand [m]
  Vec3 rotation = Vec3::Zero();  ///< likewise, rotation vector [rad]
  double lever_m = 0.0;
  double ratio = 0.0;                  ///< factor of the fade-in on the spring's force, 0 to 1
  Mat6 displayed = Mat6::Zero();       ///< displayed stiffness over k, for d; eigenvalues 0 to 1
  double residual_m = 0.0;             ///< length of the last query's step before it is limited
  Vec3 contact_point = Vec3::Zero();   ///< on the object, of the row with the largest force
  Vec3 contact_normal = Vec3::Zero();  ///< of that row, out of the object; zero without contact
  std::uint32_t contact_owner = 0;     ///< owner of that row, index in `contact_forces`
  double coherence = 1.0;              ///< |sum of normals| over their number, of rows that touch
  std::uint32_t rows = 0;              ///< with a contact force
  std::uint32_t rows_seen = 0;         ///< largest number in a query
  std::uint32_t pairs_seen = 0;        ///< largest number in a query
  int queries = 0;
  int iterations = 0;           ///< of all projections
  int rejected_steps = 0;       ///< rejected: features would pass, or the lists did not suffice
  std::uint64_t work = 0;       ///< in units of Work
  double object_delay_m = 0.0;  ///< path of the objects that the tool has not followed yet
  PoseStatus pose_status = PoseStatus::kUsable;
  bool constrained = false;    ///< rows keep the tool away from the hand
  bool not_converged = false;  ///< the minimum was not reached within the frame
  /// There is no virtual tool, because the hand has not been in free space since the start.
  bool not_initialised = false;
  bool cut_short = false;       ///< the limit of work ended the frame
  bool passed_through = false;  ///< an object moved through the tool, which is reset

  /// Wrench of a spring `k` [N/m] on the hand, faded.
  Wrench wrench(double k) const noexcept {
    const double weighted = ratio * k;
    return {-weighted * shift, -(weighted * lever_m * lever_m) * rotation};
  }
  /// -d(wrench)/d(hand's pose) [N/m, N, Nm/rad]; at most k (k lever^2 for rotations).
  Mat6 stiffness(double k) const noexcept;
};

/// State: the tool's pose, the objects' poses, and lists that are a cache. The constructor
/// allocates all memory. All other functions except `place` are real-time safe: no allocation, lock
/// or exception, and work within its limit. One thread at a time. Equal frames give bit-identical
/// results. Body and objects must outlive it.
class VirtualTool {
 public:
  /// Throws std::invalid_argument without objects, or if reach, lever or fade is invalid.
  VirtualTool(const ToolBody& tool, std::span<const ObjectBody* const> objects,
              const VirtualToolOptions& options);

  /// One frame; `objects` are the objects' poses in W, in the order of construction.
  ///
  /// An invalid pose gives no force and leaves the tool unchanged. Without a tool (at first, after
  /// `reset`) there is no force until the hand is in free space and all lists are complete, which
  /// may take several frames. Then the force fades in over `fade_s`.
  VirtualToolFrame frame(const HandSample& hand, std::span<const Pose> objects) noexcept;

  /// Contact force of each owner on the tool in the last `frame`, over the spring constant k: force
  /// [m], torque about the tool's origin [m^2], W axes. Owners are ordered by object. If the tool
  /// has converged, k times their sum is the wrench before the fade-in. k times a force times the
  /// object's velocity is the object's power.
  std::span<const Wrench> contact_forces() const noexcept { return forces_; }

  /// Removes the tool: for a new session, the clutch or a jump of the device.
  void reset() noexcept;
  /// Moves the tool to the hand, for a jump of the pose. The check of the new pose begins with the
  /// next frame and may take several; until then there is no tool. If that pose is not valid, the
  /// tool continues from its present one. Then the force fades in over `fade_s`.
  void relocate() noexcept;
  /// Starts at `tool` from the next frame on, without a fade-in. If that pose is not valid, starts
  /// at the hand.
  void start_at(const Pose& tool) noexcept;
  /// The same in one call, without a limit of work; not for the loop. Returns false, with no tool,
  /// if the pose is not valid.
  bool place(const Pose& tool, std::span<const Pose> objects) noexcept;

  bool placed() const noexcept { return placed_; }
  const Pose& pose() const noexcept { return contacts_.tool(); }
  const VirtualToolOptions& options() const noexcept { return options_; }
  /// Memory of lists and rows [bytes].
  std::size_t bytes() const noexcept { return contacts_.bytes(); }

 private:
  /// Input of a query and the limits of its step.
  struct Query {
    Pose hand;
    double friction = 0.0;
    double lists_m = 0.0;        ///< largest step that the lists cover
    double rows_m = 0.0;         ///< the rows are complete for pairs within this distance
    double reach_m = 0.0;        ///< largest step of the tool: `lists_m` minus that of the objects
    double remaining_m = 0.0;    ///< path that the frame still allows in contact
    double convergence_m = 0.0;  ///< a shorter step ends the frame
    double objects_ratio = 1.0;  ///< fraction of the objects' remaining path made in this step
    bool more_rows = false;      ///< the step reaches pairs that have no rows: repeat with more
  };

  /// A start that is being checked, while there is no tool.
  struct Start {
    Pose pose = {};            ///< if `given`; otherwise the hand's pose is used
    Pose before = {};          ///< if `returns`: the tool's pose if the start is not valid
    bool begun = false;        ///< the check has begun and continues in the next frame
    bool given = false;        ///< `pose` was requested
    bool returns = false;      ///< an invalid start restores `before`
    bool whole_force = false;  ///< without a fade-in
  };

  PoseStatus check(Pose& hand, std::span<const Pose> objects) const noexcept;
  double length_of(const Vec6& delta) const noexcept;
  Vec6 spring_between(const Pose& tool, const Pose& hand) const noexcept;
  Vec6 spring_to(const Pose& hand) const noexcept;
  bool shortens(const Vec6& spring, const Vec6& taken, const Pose& tool,
                const Pose& hand) const noexcept;
  bool start_is_blocked() noexcept;
  bool initialise(const Pose& hand, std::span<const Pose> objects, Work& work) noexcept;
  void reach_of_query(double need_m, double rows_m, Query& query, Work& work) noexcept;
  bool collect_for(Query& query, double objects_m, Work& work) noexcept;
  void solve(const Vec6& target, VirtualToolFrame& out, Work& work) noexcept;
  Vec6 kept_by_rows(const Vec6& step, VirtualToolFrame& out, Work& work) noexcept;
  Projection solve_with(const Vec6& target, double rotation_rad, bool restore_margin,
                        VirtualToolFrame& out, Work& work) noexcept;
  bool try_step(const Pose& tool, const Vec6& taken, Query& query, VirtualToolFrame& out,
                Work& work) noexcept;
  bool clear_beyond_rows(Opposite& opposite, double path_m, Query& query, Work& work) noexcept;
  void note_closing(const Vec6& taken) noexcept;
  void hold_by_friction(const Vec6& spring, double friction) noexcept;
  void limit_to(double ratio, Work& work) const noexcept;
  double solve_query(const Query& query, const Vec6& spring, VirtualToolFrame& out,
                     Work& work) noexcept;
  double step(Query& query, VirtualToolFrame& out, Work& work) noexcept;
  void follow(const HandSample& hand, double hand_path_m, VirtualToolFrame& out,
              Work& work) noexcept;
  void report(VirtualToolFrame& out) noexcept;
  double coherence_of_rows() const noexcept;

  VirtualToolOptions options_;
  double reach_m_;  ///< of the tool
  ContactRows contacts_;
  std::vector<Pose> objects_before_;  ///< with Start::before
  std::vector<Wrench> forces_;
  Projection last_;                ///< of the last query, at the tool's pose
  Mat6 loose_ = Mat6::Identity();  ///< projector on the motions that friction does not hold
  Pose hand_;
  Vec3 rotation_ = Vec3::Zero();  ///< of the last frame, for a constant axis near 180 degrees
  double longest_step_m_ = 0.0;   ///< of the last frame
  double closing_m_ = 0.0;        ///< largest decrease of a row's gap in a step of the last frame
  double damping_ = 1.0;          ///< factor on the steps while the hand rests
  double last_residual_m_ = 0.0, last_step_m_ = 0.0;  ///< of the last query; step 0: there was none
  int all_rows_frames_ = 0;  ///< number of further frames with rows for the whole step
  double placed_s_ = 0.0;    ///< time since the start [s], for the fade-in
  Start start_;
  bool placed_ = false;
  bool converged_ = false;  ///< the last query needs no further step
  bool pressed_ = false;    ///< the last frame had a force
};

}  // namespace voxtouch::exact
