#pragma once
/// Solver of the virtual tool's pose, on voxels (voxel_tool.hpp) or triangles (exact_tool.hpp).
#include <span>

#include "core/contact/virtual_tool.hpp"

namespace voxtouch::rendering {

/// Interface of the solvers. One thread at a time. All functions except the constructors are
/// real-time safe. `displacements`: of each object of the scene from its rest position, in W [m],
/// in the order of ObjectContacts.
class ToolSolver {
 public:
  ToolSolver() = default;
  ToolSolver(const ToolSolver&) = delete;
  ToolSolver& operator=(const ToolSolver&) = delete;
  virtual ~ToolSolver() = default;

  /// As contact::VirtualTool::frame; `contact_object` is an index into `displacements`.
  virtual contact::VirtualToolFrame frame(const contact::HandSample& hand,
                                          std::span<const Vec3> displacements) noexcept = 0;
  /// The hand may be anywhere, now at `hand`: the tool starts there if that is free, otherwise it
  /// continues from its pose. Either may take some frames, during which there is no tool.
  virtual void relocate(const Pose& hand, std::span<const Vec3> displacements) noexcept = 0;
  /// Starts from `tool` if that is free, with the full force. This may also take some frames.
  virtual void start_at(const Pose& tool, std::span<const Vec3> displacements) noexcept = 0;
  virtual void reset() noexcept = 0;
  virtual bool placed() const noexcept = 0;
  /// Force of each object on the tool in the last `frame`, over the stiffness of the spring: force
  /// [m], torque [m^2].
  virtual std::span<const Wrench> forces() const noexcept = 0;
};

}  // namespace voxtouch::rendering
