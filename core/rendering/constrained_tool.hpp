#pragma once
/// The virtual tool in a scene: against all objects where they are, with the spring that the
/// coupling is certified for.
#include <memory>
#include <span>
#include <vector>

#include "core/coupling/ramp.hpp"
#include "core/rendering/object_contacts.hpp"
#include "core/rendering/tool_solver.hpp"

namespace voxtouch::rendering {

class ExactBodies;

/// What a frame of a virtual tool reports in addition to its contact.
struct ToolFrame {
  bool constrained = false;      ///< something holds it off the hand's pose
  bool not_converged = false;    ///< it has not come to its place within the frame, or an object
                                 ///< moved so far that it may have passed it
  bool not_initialised = false;  ///< it has none: the hand has not been outside yet, or is where
                                 ///< nothing can be looked up; or no spring is known yet to pull it
  double residual_m = 0.0;       ///< path that its last step would still have gone
  std::uint32_t queries = 0, iterations = 0;  ///< of all steps
};

/// Faster than this [m/s] in W no hand goes: the pose has jumped (ConstrainedTool::lose_hand).
inline constexpr double kJumpMPerS = 20.0;

/// One thread at a time. The objects must outlive it.
class ConstrainedTool {
 public:
  /// Over this time the spring goes from one stiffness to the next [s].
  static constexpr double kSpringRampS = 0.2;

  /// `lever_m` 0: the tool's reach. With `bodies` against triangles; without, against voxels: then
  /// every object must have its field. They must outlive it.
  ConstrainedTool(ObjectContacts& objects, double lever_m, const ExactBodies* bodies = nullptr);

  /// The stiffness of the spring [N/m] in W from the next frames on, on a straight line over
  /// kSpringRampS; at once after `reset`. One that is no number, or below zero, is 0. Real-time
  /// safe.
  void set_target(double spring_n_per_m) noexcept;

  /// One frame: the spring's wrench on the hand, stiffness and what is touched, as a contact.
  /// `contact.stiffness_bound_n_per_m` is the spring's own. Real-time safe.
  contact::ContactResult render(const Pose& hand, double time_s, double dt_s, double friction,
                                ToolFrame& out) noexcept;

  /// Of the last `render`: the virtual tool, and its motion since the one before.
  const Pose& pose() const noexcept { return frame_.tool; }
  bool placed() const noexcept { return solver_->placed(); }
  const Twist& twist() const noexcept { return twist_; }
  /// The object that it leans on, as StaticObject::id.
  std::uint32_t leans_on() const noexcept { return parts_[frame_.contact_object].object; }
  /// Each object's part; points into this.
  std::span<const effects::ObjectContact> parts() const noexcept { return parts_; }
  /// Power of moving objects [W], and what a spring that became stiffer gave the hand [J].
  double power_w() const noexcept { return power_w_; }
  double stiffened_j() const noexcept { return stiffened_j_; }

  /// Starts from `tool`, the virtual tool of a scene that this one takes the place of, where that
  /// is free here. Real-time safe.
  void start_from(const Pose& tool, double time_s) noexcept;
  /// The hand may be anywhere in the next frame: where that is free the tool is placed there; else
  /// it stays where it is. The force fades in over kSpringRampS. Real-time safe.
  void lose_hand() noexcept { hand_lost_ = solver_->placed(); }
  /// There is no virtual tool any more, until the hand is outside. Real-time safe.
  void reset() noexcept;

 private:
  void put_objects(double time_s) noexcept;
  void give_parts(double displayed_n_per_m) noexcept;
  double depth_of_spring2() const noexcept;
  void find_hand(const Pose& hand) noexcept;

  ObjectContacts& objects_;
  std::unique_ptr<ToolSolver> solver_;
  std::vector<Vec3> displacements_;  ///< of each object
  contact::VirtualToolFrame frame_;
  coupling::Ramp spring_;
  double target_n_per_m_ = 0.0,
         displayed_n_per_m_ =
             0.0;           ///< displayed: with the fade that a tool that was placed begins with
  bool fresh_ = true;       ///< no frame since `reset`
  bool hand_lost_ = false;  ///< `lose_hand` since the last frame
  Pose hand_;
  Twist twist_;
  std::vector<contact::ContactResult> results_;
  std::vector<effects::ObjectContact> parts_;
  double power_w_ = 0.0, stiffened_j_ = 0.0;
};

}  // namespace voxtouch::rendering
