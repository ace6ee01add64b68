#pragma once
/// The virtual tool against the triangles of a scene's objects.
#include <vector>

#include "core/exact/virtual_tool.hpp"
#include "core/rendering/exact_bodies.hpp"
#include "core/rendering/tool_solver.hpp"

namespace voxtouch::rendering {

class ExactTool final : public ToolSolver {
 public:
  /// `objects`: how many the scene has; `lever_m`: above 0. The bodies must outlive it.
  ExactTool(const ExactBodies& bodies, std::size_t objects, double lever_m);

  contact::VirtualToolFrame frame(const contact::HandSample& hand,
                                  std::span<const Vec3> displacements) noexcept override;
  void relocate(const Pose&, std::span<const Vec3>) noexcept override { tool_.relocate(); }
  void start_at(const Pose& tool, std::span<const Vec3>) noexcept override {
    tool_.start_at(to_bodies(tool));
  }
  void reset() noexcept override { tool_.reset(); }
  bool placed() const noexcept override { return tool_.placed(); }
  std::span<const Wrench> forces() const noexcept override { return forces_; }

 private:
  Pose to_bodies(const Pose& pose) const noexcept;
  Vec3 to_world(const Vec3& position) const noexcept;
  void put(std::span<const Vec3> displacements) noexcept;
  void report(const exact::VirtualToolFrame& found, contact::VirtualToolFrame& out) noexcept;

  const ExactBodies& bodies_;
  exact::VirtualTool tool_;
  std::vector<Pose> poses_;  ///< of each body, in x'
  std::vector<Wrench> forces_;
};

}  // namespace voxtouch::rendering
