#pragma once
/// ROS services of the rendering: parameters, in the form that ROS tools expect, and EffectChange.
/// All requests go through the change validator.
#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "nodes/bus/service_server.hpp"
#include "nodes/bus/wait_set.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/console/rate_limiter.hpp"
#include "nodes/rendering/effect_parameters.hpp"
#include "nodes/runtime/parameter_services.hpp"

namespace voxtouch::rendering_node {

/// Result of one of several changes; `which` is its index.
using ChangeReply = std::function<void(std::size_t which, bool done, std::uint64_t from_sample,
                                       const std::string& sentence)>;

/// Callbacks into the change queue. Both are called from the thread that calls `serve`.
struct ChangeHandler {
  /// Requests changes for the participant `by`, one at a time, or `together` all in one sample or
  /// none. `reply` is called once for each change, immediately or later.
  std::function<void(std::span<const msg::EffectChange> changes, bool together, const bus::Guid& by,
                     ChangeReply reply)>
      ask;
  std::function<std::vector<RosParameter>()> parameters;  ///< current settings
};

/// Serves ROS clients from one thread of ordinary priority.
/// The rate is bounded: kMaxPerSecond requests, each change counted as one, each within
/// request_limits.hpp. Requests beyond the limit are counted and not answered.
class EffectServices {
 public:
  static constexpr int kMaxPerSecond = 200;

  EffectServices(const bus::Participant& participant, const std::string& rig, bool lockstep,
                 ChangeHandler handler);
  void attach_to(bus::WaitSet& wait_set);
  /// Answers received requests and sends deferred replies. Does not block.
  void serve();
  /// Whether replies are waiting for their client's reader. If so, call `serve` again soon.
  bool waits() const noexcept;
  /// Publishes changed parameters on `/parameter_events`. Call it whenever parameters may have
  /// changed.
  void parameters_changed();
  /// Number of requests beyond the rate limit. Any thread.
  std::uint64_t refused() const noexcept { return limit_.refused(); }

 private:
  void set(std::span<const msg::rcl_interfaces_Parameter> parameters, bool together,
           const bus::Guid& by, const runtime::SettingReply& reply);
  void change(const msg::ChangeEffect::Request& request, const bus::Caller& caller);

  std::string node_;  ///< "/haptic/rendering"
  ChangeHandler handler_;
  runtime::RequestLimit limit_{kMaxPerSecond};
  bus::ServiceServer<msg::ChangeEffect> change_;
  runtime::ParameterServices parameters_;
  bus::Writer<msg::rcl_interfaces_ParameterEvent> events_;
  std::vector<RosParameter> published_;  ///< as last published on `/parameter_events`
};

}  // namespace voxtouch::rendering_node
