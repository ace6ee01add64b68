#pragma once
/// The six parameter services of every ROS node, for a node's parameters.
#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "nodes/bus/service_server.hpp"
#include "nodes/bus/wait_set.hpp"
#include "nodes/console/rate_limiter.hpp"
#include "nodes/runtime/ros_parameters.hpp"

namespace voxtouch::runtime {

/// Result of one of several settings; `which` is its index.
using SettingReply = std::function<void(std::size_t which, bool done, const std::string& sentence)>;

/// Callbacks of the services. Both are called from the thread that calls `serve`.
struct ParameterHandler {
  std::function<std::vector<RosParameter>()> parameters;  ///< current settings, sorted by name
  /// Sets parameters for the participant `by`, one at a time, or `together` all or none. `reply` is
  /// called once for each, immediately or later. Null: every parameter is read-only.
  std::function<void(std::span<const msg::rcl_interfaces_Parameter> requested, bool together,
                     const bus::Guid& by, SettingReply reply)>
      set;
};

/// Limits the number of requests per second. One thread; `refused` is for any thread.
class RequestLimit {
 public:
  explicit RequestLimit(int per_second) : admitted_(per_second) {}
  /// Whether `count` more requests fit into this second. The part that fits is counted.
  bool admits(std::uint32_t count);
  std::uint64_t refused() const noexcept { return refused_.load(std::memory_order_relaxed); }

 private:
  console::RateLimiter admitted_;
  std::atomic<std::uint64_t> refused_{0};
};

/// Serves the parameters of a node to ROS clients.
/// Every node has the parameter `use_sim_time`: whether it runs in lockstep. A read-only parameter
/// may be set to its current value, so that `ros2 param load` accepts a dump of the node. Requests
/// beyond request_limits.hpp or the rate limit are not answered. One thread of ordinary priority.
class ParameterServices {
 public:
  ParameterServices(const bus::Participant& participant, const std::string& rig,
                    const std::string& node, bool lockstep, ParameterHandler handler,
                    RequestLimit& limit);
  void attach_to(bus::WaitSet& wait_set);
  /// Answers received requests and sends deferred replies. Does not block.
  void serve();
  /// Whether replies are waiting for their client's reader. If so, call `serve` again soon.
  bool waits() const noexcept;
  /// All parameters, including `use_sim_time`.
  std::vector<RosParameter> parameters() const;

 private:
  template <class S>
  using Server = bus::ServiceServer<S>;
  template <class S, class F>
  void each(Server<S>& server, F&& f);
  void serve_named();
  /// An unknown name gives a value of type "not set", which ROS tools print as such.
  template <class Names>
  std::vector<RosParameter> named(const Names& names) const;
  /// Calls handler_.set for settings that may change a value; `reply` receives all results.
  void set(std::span<const msg::rcl_interfaces_Parameter> requested, bool together,
           const bus::Guid& by, const SettingReply& reply);

  bool lockstep_;
  ParameterHandler handler_;
  RequestLimit& limit_;
  Server<msg::rcl_interfaces_ListParameters> list_;
  Server<msg::rcl_interfaces_GetParameters> get_;
  Server<msg::rcl_interfaces_GetParameterTypes> types_;
  Server<msg::rcl_interfaces_DescribeParameters> describe_;
  Server<msg::rcl_interfaces_SetParameters> set_;
  Server<msg::rcl_interfaces_SetParametersAtomically> set_together_;
};

}  // namespace voxtouch::runtime
