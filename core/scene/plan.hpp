#pragma once
/// What is built for a scene and why, what is left out and why, and what it costs: for people and for the plan message.
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/coupling/design/loop_parts.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch {

/// What the builders counted, as plain numbers: the plan knows no voxmap and no pointshell.
struct BuildCounts {
  std::uint64_t static_triangles = 0, dynamic_triangles = 0;
  std::uint64_t surface_voxels = 0, interior_voxels = 0;
  std::uint64_t shell_points = 0;
  std::uint64_t voxmap_bytes = 0, shell_bytes = 0;
  std::uint64_t field_bytes = 0, field_nodes = 0;    ///< of the signed distance field; 0: none was built
  double field_depth_m = 0.0;                        ///< how deep it goes [m]
  double thinnest_m = std::numeric_limits<double>::infinity();  ///< thinnest wall of the static meshes; known with a field
  std::string thinnest_mesh;                         ///< the mesh it belongs to
  std::uint64_t proximity_bytes = 0, proximity_nodes = 0;  ///< of the distances that effects ask for; 0: none were built
  double proximity_m = 0.0, proximity_smoothing_m = 0.0;   ///< how far out they go, and what they are smoothed over [m]
  std::uint64_t tool_points = 0;                           ///< points of the tool that they are looked up for
  double tool_gap_m = 0.0;                                 ///< no point of the tool's shell is farther from one of these [m]
  std::vector<std::string> open_meshes;              ///< static meshes that are not closed
  ContactRange contact_n_per_m, contact_nm_per_rad;  ///< in W, see contact_range.hpp
  bool closed = true;                       ///< all static meshes are closed; an open one has no interior
  std::vector<std::string> mesh_warnings;   ///< what is wrong with the meshes, as sentences
};

struct Plan {
  std::string scene, scene_hash, contact_model;
  double voxel_size_m = 0.0;
  std::uint64_t shell_points = 0, surface_voxels = 0, interior_voxels = 0, bytes = 0;
  double expected_ns_per_frame = 0.0;       ///< from counts, not measured
  /// What the contact can show at most, in W before the coupling: translation, and rotation about the tool's origin.
  ContactRange contact_n_per_m, contact_nm_per_rad;
  std::vector<std::string> built, left_out, warnings;  ///< one sentence each
};

/// Cost of one shell point in a frame where most points must be looked up, and of a frame beside its points [ns]: a desktop
/// processor of the 2020s, one thread, no vector instructions, voxmap within the caches. Culling makes most frames cheaper.
inline constexpr double kNsPerPoint = 3.0, kNsPerFrame = 500.0;
/// What the contact model `field` adds for a point that is in contact [ns]: eight nodes and the sums for the stiffness.
inline constexpr double kNsPerFieldPoint = 35.0;

/// What an effect that asks for distances adds for each point of the tool near a static object [ns]: 27 nodes. One that is far
/// costs about a seventh.
inline constexpr double kNsPerProximityPoint = 200.0;

/// The plan for `scene`, given what its builders counted.
Plan make_plan(const Scene& scene, const BuildCounts& counts);

/// The plan as lines for a terminal.
std::string to_text(const Plan& plan);

}  // namespace voxtouch
