#pragma once
/// The virtual tool in the frame of a scene: W, with the scene's lengths.
#include <vector>

#include "core/exact/virtual_tool.hpp"
#include "core/rendering/exact_bodies.hpp"

namespace voxtouch::rendering {

/// Interface as exact::VirtualTool, but in W and metres. One thread at a time. All functions except
/// the constructor are real-time safe. `displacements`: of each object of the scene from its rest
/// position, in W [m], in the order of ObjectContacts.
class ExactTool {
 public:
  /// `objects`: how many the scene has; `lever_m`: above 0. The bodies must outlive it.
  ExactTool(const ExactBodies& bodies, std::size_t objects, double lever_m);

  /// As exact::VirtualTool::frame; `contact_owner` is an index into `displacements`.
  exact::VirtualToolFrame frame(const exact::HandSample& hand,
                                std::span<const Vec3> displacements) noexcept;
  /// The hand may be anywhere: the tool starts there if that is free, otherwise it continues from
  /// its pose. Either may take some frames, during which there is no tool.
  void relocate() noexcept { tool_.relocate(); }
  /// Starts from `tool` if that is free, with the full force. This may also take some frames.
  void start_at(const Pose& tool) noexcept { tool_.start_at(to_bodies(tool)); }
  void reset() noexcept { tool_.reset(); }
  bool placed() const noexcept { return tool_.placed(); }
  /// Force of each object on the tool in the last `frame`, over the stiffness of the spring: force
  /// [m], torque [m^2].
  std::span<const Wrench> forces() const noexcept { return forces_; }

 private:
  Pose to_bodies(const Pose& pose) const noexcept;
  Vec3 to_world(const Vec3& position) const noexcept;
  void take_forces() noexcept;

  const ExactBodies& bodies_;
  exact::VirtualTool tool_;
  std::vector<Pose> poses_;  ///< of each body, in x'
  std::vector<Wrench> forces_;
};

}  // namespace voxtouch::rendering
