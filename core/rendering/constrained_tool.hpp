#pragma once
/// The virtual tool in a scene: against all objects at their present positions, with the spring
/// that the coupling is certified for.
#include <span>
#include <vector>

#include "core/coupling/ramp.hpp"
#include "core/rendering/exact_tool.hpp"
#include "core/rendering/object_contacts.hpp"

namespace voxtouch::rendering {

/// Results of a virtual tool's frame in addition to its contact.
struct ToolFrame {
  bool constrained = false;  ///< an object holds it off the hand's pose
  /// It has not reached equilibrium within the frame, or an object moved so far that it may have
  /// passed it.
  bool not_converged = false;
  /// There is no tool: the hand has not been outside or its pose is invalid; or there is no spring
  /// yet.
  bool not_initialised = false;
  double residual_m = 0.0;  ///< remaining path of its last step
  std::uint32_t queries = 0;
  std::uint64_t work = 0;      ///< in units of exact::Work
  bool at_work_limit = false;  ///< the limit of work ended the frame
};

/// No hand moves faster than this in W [m/s]: the pose has jumped (ConstrainedTool::expect_jump).
inline constexpr double kJumpMPerS = 20.0;

/// The virtual tool of a scene. One thread at a time. The objects must outlive it.
class ConstrainedTool {
 public:
  /// Duration of a change of the spring's stiffness [s].
  static constexpr double kSpringRampS = 0.2;

  /// `lever_m`: above 0. The objects and bodies must outlive it.
  ConstrainedTool(ObjectContacts& objects, const ExactBodies& bodies, double lever_m);

  /// Sets the stiffness of the spring [N/m] in W. It ramps linearly over kSpringRampS; after
  /// `reset` it changes at once. NaN, infinity and negative values count as 0. Real-time safe.
  void set_target(double spring_n_per_m) noexcept;

  /// Computes one frame: wrench of the spring on the hand, stiffness and hits, as a contact.
  /// `contact.stiffness_bound_n_per_m` is that of the spring. Real-time safe.
  contact::ContactResult render(const Pose& hand, double time_s, double dt_s, double friction,
                                ToolFrame& out) noexcept;

  /// The virtual tool of the last `render`, and its motion since the previous one.
  const Pose& pose() const noexcept { return frame_.tool; }
  bool placed() const noexcept { return tool_.placed(); }
  const Twist& twist() const noexcept { return twist_; }
  /// The object that supports it, as StaticObject::id.
  std::uint32_t contact_object() const noexcept { return parts_[frame_.contact_owner].object; }
  /// The part of each object; refers to this object.
  std::span<const effects::ObjectContact> parts() const noexcept { return parts_; }
  /// Power of moving objects [W], and energy that an increase of the spring's stiffness gave the
  /// operator [J].
  double power_w() const noexcept { return power_w_; }
  double stiffened_j() const noexcept { return stiffened_j_; }

  /// Starts from `tool`, the virtual tool of the scene that this one replaces, if that pose is free
  /// here. Real-time safe.
  void start_from(const Pose& tool, double time_s) noexcept;
  /// The hand may be anywhere in the next frame. If it is in free space the tool is placed there,
  /// otherwise the tool stays in place. The force fades in over kSpringRampS. Real-time safe.
  void expect_jump() noexcept { jump_expected_ = tool_.placed(); }
  /// Removes the virtual tool until the hand is outside. Real-time safe.
  void reset() noexcept;

 private:
  void put_objects(double time_s) noexcept;
  void set_parts(double displayed_n_per_m) noexcept;
  double depth_of_spring2() const noexcept;
  void find_hand() noexcept;

  ObjectContacts& objects_;
  ExactTool tool_;
  std::vector<Vec3> displacements_;  ///< of each object
  exact::VirtualToolFrame frame_;
  coupling::Ramp spring_;
  double target_n_per_m_ = 0.0,
         displayed_n_per_m_ =
             0.0;               ///< displayed value, including the fade-in of a newly placed tool
  bool fresh_ = true;           ///< no frame since `reset`
  bool jump_expected_ = false;  ///< `expect_jump` was called since the last frame
  Pose hand_;
  Twist twist_;
  std::vector<contact::ContactResult> results_;
  std::vector<effects::ObjectContact> parts_;
  double power_w_ = 0.0, stiffened_j_ = 0.0;
};

}  // namespace voxtouch::rendering
