#pragma once
/// Where one object pushes on the tool, for the effects that act there, and what those remember of
/// each object.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/contact/contact_model.hpp"
#include "core/effects/effect.hpp"
#include "core/types/smoothstep.hpp"

namespace voxtouch::effects {

/// The contact force of one object, W axes. Its direction is the force's, not the mean normal,
/// which steps with every point that enters or leaves.
struct TouchPoint {
  double push_n = 0.0;         ///< |F| > 0
  Vec3 normal = Vec3::Zero();  ///< F / |F|: the way the object pushes the tool
  /// From the tool's origin to the foot of its perpendicular on the wrench's axis, (F x torque) /
  /// F^2: the force-weighted mean of the points that push, seen along the normal. Shortened to the
  /// reach.
  Vec3 contact_centre = Vec3::Zero();
  double height_m = 0.0;  ///< along the normal from the foot to the deepest point
};

/// Pushes below this count as none: their direction is rounding.
inline constexpr double kMinPushN = 1e-9;

/// False without contact. Real-time safe.
inline bool find_touch(const ObjectContact& touch, const Vec3& tool_origin, double reach_m,
                       TouchPoint& point) noexcept {
  if (touch.contact == nullptr)
    return false;
  const Wrench& wrench = touch.contact->wrench;
  point.push_n = wrench.force.norm();
  if (!(point.push_n > kMinPushN))
    return false;
  point.normal = wrench.force / point.push_n;
  point.contact_centre = point.normal.cross(wrench.torque) / point.push_n;
  if (const double length = point.contact_centre.norm(); length > reach_m)
    point.contact_centre *= reach_m / length;
  const double height = point.normal.dot(touch.contact->deepest_point - tool_origin);
  point.height_m = std::clamp(height, -reach_m, reach_m);
  return true;
}

/// The row of an effect that acts at touched points.
inline constexpr EffectParameter kReachParameter = row::number(
    "reach_m", 0.0, 1.0, 0.1, "Largest lever of a contact about the tool's origin [m].");

/// Where several objects touch, effects that grow with an object's push up to `full_n` [N], by a
/// smoothstep, share: together they act as one at most. What each has of its own. Real-time safe.
inline double weight_of_each(const EffectFrame& frame, double full_n) noexcept {
  double sum = 0.0;
  for (const ObjectContact& touch : frame.contacts)
    if (touch.contact != nullptr)
      sum += smoothstep(0.0, full_n, touch.contact->wrench.force.norm());
  return 1.0 / std::max(1.0, sum);
}
inline constexpr double kSteepestStep = 1.5;  ///< largest slope of a smoothstep from 0 to 1

/// No hand moves a tool faster; beyond it what damps grows thinner, so that its force has a bound.
inline constexpr double kFastestMPerS = 2.0;
/// `v` [m/s], shortened to that speed. Real-time safe.
inline Vec3 within_hand_speed(const Vec3& v) noexcept {
  const double speed = v.stableNorm();
  return speed > kFastestMPerS ? Vec3(v * (kFastestMPerS / speed)) : v;
}

/// Displacement v of the tool's origin and turn w, as seen at `arm` from it: J = [1, -[arm]x].
/// Gives J' M J, M a stiffness or damping against translation there. Symmetric, positive
/// semidefinite if M is.
inline Mat6 seen_from_origin(const Mat3& there, const Vec3& arm) noexcept {
  const Mat3 cross = cross_matrix(arm);
  Mat6 out;
  out.topLeftCorner<3, 3>() = there;
  out.topRightCorner<3, 3>() = -there * cross;
  out.bottomLeftCorner<3, 3>() = out.topRightCorner<3, 3>().transpose();
  out.bottomRightCorner<3, 3>() = -cross * there * cross;
  return out;
}

/// The tool's path since the last sample. None at the first.
class ToolDisplacement {
 public:
  /// Real-time safe.
  void advance(const Pose& tool) noexcept {
    const Quat turned = tool.orientation.normalized();
    shift_ = known_ ? Vec3(tool.position - last_.position) : Vec3::Zero();
    back_ = known_ ? last_.orientation * turned.conjugate() : Quat::Identity();
    last_ = {tool.position, turned};
    known_ = true;
  }
  /// The next pose is the first. Real-time safe.
  void forget() noexcept { known_ = false; }

  /// Displacement [m] of the tool's own point that is now at `arm` from the tool's origin. Exactly
  /// zero for a tool that rests.
  Vec3 of_point(const Vec3& arm) const noexcept { return shift_ + (arm - back_ * arm); }
  /// At least the path of any of its points within `reach_m`.
  double most(double reach_m) const noexcept {
    return shift_.norm() + 2.0 * reach_m * back_.vec().norm();
  }

 private:
  Pose last_;
  Vec3 shift_ = Vec3::Zero();
  Quat back_ = Quat::Identity();  ///< from the present to the last orientation
  bool known_ = false;
};

/// Height of the touched point over the foot. The deepest point, and so its height, may jump
/// between samples; this follows it by no more than the tool moved, so that a torque across it has
/// no step and a tool that rests none at all.
class FollowedHeight {
 public:
  /// `height_m` of this sample, as far as `moved_m`, the tool's path since the last one, lets it
  /// follow [m]. Real-time safe.
  double follow(double height_m, double moved_m) noexcept {
    height_ = known_ ? std::clamp(height_m, height_ - moved_m, height_ + moved_m) : height_m;
    known_ = true;
    return height_;
  }

 private:
  double height_ = 0.0;
  bool known_ = false;
};

/// The touched point itself, from the tool's origin; shortened to the reach.
inline Vec3 arm_to(const TouchPoint& point, double height_m, double reach_m) noexcept {
  const Vec3 arm = point.contact_centre + height_m * point.normal;
  const double length = arm.norm();
  return length > reach_m ? Vec3(arm * (reach_m / length)) : arm;
}

/// A `State` for each object that is being touched, by the object's number, for kMaxTouches of them
/// at once: what is touched beyond that gets none. Fixed storage: never allocates.
template <typename State>
class PerObject {
 public:
  static constexpr std::size_t kMaxTouches = 16;

  /// A new sample: nothing has been asked for yet. Real-time safe.
  void begin() noexcept {
    for (Slot& slot : slots_)
      slot.seen = false;
  }
  /// Null where there is no room, or where the object was asked for in this sample already.
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
  /// Forgets what was not asked for since `begin`.
  void end() noexcept {
    for (Slot& slot : slots_)
      slot.used = slot.used && slot.seen;
  }
  /// Forgets all objects. Real-time safe.
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
