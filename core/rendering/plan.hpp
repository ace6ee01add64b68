#pragma once
/// What is built for a scene and why, what is left out and why, and what it costs: for people and
/// for the plan message.
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/coupling/design/loop_parts.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::rendering {

/// In W: of what pushes alone, and of all that may push at once.
struct StiffnessBounds {
  coupling::design::ContactRange translation,
      rotation;  ///< [N/m]; [Nm/rad] about the tool's origin
  bool operator==(const StiffnessBounds&) const = default;
};

/// Where the voxel grid of a static object begins [m].
struct PlacedGrid {
  std::string object;
  Vec3 origin = Vec3::Zero();
  Vec3 at_multiples =
      Vec3::Zero();    ///< where it would begin with its borders at multiples of the voxel
  bool given = false;  ///< by the scene
};

/// What the builders counted, as plain numbers: the plan knows no voxmap and no pointshell.
struct BuildCounts {
  std::uint64_t static_triangles = 0, dynamic_triangles = 0;
  std::uint64_t surface_voxels = 0, interior_voxels = 0;
  std::uint64_t shell_points = 0;
  std::uint64_t objects = 1;      ///< static ones, each with a voxmap of its own
  std::vector<PlacedGrid> grids;  ///< of each of them
  std::uint64_t voxmap_bytes = 0, shell_bytes = 0;
  std::uint64_t field_bytes = 0,
                field_nodes = 0;  ///< of the signed distance field; 0: none was built
  double field_depth_m = 0.0;     ///< how deep it goes [m]
  double thinnest_m = std::numeric_limits<double>::infinity();  ///< thinnest wall of the static
                                                                ///< meshes; known with a field
  std::string thinnest_mesh;                                    ///< the mesh it belongs to
  std::uint64_t proximity_bytes = 0,
                proximity_nodes = 0;  ///< of the distances that effects ask for; 0: none were built
  double proximity_m = 0.0,
         proximity_smoothing_m = 0.0;  ///< how far out they go, and what they are smoothed over [m]
  std::uint64_t tool_points = 0;       ///< points of the tool that they are looked up for
  double tool_gap_m = 0.0;  ///< no point of the tool's shell is farther from one of these [m]
  std::vector<std::string> open_meshes;  ///< static meshes that are not closed
  double virtual_tool_lever_m = 0.0;     ///< [m]; 0: there is no virtual tool
  double tool_reach_m = 0.0;             ///< farthest point of the tool's shell from its origin [m]
  std::uint64_t edge_points = 0, edge_bytes = 0;  ///< of sharp edges, that a virtual tool looks up
                                                  ///< in itself, and of what it looks up; 0: none
  std::string skipped_edges;                      ///< why it does not, where it could not
  StiffnessBounds contact;                        ///< without effects; see contact_range.hpp
  bool closed = true;  ///< all static meshes are closed; an open one has no interior
  std::vector<std::string> mesh_warnings;  ///< what is wrong with the meshes, as sentences
};

/// One thing that exists because the scene, or the ring that runs it, calls for it.
struct PlanPart {
  std::string name;          ///< "voxmap", "effect oil", "topic device/state", "node rendering"
  std::string node;          ///< whose frame pays for it
  std::string why;           ///< what calls for it, a sentence
  std::uint64_t bytes = 0;   ///< of heap; 0: none worth counting
  double expected_ns = 0.0;  ///< a frame, at most: from counts, not measured; 0: nothing in a frame
};

/// Of a virtual tool's spring, before the device is known: stiffer than any device can show,
/// and against rotation that times the square of its lever. The fit brings it down to what the
/// device and the certificates allow (design_problem.hpp).
inline constexpr double kSpringOfAnyDevice = 1e8;  ///< [N/m]
inline StiffnessBounds spring_of_any_device(double lever_m) noexcept {
  const double k = kSpringOfAnyDevice, kr = k * lever_m * lever_m;
  return {{k, k}, {kr, kr}};
}
/// Whether the contact is such a spring, effects aside: so the plan carries it to the node that
/// fits a coupling, whatever scene that one has read.
inline bool is_spring(const StiffnessBounds& bounds) noexcept {
  return bounds.translation.one_point == kSpringOfAnyDevice;
}

/// What the device meets at most: contact and effects together, or the grip alone where the object
/// is a body.
StiffnessBounds with_effects(const StiffnessBounds& contact,
                             std::span<const effects::EffectSpec> effects);

/// Walls as thick as the first hold any virtual tool, and any wall holds a tool that is nowhere
/// thinner than the second [voxels] (tests/hard/faults/foil_rows_test.cpp).
inline constexpr double kHoldingWallVoxels = 1.5, kHeldToolVoxels = 3.0;

struct Plan {
  std::string scene, scene_hash, contact_model;
  double voxel_size_m = 0.0;
  std::uint64_t shell_points = 0, surface_voxels = 0, interior_voxels = 0;
  std::uint64_t bytes = 0;  ///< of what a frame looks up: voxmap, pointshell, fields
  double expected_ns_per_frame =
      0.0;  ///< of the rendering, contact and effects: from counts, not measured
  /// What the contact can show at most, in W before the coupling: translation, and rotation about
  /// the tool's origin.
  coupling::design::ContactRange contact_n_per_m, contact_nm_per_rad;
  StiffnessBounds of_contact_alone;  ///< the same without any effect
  double tool_reach_m = 0.0;  ///< farthest point of the tool's shell from its origin, at the hand
  std::vector<std::string> built, skipped, warnings;  ///< one sentence each
  std::vector<PlanPart> parts;  ///< what a frame is made of, in the order of its way
};

/// Cost of one shell point that the culling leaves to be turned and looked up, and of a frame in
/// addition to its points [ns]: a server processor of the 2020s, one thread that shares its core,
/// voxmap within the caches.
inline constexpr double kNsPerPoint = 6.0, kNsPerFrame = 150.0;
/// A point in contact, with the sums for the stiffness and what the stage remembers of it [ns]:
/// `original` and `adapted`; `field`, eight nodes.
inline constexpr double kNsPerPlainPoint = 12.0, kNsPerFieldPoint = 35.0;
/// An iteration of a virtual tool's step, with the most rows that one has [ns].
inline constexpr double kNsPerIteration = 3000.0;
/// An effect's gate and sum in addition to its own law, one that is switched off, and a step of the
/// coupling with cap, law, damping and observer [ns].
inline constexpr double kNsPerEffect = 60.0, kNsPerEffectOff = 15.0, kNsPerCoupling = 300.0;

/// What an effect that asks for distances adds for each point of the tool near a static object
/// [ns]: 27 nodes. One that is far costs about a seventh.
inline constexpr double kNsPerProximityPoint = 200.0;

/// The plan for `scene`, given what its builders counted.
Plan make_plan(const scene::Scene& scene, const BuildCounts& counts);

/// What the frames of `scene` are made of; in plan_parts.cpp.
std::vector<PlanPart> plan_parts(const scene::Scene& scene, const BuildCounts& counts);
/// Of an effect in a frame at most, as it is at the start [ns]; `tool_points`: that it may look
/// round from.
double expected_ns(const effects::EffectSpec& effect, std::uint64_t tool_points) noexcept;
/// Of one point in contact [ns]; `contact_model` as scenes spell it.
double ns_per_contact_point(std::string_view contact_model) noexcept;
/// Memory of the sharp edges of all objects in addition to the distances to the tool.
std::uint64_t edge_lookup_bytes(std::uint64_t edge_points) noexcept;
/// "812 bytes", "96.0 kB", "2.5 MB".
std::string bytes_text(std::uint64_t bytes);

}  // namespace voxtouch::rendering
