#pragma once
/// Publishes the log messages of a node on /rosout.
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
  /// Writes one line while there is a reader. Only the first ten lines of a second are written; the
  /// next line reports how many were dropped.
  void write(NodeState state, const std::string& sentence);
  /// Whether a reader has appeared since the last call. It has received no line.
  bool reader_came() noexcept;
  /// Number of lines written.
  std::uint64_t written() const noexcept { return written_; }

 private:
  bus::Writer<msg::rcl_interfaces_Log> lines_;
  std::string name_;  ///< name of the logger, in the form of rclcpp: "haptic.device"
  console::RateLimiter limiter_{kMaxPerSecond};
  std::uint32_t readers_ = 0;
  std::uint64_t written_ = 0;
};

}  // namespace voxtouch::runtime
