#pragma once
/// A scene for touching a part, as values with the reason for each. Loading only: allocates.
#include <string>
#include <vector>

#include "core/mesh/report.hpp"
#include "core/mesh/triangle_mesh.hpp"

namespace voxtouch::scene_proposal {

/// The tool of a first scene: a sphere, or a mesh.
struct Tool {
  bool sphere = true;
  double reach_m = 0.0;  ///< half of its largest extent; of a sphere, found here, its radius
  Vec3 lowest_T = Vec3::Zero();  ///< its lowest point, in its own frame T [m]
};

struct ProposedScene {
  double voxel_size_m = 0.0;
  Tool tool;
  std::vector<Vec3> press_W,
      slide_W;  ///< way points of the tool's origin in W [m]; both begin outside, above the part
  double press_speed_m_per_s = 0.0, slide_speed_m_per_s = 0.0;
  std::vector<std::string> reasons;  ///< sentences: findings and their consequences
};

/// Of a mesh in metres; the hand holds its origin.
Tool tool_of(const mesh::TriangleMesh& mesh);

/// With a virtual tool. `part`: in metres, with its report. `tool`: of a mesh, or a sphere without
/// a radius. Deterministic. Throws std::invalid_argument if the part has no extent.
ProposedScene propose_scene(const mesh::TriangleMesh& part, const mesh::MeshReport& report,
                            Tool tool);

}  // namespace voxtouch::scene_proposal
