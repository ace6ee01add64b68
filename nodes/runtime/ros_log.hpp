#pragma once
/// What a node says, for ROS tools: /rosout.
#include <cstdint>
#include <string>

#include "nodes/bus/writer.hpp"
#include "nodes/console/rate_limiter.hpp"
#include "nodes/runtime/node_registry.hpp"

namespace voxtouch::runtime {

/// Not for the loop.
class RosLog {
 public:
  static constexpr int kMaxPerSecond = 10;
  RosLog(const bus::Participant& participant, const std::string& node, const std::string& rig);
  /// One line, while there is a reader. Of more than ten in a second the first ten; the next line
  /// says how many were left out.
  void say(NodeState state, const std::string& sentence);
  /// A reader has come since the last call: it knows nothing yet.
  bool reader_came() noexcept;
  /// Lines written.
  std::uint64_t written() const noexcept { return written_; }

 private:
  bus::Writer<msg::rcl_interfaces_Log> lines_;
  std::string name_;  ///< of the logger, as rclcpp calls a node's: "haptic.device"
  console::RateLimiter few_{kMaxPerSecond};
  std::uint32_t readers_ = 0;
  std::uint64_t written_ = 0;
};

}  // namespace voxtouch::runtime
