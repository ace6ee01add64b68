#pragma once
/// Services of the rendering: parameters in the form that ROS tools know, and EffectChange. They
/// judge nothing: what is asked for goes the way of every change.
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

/// What became of one of several changes: `which` is its place among them.
using ChangeReply = std::function<void(std::size_t which, bool done, std::uint64_t from_sample,
                                       const std::string& sentence)>;

/// The way of every change, as the services need it. Both are called from the thread that calls
/// `serve`.
struct ChangeHandler {
  /// Each by itself, or `together` all in one sample or none, on request of the participant `by`.
  /// `reply` is called once for each, at once or later.
  std::function<void(std::span<const msg::EffectChange> changes, bool together, const bus::Guid& by,
                     ChangeReply reply)>
      ask;
  std::function<std::vector<RosParameter>()> parameters;  ///< as they are set now
};

/// All in one thread of ordinary priority. What clients may send is bounded: kMaxPerSecond
/// requests, of which each change asked for counts as one, each as request_limits.hpp allows. What
/// is beyond is not answered and counted.
class EffectServices {
 public:
  static constexpr int kMaxPerSecond = 200;

  EffectServices(const bus::Participant& participant, const std::string& rig, bool lockstep,
                 ChangeHandler handler);
  void attach_to(bus::WaitSet& wait_set);
  /// Answers what has come, and what waited for its client. Does not block.
  void serve();
  /// Replies wait for their client's reader: `serve` soon.
  bool waits() const noexcept;
  /// Parameters may have changed, by whatever way: reports on `/parameter_events` what did.
  void parameters_changed();
  /// Requests that were beyond what a second takes. Any thread.
  std::uint64_t refused() const noexcept { return limit_.refused(); }

 private:
  void set(std::span<const msg::rcl_interfaces_Parameter> asked, bool together, const bus::Guid& by,
           const runtime::SettingReply& reply);
  void change(const msg::ChangeEffect::Request& request, const bus::Caller& caller);

  std::string node_;  ///< "/haptic/rendering"
  ChangeHandler handler_;
  runtime::RequestLimit limit_{kMaxPerSecond};
  bus::ServiceServer<msg::ChangeEffect> change_;
  runtime::ParameterServices parameters_;
  bus::Writer<msg::rcl_interfaces_ParameterEvent> events_;
  std::vector<RosParameter> published_;  ///< as the events' readers know them
};

}  // namespace voxtouch::rendering_node
