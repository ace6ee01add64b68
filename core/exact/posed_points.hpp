#pragma once
/// The tool's points in an object's frame, each computed at most once per pose.
#include <cstdint>
#include <span>
#include <vector>

#include "core/types/geometry.hpp"

namespace voxtouch::exact {

/// `points` must outlive it. `pose` and `at` are real-time safe.
class PosedPoints {
 public:
  explicit PosedPoints(std::span<const Vec3> points)
      : points_(points),
        posed_(points.size()),
        when_(points.size(), 0) {}

  void set_pose(const Pose& pose) noexcept {
    pose_ = pose;
    rotation_ = pose.orientation.toRotationMatrix();
    ++now_;
  }
  const Pose& pose() const noexcept { return pose_; }
  std::size_t bytes() const noexcept {
    return posed_.size() * sizeof(Vec3) + when_.size() * sizeof(std::uint64_t);
  }
  const Mat3& rotation() const noexcept { return rotation_; }

  const Vec3& at(std::uint32_t point) noexcept {
    if (when_[point] != now_) {
      posed_[point] = rotation_ * points_[point] + pose_.position;
      when_[point] = now_;
    }
    return posed_[point];
  }
  /// A point of the object in the tool's frame.
  Vec3 to_tool(const Vec3& point) const noexcept {
    return rotation_.transpose() * (point - pose_.position);
  }

 private:
  std::span<const Vec3> points_;
  std::vector<Vec3> posed_;
  std::vector<std::uint64_t> when_;
  std::uint64_t now_ = 0;
  Pose pose_;
  Mat3 rotation_ = Mat3::Identity();
};

}  // namespace voxtouch::exact
