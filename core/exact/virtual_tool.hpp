#pragma once
/// The virtual tool on triangles: it follows the hand as far as the meshes let it, and a spring
/// runs between both.
///
/// Virtual coupling with a constraint-based tool (Zilles and Salisbury 1995; Ortega et al. 2007).
/// With d = [hand - tool; lever * rotation vector from tool to hand], six numbers in metres, a
/// frame moves the tool to a local minimum of |d|^2 / 2 over the poses at which it does not
/// penetrate any object. Quasi-static: no mass, no velocity, no stiffness enters. Each step is the
/// projection of d on the rows of all features that face each other (touches.hpp, projection.hpp);
/// a step on which features would pass through each other is not taken.
#include <cstdint>
#include <span>
#include <vector>

#include "core/exact/contact_rows.hpp"
#include "core/exact/friction.hpp"
#include "core/exact/projection.hpp"
#include "core/exact/work.hpp"

namespace voxtouch::exact {

struct VirtualToolOptions {
  double lever_m = 0.0;  ///< weighs rotations against shifts; 0: the tool's reach
  double fade_s = 0.2;   ///< after the tool was initialised the force comes in over this time
  /// Of a frame, in units of Work; at the limit the tool has not converged.
  std::uint64_t max_work = Work::kOfFrame;
  std::size_t pair_capacity = 1 << 16;  ///< least room for pairs of each kind and object
};

/// What the hand does in one frame.
struct HandSample {
  Pose pose;               ///< T in W
  double period_s = 1e-3;  ///< since the last frame: for the fade only
  double friction = 0.0;   ///< Coulomb's coefficient, at least 0
};

enum class PoseStatus : std::uint8_t { kUsable, kNotAPose, kOutOfRange };

/// One frame. All in W, torques about the tool's origin.
struct VirtualToolFrame {
  Pose tool;  ///< the virtual tool; bit-identical to the hand where nothing is touched
  Vec3 shift = Vec3::Zero();     ///< from the virtual tool to the hand [m]
  Vec3 rotation = Vec3::Zero();  ///< likewise, rotation vector [rad]
  double lever_m = 0.0;
  double ratio = 0.0;                  ///< of the spring's force that is given, 0 to 1: it fades in
  Mat6 displayed = Mat6::Zero();       ///< displayed stiffness over k, in the units of d: 0 to 1
  double residual_m = 0.0;             ///< remaining path of the last step
  Vec3 contact_point = Vec3::Zero();   ///< on the object, of the row that pushes most
  Vec3 contact_normal = Vec3::Zero();  ///< its direction, out of the object; zero without contact
  std::uint32_t contact_owner = 0;     ///< whose row that is, numbered as `contact_forces`
  double coherence = 1.0;              ///< |sum of normals| over their number, of rows that touch
  std::uint32_t rows = 0;              ///< with a contact force
  std::uint32_t rows_seen = 0;         ///< largest number in a query
  std::uint32_t pairs_seen = 0;        ///< largest number in a query
  int queries = 0;
  int iterations = 0;           ///< of all projections
  int void_steps = 0;           ///< rejected: a feature would pass through another
  std::uint64_t work = 0;       ///< in units of Work
  double object_delay_m = 0.0;  ///< how far the objects are beyond where the tool meets them
  PoseStatus pose_status = PoseStatus::kUsable;
  bool constrained = false;    ///< rows hold the tool off the hand
  bool not_converged = false;  ///< the tool has not come to its place within the frame
  bool not_initialised =
      false;               ///< there is no virtual tool: the hand has not been in the open yet
  bool cut_short = false;  ///< the limit of work ended the frame
  bool passed_through =
      false;  ///< an object moved through the tool: the tool could not be kept outside

  /// Wrench of a spring `k` [N/m] on the hand, faded.
  Wrench wrench(double k) const noexcept {
    const double weighted = ratio * k;
    return {-weighted * shift, -(weighted * lever_m * lever_m) * rotation};
  }
  /// -d(wrench)/d(hand's pose) [N/m, N, Nm/rad]; at most k (k lever^2 for rotations).
  Mat6 stiffness(double k) const noexcept;
};

/// State: the tool's pose, the objects' poses, and lists that are a cache. All memory is taken at
/// construction; `frame` and `reset` neither allocate nor throw nor lock. One thread at a time. The
/// same frames give bit-identical results. Body and objects must outlive it.
class VirtualTool {
 public:
  /// Throws std::invalid_argument without objects, or for options that are not finite.
  VirtualTool(const ToolBody& tool, std::span<const ObjectBody* const> objects,
              const VirtualToolOptions& options);

  /// One frame; `objects` are the objects' poses in W, in the order of construction.
  ///
  /// An invalid pose gives no force and leaves the tool unchanged. Without a tool (at first, after
  /// `reset`) there is no force until the hand is in the open, and all lists are whole, which may
  /// take several frames; then the force comes in over `fade_s`.
  VirtualToolFrame frame(const HandSample& hand, std::span<const Pose> objects) noexcept;

  /// What each owner pushes the tool with in the last `frame`, over k: force [m], torque [m^2];
  /// the owners of the first object, then those of the next. Times k they sum to the wrench where
  /// the tool has come to its place. Times k and an object's velocity: its power.
  std::span<const Wrench> contact_forces() const noexcept { return forces_; }

  /// Forgets the tool: a new session, the clutch, a jump of the device.
  void reset() noexcept;
  /// The hand may be anywhere: from the next frame on the tool starts where the hand is. Where that
  /// is no start, the tool goes on from where it is. Meanwhile, which may take several frames,
  /// there is no tool; then the force comes in over `fade_s`.
  void relocate() noexcept;
  /// From the next frame on starts from `tool`, and then with the whole force; where the hand is if
  /// that is no start.
  void start_at(const Pose& tool) noexcept;
  /// The same in one call, however much work it is. False, and no tool, where that is no start.
  bool place(const Pose& tool, std::span<const Pose> objects) noexcept;

  bool placed() const noexcept { return placed_; }
  const Pose& pose() const noexcept { return contacts_.tool(); }
  const VirtualToolOptions& options() const noexcept { return options_; }
  /// Memory that it takes [bytes], lists and rows.
  std::size_t bytes() const noexcept { return contacts_.bytes(); }

 private:
  /// What limits the steps of a query.
  struct Query {
    Pose hand;
    double friction = 0.0;
    double lists_m = 0.0;      ///< largest step that the lists cover
    double rows_m = 0.0;       ///< no pair within it is left out of the rows
    double reach_m = 0.0;      ///< of `lists_m`, what the objects' displacement leaves for the tool
    double remaining_m = 0.0;  ///< of the frame, where something is touched
    double rest_m = 0.0;       ///< a shorter step ends the frame
    double objects_ratio =
        1.0;  ///< of the objects' displacement that is left, which they make in this step
    bool more_rows = false;  ///< a step would come to what is farther than the rows
  };

  /// Where the tool starts, while there is none.
  struct Start {
    Pose pose = {};      ///< if `given`; else where the hand is
    Pose before = {};    ///< if `returns`: where the tool goes on if it is no start
    bool begun = false;  ///< and its check goes on
    bool given = false, returns = false;
    bool whole_force = false;  ///< without a fade
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
  Projection solve_with(const Vec6& target, double turn_rad, bool push_out, VirtualToolFrame& out,
                        Work& work) noexcept;
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
  Projection last_;                ///< at `tool_`, of the last query
  Mat6 loose_ = Mat6::Identity();  ///< likewise: what friction does not hold
  Pose hand_;
  Vec3 rotation_ = Vec3::Zero();  ///< of the last frame: near half a turn its axis stays
  double longest_step_m_ = 0.0;   ///< of the last frame
  double closing_m_ = 0.0;        ///< by so much a row's gap closed at most, in a step of a frame
  double damping_ = 1.0;          ///< of steps while the hand rests
  double last_residual_m_ = 0.0, last_step_m_ = 0.0;  ///< of the last query; step 0: there was none
  int all_rows_frames_ = 0;  ///< so many frames more look at all rows that a step may come to
  double placed_s_ = 0.0;
  Start start_;
  bool placed_ = false;
  bool converged_ = false;  ///< the last query asked for no further step
  bool pressed_ = false;    ///< the last frame gave a force
};

}  // namespace voxtouch::exact
