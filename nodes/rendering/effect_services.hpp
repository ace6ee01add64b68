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
#include "nodes/log/few_a_second.hpp"
#include "nodes/rendering/effect_parameters.hpp"

namespace voxtouch::rendering_node {

/// What became of one of several changes: `which` is its place among them.
using ChangeTold = std::function<void(std::size_t which, bool done, std::uint64_t from_sample,
                                      const std::string& sentence)>;

/// The way of every change, as the services need it. Both are called from the thread that calls
/// `serve`.
struct ChangeHandler {
  /// Each by itself, or `together` all in one sample or none. `told` is called once for each, at
  /// once or later.
  std::function<void(std::span<const msg::EffectChange> changes, bool together, ChangeTold told)>
      ask;
  std::function<std::vector<RosParameter>()> parameters;  ///< as they are set now
};

/// All in one thread of ordinary priority. What clients may send is bounded: kMaxPerSecond
/// requests, of which each change asked for counts as one, each as request_limits.hpp allows. What
/// is beyond is not answered and counted.
class EffectServices {
 public:
  static constexpr int kMaxPerSecond = 200;

  EffectServices(const bus::Participant& participant, const std::string& rig,
                 ChangeHandler handler);
  void attach_to(bus::WaitSet& wait_set);
  /// Answers what has come, and what waited for its client. Does not block. Where not `answers`
  /// another rendering that acts does: what has come is dropped.
  void serve(bool answers);
  /// Replies wait for their client's reader: `serve` soon.
  bool waits() const noexcept;
  /// Parameters may have changed, by whatever way: tells `/parameter_events` what did.
  void parameters_changed();
  /// Requests that were beyond what a second takes. Any thread.
  std::uint64_t refused() const noexcept { return refused_.load(std::memory_order_relaxed); }

 private:
  template <class S>
  using Server = bus::ServiceServer<S>;
  template <class S, class F>
  void each(Server<S>& server, F&& f);
  bool admits(std::uint32_t count);
  /// Values, types and descriptions of parameters by name.
  void serve_named();
  /// Of a name that there is not, a value that is not set: so tools say that it is not.
  template <class Names>
  std::vector<RosParameter> named(const Names& names) const;
  void set(const msg::rcl_interfaces_SetParameters::Request& request, const bus::Caller& caller);
  void set_together(const msg::rcl_interfaces_SetParametersAtomically::Request& request,
                    const bus::Caller& caller);
  void change(const msg::ChangeEffect::Request& request, const bus::Caller& caller);

  std::string node_;  ///< "/haptic/rendering"
  bool answers_ = true;
  ChangeHandler handler_;
  Server<msg::ChangeEffect> change_;
  Server<msg::rcl_interfaces_ListParameters> list_;
  Server<msg::rcl_interfaces_GetParameters> get_;
  Server<msg::rcl_interfaces_GetParameterTypes> types_;
  Server<msg::rcl_interfaces_DescribeParameters> describe_;
  Server<msg::rcl_interfaces_SetParameters> set_;
  Server<msg::rcl_interfaces_SetParametersAtomically> set_together_;
  bus::Writer<msg::rcl_interfaces_ParameterEvent> events_;
  std::vector<RosParameter> told_;  ///< as the events' readers know them
  log::FewASecond admitted_{kMaxPerSecond};
  std::atomic<std::uint64_t> refused_{0};
};

}  // namespace voxtouch::rendering_node
