#include "nodes/runtime/life_cycle.hpp"

#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::runtime {
namespace {

/// A request is empty: there is nothing in it that could be too long.
bool always_fits(const msg::lifecycle_msgs_GetState::Request&) { return true; }

}  // namespace

LifeCycleState life_cycle_state(NodeState state) noexcept {
  using namespace msg::lifecycle_msgs_State_constants;
  switch (state) {
    case NodeState::kStarting:
      return {kTransitionStateConfiguring, "configuring"};
    case NodeState::kReady:
      return {kPrimaryStateInactive, "inactive"};
    case NodeState::kRunning:
      return {kPrimaryStateActive, "active"};
    case NodeState::kStopped:
      return {kPrimaryStateFinalized, "finalized"};
    case NodeState::kFailed:
      return {kTransitionStateErrorprocessing, "errorprocessing"};
  }
  return {kPrimaryStateUnknown, "unknown"};
}

LifeCycle::LifeCycle(const bus::Participant& participant, std::string_view node,
                     const std::string& rig)
    : states_(bus::ServiceServer<msg::lifecycle_msgs_GetState>::make<always_fits>(
          participant, qos::kGetState, rig, node)) {}

void LifeCycle::serve(NodeState state) {
  constexpr int kMaxPerLook = 16;
  states_.send_waiting();
  states_.take(
      [&](const auto&, const bus::Caller& caller) {
        if (!admitted_.take(monotonic_ns()).say)
          return;
        states_.reply(caller, [now = life_cycle_state(state)](auto& response, const auto& send) {
          const std::string label(now.label);
          response.current_state.id = now.id;
          response.current_state.label = lend(label);
          send();
        });
      },
      kMaxPerLook);
}

}  // namespace voxtouch::runtime
