#pragma once
/// The six parameter services that every ROS node has, over a node's own parameters.
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

/// What became of one of several settings: `which` is its place among them.
using SettingReply = std::function<void(std::size_t which, bool done, const std::string& sentence)>;

/// Both are called from the thread that calls `serve`.
struct ParameterHandler {
  std::function<std::vector<RosParameter>()> parameters;  ///< as they are set now, sorted by name
  /// Each by itself, or `together` all or none, on request of the participant `by`. `reply` is
  /// called once for each, at once or later. Null: every parameter is read-only.
  std::function<void(std::span<const msg::rcl_interfaces_Parameter> asked, bool together,
                     const bus::Guid& by, SettingReply reply)>
      set;
};

/// Counts requests against what a second takes. One thread; `refused` any.
class RequestLimit {
 public:
  explicit RequestLimit(int per_second) : admitted_(per_second) {}
  /// Whether `count` more go into this second; the part that does is taken.
  bool admits(std::uint32_t count);
  std::uint64_t refused() const noexcept { return refused_.load(std::memory_order_relaxed); }

 private:
  console::RateLimiter admitted_;
  std::atomic<std::uint64_t> refused_{0};
};

/// `use_sim_time` stands among the parameters of every node: whether it runs in lockstep. A
/// read-only parameter may be set to the value that it has, so that `ros2 param load` takes a dump
/// of the node. All in one thread of ordinary priority. Requests beyond request_limits.hpp or the
/// limit are not answered.
class ParameterServices {
 public:
  ParameterServices(const bus::Participant& participant, const std::string& rig,
                    const std::string& node, bool lockstep, ParameterHandler handler,
                    RequestLimit& limit);
  void attach_to(bus::WaitSet& wait_set);
  /// Answers what has come, and what waited for its client. Does not block.
  void serve();
  /// Replies wait for their client's reader: `serve` soon.
  bool waits() const noexcept;
  /// All of them, with `use_sim_time`.
  std::vector<RosParameter> parameters() const;

 private:
  template <class S>
  using Server = bus::ServiceServer<S>;
  template <class S, class F>
  void each(Server<S>& server, F&& f);
  void serve_named();
  /// Of a name that there is not, a value that is not set: so tools say that it is not.
  template <class Names>
  std::vector<RosParameter> named(const Names& names) const;
  /// Calls handler_.set for what may change something; `reply` for all.
  void set(std::span<const msg::rcl_interfaces_Parameter> asked, bool together, const bus::Guid& by,
           const SettingReply& reply);

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
