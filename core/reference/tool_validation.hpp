#pragma once
/// Evaluates a virtual tool by the gaps of tool and hand, by the rules of README.md. A pure
/// function, like contact_validator.hpp.
#include "core/reference/contact_validator.hpp"

namespace voxtouch::reference {

/// A virtual tool as reported in ContactState. World frame.
struct ReportedTool {
  Pose tool, hand;
  Wrench wrench;
  double residual_m = 0.0;
  bool constrained = false, not_converged = false, not_initialised = false;  ///< the flags
  /// Without torque the tool's rotation may trail the hand's (core/rendering/latched_rotation.hpp).
  bool returns_torque = true;
};

/// Inputs of the rules in addition to ValidatorSettings.
struct ToolSettings {
  double reach_m = 0.0;  ///< largest distance of a tool point from its origin
  bool rubs = false;     ///< the scene has friction
};

/// The first violation as a sentence, or an empty text. Sets the figures of `out`.
std::string tool_breach(const ValidatorSettings& settings, const ToolSettings& tool,
                        const GapResult& at_tool, const GapResult& at_hand,
                        const ReportedTool& report, Validation& out);

}  // namespace voxtouch::reference
