#pragma once
/// Displacement and velocity of the tool, from poses only.
#include <array>
#include <cstdint>

#include "core/coupling/velocity_window.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::coupling {

/// Largest speeds of a tool in the hand of an operator, in W. A faster displacement is a jump of
/// the pose. Multiply them by the device's position scale.
struct ToolSpeedLimits {
  double linear_m_per_s = 10.0;
  double angular_rad_per_s = 100.0;
};

/// The displacement from one pose to the next.
struct ToolStep {
  /// False: first pose, invalid pose, jump or gap; the displacements are then zero.
  bool known = false;
  Vec3 translation = Vec3::Zero();  ///< of the tool's origin [m], W axes
  Vec3 rotation = Vec3::Zero();     ///< rotation vector [rad], the shorter rotation, W axes
};

/// Displacements and the velocity estimate that damping acts on. Real-time safe.
///
///     v^[n] = a v^[n-1] + (1 - a) (x[n] - x[n-1]) / dt,   a = exp(-w_v dt)
///
/// This is a convex mean of difference quotients, so it never exceeds the largest of them. The
/// measured period is used for dt, up to the gap. Below the band of the input policy, or if it is
/// not finite, the nominal period is used. (A law must not use a dt above the band, since its state
/// would grow with it. Here a longer dt only gives a smaller velocity.) A sample without a usable
/// pose keeps v^, and its time adds to the next. After a gap or a jump, v^ restarts at zero.
///
/// With a window, v^ is the formula of velocity_window.hpp for measured periods, with u and w each
/// a displacement over its time. A displacement over several periods, after lost samples, counts as
/// that many differences. While the window is not full, v^ is u: the tool counts as at rest at its
/// first pose.
///
/// With a band, the linear velocity is
///
///     v^ + clamp(u^ - v^, +- band)
///
/// for each axis, with u^ from a slower first-order filter. Encoder steps are smoothed as by u^,
/// and motions larger than the band are as late as v^. It deviates from v^ by at most the band, so
/// bounds that hold for v^ hold for it.
class ToolMotion {
 public:
  /// `nominal_s`: sample time [s]. `limits`: a pose that needs a faster tool is a jump.
  /// `velocity_window`: n, 0 to kMaxVelocityWindow; 0 selects the first-order filter with that
  /// cut-off [Hz].
  ToolMotion(double nominal_s, double velocity_filter_hz, const ToolSpeedLimits& limits,
             int velocity_window = 0) noexcept;

  /// The displacement to `tool` (T in W) and the velocity there, `dt_s` [s] after the last sample.
  /// Valid until the next call.
  const ToolStep& step(const Pose& tool, double dt_s) noexcept;
  /// Sets the cut-off of v^ [Hz] or the window, from the next sample on.
  void set_filter(double velocity_filter_hz, int velocity_window = 0) noexcept;
  /// Sets the cut-off of u^ [Hz] and the band [m/s], from the next sample on. A value of 0 disables
  /// it.
  void set_slow(double slow_velocity_hz, double band_m_per_s) noexcept;
  /// Treats the next pose as the first: no displacement leads to it, and v^ starts at zero.
  void clear() noexcept;
  /// v^ with the band applied, W axes.
  const Twist& velocity() const noexcept { return velocity_; }
  std::uint64_t jumps() const noexcept { return jumps_; }

 private:
  struct Displacement {
    Twist displacement;  ///< [m, rad]
    double time_s;
  };

  void move_to(const Vec3& position, const Quat& orientation) noexcept;
  void remember(const Vec3& shift, const Vec3& rotation) noexcept;
  void forget_velocity() noexcept;
  Twist quotient(int from, int count) const noexcept;
  Twist velocity_of_window() const noexcept;
  void estimate_velocity(const Vec3& shift, const Vec3& rotation) noexcept;

  double nominal_s_, cutoff_rad_per_s_ = 0.0, slow_rad_per_s_ = 0.0, band_m_per_s_ = 0.0,
                     elapsed_s_ = 0.0;
  int window_ = 0;
  ToolSpeedLimits limits_;
  bool anchored_ = false;
  Pose last_;
  ToolStep step_;
  Twist fast_, velocity_;  ///< v^, and the returned velocity
  Vec3 slow_;              ///< u^; v^ without a band
  std::array<Displacement, window_span(kMaxVelocityWindow)>
      displacements_;  ///< ring buffer, long enough for any window
  int newest_ = 0, known_ = 0;
  std::uint64_t jumps_ = 0;
};

}  // namespace voxtouch::coupling
