#pragma once
/// Before any force: the operator moves each axis, which shows encoder, direction and clear space.
#include <algorithm>
#include <array>
#include <cstddef>

#include "core/types/geometry.hpp"

namespace voxtouch::identification {

/// The device gives no force. The operator moves one axis after the other, first in its positive
/// direction, then back through the start. Real-time safe.
class HandCheck {
 public:
  enum class State : std::uint8_t { kForward, kBackward, kWrongDirection, kPassed };
  explicit HandCheck(double path_m = 0.02) noexcept : path_(path_m) {}

  void sample(const Vec3& position_m) noexcept {
    if (!position_m.allFinite() || axis_ >= 3 || state_ == State::kWrongDirection)
      return;
    if (!started_) {
      started_ = true;
      start_ = position_m;
    }
    const double moved =
        position_m[static_cast<Eigen::Index>(axis_)] - start_[static_cast<Eigen::Index>(axis_)];
    farthest_ = std::max(farthest_, std::abs(moved));
    if (state_ == State::kForward && moved > path_)
      state_ = State::kBackward;
    else if (state_ == State::kForward && moved < -path_)
      state_ = State::kWrongDirection;
    else if (state_ == State::kBackward && moved < -path_)
      next();
  }
  std::size_t axis() const noexcept { return axis_; }
  State state() const noexcept { return axis_ >= 3 ? State::kPassed : state_; }
  double farthest_m() const noexcept { return farthest_; }  ///< of the current axis

 private:
  void next() noexcept {
    ++axis_;
    state_ = State::kForward;
    started_ = false;
    farthest_ = 0.0;
  }
  double path_, farthest_ = 0.0;
  std::size_t axis_ = 0;
  State state_ = State::kForward;
  bool started_ = false;
  Vec3 start_ = Vec3::Zero();
};

}  // namespace voxtouch::identification
