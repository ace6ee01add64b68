#pragma once
/// The virtual tool on the voxels of a scene's objects.
#include <vector>

#include "core/rendering/object_contacts.hpp"
#include "core/rendering/tool_solver.hpp"

namespace voxtouch::rendering {

class VoxelTool final : public ToolSolver {
 public:
  /// `lever_m` 0: the tool's reach. Every object must have its field; they must outlive it.
  VoxelTool(const ObjectContacts& objects, double lever_m);

  contact::VirtualToolFrame frame(const contact::HandSample& hand,
                                  std::span<const Vec3> displacements) noexcept override;
  void relocate(const Pose& hand, std::span<const Vec3> displacements) noexcept override;
  void start_at(const Pose& tool, std::span<const Vec3> displacements) noexcept override;
  void reset() noexcept override { tool_.reset(); }
  bool placed() const noexcept override { return tool_.placed(); }
  std::span<const Wrench> forces() const noexcept override { return tool_.pushes(); }

 private:
  void put(std::span<const Vec3> displacements) noexcept;

  std::vector<contact::ToolGround> grounds_;
  contact::VirtualTool tool_;
  Pose last_;  ///< the tool of the last frame, or its start pose
};

}  // namespace voxtouch::rendering
