#pragma once
/// Judges a virtual tool by the reference's gaps, of the virtual tool and of the hand. Pure
/// arithmetic, as judgement.hpp.
///
/// Symbols: e voxel edge; c chord error; g shell gap; R the tool's radius where it is a sphere; sag
/// = g^2/8R, what a ball of points g apart lacks between them (g/2 where no sphere is declared); r
/// the way that the frame left over (residual); way: of the point that has farthest to go from the
/// virtual tool to the hand.
///
/// Every sample is decided; nothing is held and there is no band. Each breach is a disagreement:
///  - A force, but no constraint; or a force while there is no virtual tool. One that lags may be
///  anywhere on its way, or on the wrong side of an
///    object that moved through it: then only the spring's own rules are asked.
///  - No force, tool placed and not lagging, but the virtual tool is not the hand.
///  - The force is not along the way from the hand to the virtual tool.
///  - A force, and the virtual tool is deeper in the wall than e/10 + c; or farther off than sag +
///  e/50 + c + r, where it touches one
///    face. In corners and at edges, where an interpolated distance is blunt, than e + sag + c + r.
///    By e/16 more where a mesh is open, which is a wall then.
///  - A force, though nothing is between virtual tool and hand: the hand's gap is larger than way +
///  e/5 + c, and r is small.
///  - No force, though the hand is deeper inside than sag + e/5 + c.
///  - The force is more than 6 degrees off the contact's normal, where one face is touched, the
///  spring is longer than e/4, r is small
///    and nothing rubs.
#include "core/reference/judgement.hpp"

namespace voxtouch::reference {

/// A virtual tool as ContactState reports it. World frame.
struct ReportedTool {
  Pose tool, hand;
  Wrench wrench;
  double residual_m = 0.0;
  bool constrained = false, lag = false, unplaced = false;  ///< the flags
};

/// What the rules need to know beside JudgeSettings.
struct ToolSettings {
  double reach_m = 0.0;  ///< no point of the tool is farther from its origin
  bool rubs = false;     ///< the scene has friction
};

/// The first breach as a sentence; empty: none. Sets the figures of `out`.
std::string tool_breach(const JudgeSettings& settings, const ToolSettings& tool,
                        const GapResult& at_tool, const GapResult& at_hand,
                        const ReportedTool& report, Judgement& out);

}  // namespace voxtouch::reference
