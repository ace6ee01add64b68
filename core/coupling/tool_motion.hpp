#pragma once
/// How the tool has moved since the last sample, and how fast, out of poses alone.
#include <array>
#include <cstdint>

#include "core/coupling/velocity_window.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::coupling {

/// Faster than this, in W, no hand moves a tool: the pose has jumped. Multiply by the device's
/// position scale.
struct ToolSpeedLimits {
  double linear_m_per_s = 10.0;
  double angular_rad_per_s = 100.0;
};

/// The displacement from one pose to the next.
struct ToolStep {
  bool known =
      false;  ///< false: first pose, bad pose, jump or gap; the displacements are zero then
  Vec3 shift = Vec3::Zero();  ///< of the tool's origin [m], W axes
  Vec3 turn = Vec3::Zero();   ///< rotation vector [rad], the shorter way round, W axes
};

/// Differences and the velocity that damping acts on. Real-time safe.
///
///     v^[n] = a v^[n-1] + (1 - a) (x[n] - x[n-1]) / dt,   a = exp(-w_v dt),
///
/// a convex mean of difference quotients, so never larger than the largest of them. dt as measured,
/// up to the gap; below the input policy's band, or no number: the nominal period. (Above the band
/// a law must not trust dt, since its state would grow with it. Here a longer dt is the smaller
/// velocity.) A sample without a usable pose leaves v^ as it is and its time counts towards the
/// next; after a gap, and after a jump, v^ begins again at zero.
///
/// With a window v^ is the formula of velocity_window.hpp for periods as measured, u and w each a
/// displacement over its time. The displacement of a longer time than a period, of samples that
/// were lost, counts as that many differences. Until the window is full v^ is u, as if the tool had
/// rested before the first.
///
/// With a band the linear part of the velocity is v^ + clamp(u^ - v^, +- band), each axis by
/// itself, u^ of a first-order filter of its own: an encoder's step is smoothed as u^ smooths it,
/// and what moves by more than the band is as late as v^. Off v^ by no more than the band, so
/// whatever is bounded on v^ is bounded on it.
class ToolMotion {
 public:
  /// `nominal_s`: the sample time [s]; `limits`: a pose that would need a faster tool is a jump.
  /// `velocity_window`: n, 0 to kMaxVelocityWindow; 0: the first-order filter with that cut-off.
  ToolMotion(double nominal_s, double velocity_filter_hz, const ToolSpeedLimits& limits,
             int velocity_window = 0) noexcept;

  /// The displacement to `tool` (T in W) and the velocity there, `dt_s` [s] after the last sample.
  /// Valid until the next call.
  const ToolStep& step(const Pose& tool, double dt_s) noexcept;
  /// Another cut-off of v^ [Hz] or another window, from the next sample on.
  void set_filter(double velocity_filter_hz, int velocity_window = 0) noexcept;
  /// Another cut-off of u^ [Hz] and another band [m/s], 0 either: none; from the next sample on.
  void set_slow(double slow_velocity_hz, double band_m_per_s) noexcept;
  /// The next pose is the first: no way leads to it, and v^ begins at zero.
  void forget() noexcept;
  /// v^, within a band of it u^; W axes.
  const Twist& velocity() const noexcept { return velocity_; }
  std::uint64_t jumps() const noexcept { return jumps_; }

 private:
  struct Displacement {
    Twist displacement;  ///< [m, rad]
    double time_s;
  };

  void move_to(const Vec3& position, const Quat& orientation) noexcept;
  void remember(const Vec3& shift, const Vec3& turn) noexcept;
  void forget_velocity() noexcept;
  Twist quotient(int from, int count) const noexcept;
  Twist velocity_of_window() const noexcept;
  void estimate_velocity(const Vec3& shift, const Vec3& turn) noexcept;

  double nominal_s_, cutoff_rad_per_s_ = 0.0, slow_rad_per_s_ = 0.0, band_m_per_s_ = 0.0,
                     elapsed_s_ = 0.0;
  int window_ = 0;
  ToolSpeedLimits limits_;
  bool anchored_ = false;
  Pose last_;
  ToolStep step_;
  Twist fast_, velocity_;  ///< v^, and what is reported
  Vec3 slow_;              ///< u^; v^ where there is none
  std::array<Displacement, window_span(kMaxVelocityWindow)>
      displacements_;  ///< the last ones, a ring; for any window, so that another may be set
  int newest_ = 0, known_ = 0;
  std::uint64_t jumps_ = 0;
};

}  // namespace voxtouch::coupling
