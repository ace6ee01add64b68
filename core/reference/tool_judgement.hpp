#pragma once
/// Judges a virtual tool by the gaps of tool and hand, by the rules of README.md. Pure arithmetic,
/// as judgement.hpp.
#include "core/reference/judgement.hpp"

namespace voxtouch::reference {

/// A virtual tool as ContactState reports it. World frame.
struct ReportedTool {
  Pose tool, hand;
  Wrench wrench;
  double residual_m = 0.0;
  bool constrained = false, not_converged = false, not_initialised = false;  ///< the flags
};

/// What the rules need in addition to JudgeSettings.
struct ToolSettings {
  double reach_m = 0.0;  ///< no point of the tool is farther from its origin
  bool rubs = false;     ///< the scene has friction
};

/// The first breach as a sentence; empty: none. Sets the figures of `out`.
std::string tool_breach(const JudgeSettings& settings, const ToolSettings& tool,
                        const GapResult& at_tool, const GapResult& at_hand,
                        const ReportedTool& report, Judgement& out);

}  // namespace voxtouch::reference
