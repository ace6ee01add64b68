#pragma once
/// Position and force of one object's contact, for effects that act there, and their state for each
/// object.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/contact/contact_model.hpp"
#include "core/effects/effect.hpp"
#include "core/types/smoothstep.hpp"

namespace voxtouch::effects {

/// The contact force of one object, W axes. Its direction is that of the force and not the mean
/// normal, which jumps with every point that enters or leaves.
struct TouchPoint {
  double force_n = 0.0;        ///< |F| > 0
  Vec3 normal = Vec3::Zero();  ///< F / |F|: direction of the object's force on the tool
  /// Contact centre, from the tool's origin: the nearest point of the wrench's axis, (F x torque) /
  /// F^2. It is the force-weighted mean of the contact points as seen along the normal, shortened
  /// to the reach.
  Vec3 contact_centre = Vec3::Zero();
  double height_m = 0.0;  ///< along the normal from the contact centre to the deepest point
};

/// Smaller contact forces count as zero: their direction is rounding error.
inline constexpr double kMinForceN = 1e-9;

/// Returns false without contact. Real-time safe.
inline bool find_touch(const ObjectContact& touch, const Vec3& tool_origin, double reach_m,
                       TouchPoint& point) noexcept {
  if (touch.contact == nullptr)
    return false;
  const Wrench& wrench = touch.contact->wrench;
  point.force_n = wrench.force.norm();
  if (!(point.force_n > kMinForceN))
    return false;
  point.normal = wrench.force / point.force_n;
  point.contact_centre = point.normal.cross(wrench.torque) / point.force_n;
  if (const double length = point.contact_centre.norm(); length > reach_m)
    point.contact_centre *= reach_m / length;
  const double height = point.normal.dot(touch.contact->deepest_point - tool_origin);
  point.height_m = std::clamp(height, -reach_m, reach_m);
  return true;
}

/// Table row of an effect that acts at contact points.
inline constexpr EffectParameter kReachParameter = row::number(
    "reach_m", 0.0, 1.0, 0.1, "Largest lever of a contact about the tool's origin [m].");

/// Weight of each object if several touch. Effects that grow with the contact force up to `full_n`
/// [N], by a smoothstep, are divided by it, so that together they act as at most one. Real-time
/// safe.
inline double weight_of_each(const EffectFrame& frame, double full_n) noexcept {
  double sum = 0.0;
  for (const ObjectContact& touch : frame.contacts)
    if (touch.contact != nullptr)
      sum += smoothstep(0.0, full_n, touch.contact->wrench.force.norm());
  return 1.0 / std::max(1.0, sum);
}
inline constexpr double kSteepestStep = 1.5;  ///< largest slope of a smoothstep from 0 to 1

/// No operator moves a tool faster; beyond this speed damping decreases, so that its force is
/// bounded.
inline constexpr double kFastestMPerS = 2.0;
/// `v` [m/s], shortened to that speed. Real-time safe.
inline Vec3 within_hand_speed(const Vec3& v) noexcept {
  const double speed = v.stableNorm();
  return speed > kFastestMPerS ? Vec3(v * (kFastestMPerS / speed)) : v;
}

/// For displacement v of the tool's origin and rotation w, the displacement at `arm` is J = [1,
/// -[arm]x]. Returns J' M J for a translational stiffness or damping M there. Symmetric, and
/// positive semidefinite if M is.
inline Mat6 seen_from_origin(const Mat3& there, const Vec3& arm) noexcept {
  const Mat3 cross = cross_matrix(arm);
  Mat6 out;
  out.topLeftCorner<3, 3>() = there;
  out.topRightCorner<3, 3>() = -there * cross;
  out.bottomLeftCorner<3, 3>() = out.topRightCorner<3, 3>().transpose();
  out.bottomRightCorner<3, 3>() = -cross * there * cross;
  return out;
}

/// The tool's displacement since the last sample; zero at the first.
class ToolDisplacement {
 public:
  /// Real-time safe.
  void advance(const Pose& tool) noexcept {
    const Quat orientation = tool.orientation.normalized();
    shift_ = known_ ? Vec3(tool.position - last_.position) : Vec3::Zero();
    back_ = known_ ? last_.orientation * orientation.conjugate() : Quat::Identity();
    last_ = {tool.position, orientation};
    known_ = true;
  }
  /// Treats the next pose as the first. Real-time safe.
  void forget() noexcept { known_ = false; }

  /// Displacement [m] of the tool point now at `arm` from the tool's origin. Exactly zero for a
  /// resting tool.
  Vec3 of_point(const Vec3& arm) const noexcept { return shift_ + (arm - back_ * arm); }
  /// Upper bound of the path of any tool point within `reach_m`.
  double most(double reach_m) const noexcept {
    return shift_.norm() + 2.0 * reach_m * back_.vec().norm();
  }

 private:
  Pose last_;
  Vec3 shift_ = Vec3::Zero();
  Quat back_ = Quat::Identity();  ///< from the present to the last orientation
  bool known_ = false;
};

/// Height of the contact point above the contact centre. The deepest point, and so its height, may
/// jump between samples. This value follows it by at most the tool's displacement, so the torque
/// has no step, and none at all for a resting tool.
class FollowedHeight {
 public:
  /// Follows `height_m` of this sample by at most `moved_m`, the tool's path since the last one
  /// [m]. Real-time safe.
  double follow(double height_m, double moved_m) noexcept {
    height_ = known_ ? std::clamp(height_m, height_ - moved_m, height_ + moved_m) : height_m;
    known_ = true;
    return height_;
  }

 private:
  double height_ = 0.0;
  bool known_ = false;
};

/// The contact point, from the tool's origin; shortened to the reach.
inline Vec3 arm_to(const TouchPoint& point, double height_m, double reach_m) noexcept {
  const Vec3 arm = point.contact_centre + height_m * point.normal;
  const double length = arm.norm();
  return length > reach_m ? Vec3(arm * (reach_m / length)) : arm;
}

/// A `State` for each object in contact, by object number, for kMaxTouches at once; further objects
/// get none. Fixed storage: never allocates.
template <typename State>
class PerObject {
 public:
  static constexpr std::size_t kMaxTouches = 16;

  /// Begins a sample. Real-time safe.
  void begin() noexcept {
    for (Slot& slot : slots_)
      slot.seen = false;
  }
  /// Null without room, or if the object was already requested in this sample.
  State* find(std::uint32_t object) noexcept {
    Slot* free = nullptr;
    for (Slot& slot : slots_) {
      if (slot.used && slot.object == object) {
        if (slot.seen)
          return nullptr;
        slot.seen = true;
        return &slot.state;
      }
      if (!slot.used && free == nullptr)
        free = &slot;
    }
    if (free == nullptr)
      return nullptr;
    *free = {State{}, object, true, true};
    return &free->state;
  }
  /// Removes states that were not requested since `begin`.
  void end() noexcept {
    for (Slot& slot : slots_)
      slot.used = slot.used && slot.seen;
  }
  /// Removes all states. Real-time safe.
  void clear() noexcept {
    for (Slot& slot : slots_)
      slot.used = false;
  }

 private:
  struct Slot {
    State state = {};
    std::uint32_t object = 0;
    bool used = false, seen = false;
  };
  std::array<Slot, kMaxTouches> slots_ = {};
};

}  // namespace voxtouch::effects
