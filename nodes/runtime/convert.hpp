#pragma once
/// Copies fields between messages and core values without computation. Real-time safe.
#include <cstdint>

#include "core/types/geometry.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::runtime {

inline Vec3 from_msg(const msg::geometry_msgs_Vector3& v) noexcept { return {v.x, v.y, v.z}; }
inline Vec3 from_msg(const msg::geometry_msgs_Point& v) noexcept { return {v.x, v.y, v.z}; }
inline Pose from_msg(const msg::geometry_msgs_Pose& p) noexcept {
  return {from_msg(p.position),
          Quat(p.orientation.w, p.orientation.x, p.orientation.y, p.orientation.z)};
}
inline Twist from_msg(const msg::geometry_msgs_Twist& t) noexcept {
  return {from_msg(t.linear), from_msg(t.angular)};
}
inline Wrench from_msg(const msg::geometry_msgs_Wrench& w) noexcept {
  return {from_msg(w.force), from_msg(w.torque)};
}

/// `ns` >= 0, since 1970.
inline msg::builtin_interfaces_Time to_time(std::int64_t ns) noexcept {
  return {static_cast<std::int32_t>(ns / 1'000'000'000),
          static_cast<std::uint32_t>(ns % 1'000'000'000)};
}
inline msg::geometry_msgs_Vector3 to_vector(const Vec3& v) noexcept {
  return {v.x(), v.y(), v.z()};
}
inline msg::geometry_msgs_Point to_point(const Vec3& v) noexcept { return {v.x(), v.y(), v.z()}; }
inline msg::geometry_msgs_Pose to_msg(const Pose& p) noexcept {
  return {to_point(p.position),
          {p.orientation.x(), p.orientation.y(), p.orientation.z(), p.orientation.w()}};
}
inline msg::geometry_msgs_Twist to_msg(const Twist& t) noexcept {
  return {to_vector(t.linear), to_vector(t.angular)};
}
inline msg::geometry_msgs_Wrench to_msg(const Wrench& w) noexcept {
  return {to_vector(w.force), to_vector(w.torque)};
}

/// A symmetric matrix as the 21 numbers of its upper triangle, row by row. The lower triangle is
/// ignored.
inline void to_msg(const Mat6& symmetric, double (&upper)[21]) noexcept {
  std::size_t n = 0;
  for (Eigen::Index row = 0; row < 6; ++row)
    for (Eigen::Index column = row; column < 6; ++column)
      upper[n++] = symmetric(row, column);
}
inline Mat6 from_msg(const double (&upper)[21]) noexcept {
  Mat6 symmetric;
  std::size_t n = 0;
  for (Eigen::Index row = 0; row < 6; ++row)
    for (Eigen::Index column = row; column < 6; ++column)
      symmetric(row, column) = symmetric(column, row) = upper[n++];
  return symmetric;
}

}  // namespace voxtouch::runtime
