#pragma once
/// A controller and a scripted remote side in one process, without a network.
#include <functional>

#include "devices/lwr/simulated/fri_controller.hpp"
#include "tests/unit/lwr_sim/scripted_remote.hpp"

namespace voxtouch::lwr_sim::test {

inline hand::Hand released_hand() {
  sim::OperatorConfig config;
  config.released = true;
  Motion motion;
  motion.path = {lwr::LwrArm().tool(lwr::lwr_rest_posture()).position};
  return hand::Hand(config, motion, kSubstep);
}

/// An arm's grip with a target at `offset` from the tool's start.
inline hand::Hand arm_at(const Vec3& offset, double stiffness_n_per_m = 200.0,
                         double damping_ns_per_m = 15.0) {
  sim::OperatorConfig config = *hand::grip("arm");
  config.carries_tool = false;
  config.stiffness_n_per_m = stiffness_n_per_m;
  config.damping_ns_per_m = damping_ns_per_m;
  const Pose tool = lwr::LwrArm().tool(lwr::lwr_rest_posture());
  Motion motion;
  motion.path = {tool.position + offset};
  motion.orientation = tool.orientation;
  return hand::Hand(config, motion, kSubstep);
}

struct Rig {
  explicit Rig(const ControllerConfig& config = {}, hand::Hand hand = released_hand(),
               std::vector<Fault> faults = {})
      : controller(config, std::move(hand), FaultSchedule(std::move(faults))) {}

  /// One period; the answer is delivered unless `answers` is false.
  MsrBytes period(bool answers = true) {
    MsrBytes msr;
    std::memcpy(msr.data(), &controller.measure(), msr.size());
    if (answers) {
      CmdBytes cmd = remote.answer(msr);
      if (tamper)
        tamper(cmd);
      controller.receive(cmd, 0.0);
    }
    controller.advance();
    return msr;
  }
  MsrBytes periods(int n, bool answers = true) {
    MsrBytes msr{};
    for (int i = 0; i < n; ++i)
      msr = period(answers);
    return msr;
  }
  /// Runs until command mode; false if it is not reached within `most` periods.
  bool start(int most = 300) {
    for (int i = 0; i < most && controller.state() != lwr::fri::State::kCmd; ++i)
      period();
    return controller.state() == lwr::fri::State::kCmd;
  }
  /// The last thing that happened, all taken.
  Reason reason() {
    Reason last = Reason::kNone;
    while (const auto event = controller.take_event())
      last = event->why.reason;
    return last;
  }

  FriController controller;
  ScriptedRemote remote;
  std::function<void(CmdBytes&)> tamper;
};

}  // namespace voxtouch::lwr_sim::test
