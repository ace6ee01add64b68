#pragma once
/// Describes which parts are built for a scene, which are omitted, the reasons and the costs, for
/// messages and for the plan message.
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/coupling/design/loop_parts.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::rendering {

/// Stiffness bounds in W: of a single point and of all that may act at once.
struct StiffnessBounds {
  coupling::design::ContactRange translation,
      rotation;  ///< [N/m]; [Nm/rad] about the tool's origin
  bool operator==(const StiffnessBounds&) const = default;
};

/// Origin of the voxel grid of a static object [m].
struct PlacedGrid {
  std::string object;
  Vec3 origin = Vec3::Zero();
  Vec3 at_multiples =
      Vec3::Zero();    ///< default origin, with borders at multiples of the voxel edge
  bool given = false;  ///< specified by the scene
};

/// Counts of the builders as plain numbers, so that the plan does not depend on voxmap and
/// pointshell.
struct BuildCounts {
  std::uint64_t static_triangles = 0, dynamic_triangles = 0;
  std::uint64_t surface_voxels = 0, interior_voxels = 0;
  std::uint64_t shell_points = 0;
  std::uint64_t objects = 1;      ///< static ones, each with its own voxmap
  std::vector<PlacedGrid> grids;  ///< of each of them
  std::uint64_t voxmap_bytes = 0, shell_bytes = 0;
  std::uint64_t field_bytes = 0,
                field_nodes = 0;  ///< of the signed distance field; 0: not built
  double field_depth_m = 0.0;     ///< its largest depth [m]
  /// Thinnest wall of the static meshes; available with penalty forces of a field.
  double thinnest_m = std::numeric_limits<double>::infinity();
  std::string thinnest_mesh;  ///< mesh of that wall
  std::uint64_t proximity_bytes = 0,
                proximity_nodes = 0;  ///< of the distances for effects; 0: not built
  double proximity_m = 0.0,
         proximity_smoothing_m = 0.0;  ///< their range and smoothing length [m]
  std::uint64_t tool_points = 0;       ///< number of tool points for their queries
  double tool_gap_m = 0.0;  ///< largest distance of a shell point from the nearest of these [m]
  std::vector<std::string> open_meshes;  ///< open static meshes
  double virtual_tool_lever_m = 0.0;     ///< [m]; 0: no virtual tool
  double tool_reach_m = 0.0;             ///< farthest point of the tool's shell from its origin [m]
  std::uint64_t virtual_tool_bytes = 0;  ///< features of both meshes, with their trees
  /// Of the simplified meshes that the virtual tool uses: of the tool, of the scene.
  std::uint64_t virtual_tool_triangles = 0, virtual_tool_scene_triangles = 0;
  StiffnessBounds contact;  ///< without effects; see contact_range.hpp
  bool closed = true;       ///< all static meshes are closed; an open one has no interior
  std::vector<std::string> mesh_warnings;  ///< defects of the meshes, as sentences
};

/// One part that exists because the scene or its ring needs it.
struct PlanPart {
  std::string name;         ///< "voxmap", "effect oil", "topic device/state", "node rendering"
  std::string node;         ///< the node whose frame includes its cost
  std::string why;          ///< reason for the part, a sentence
  std::uint64_t bytes = 0;  ///< on the heap; 0: negligible
  /// Upper bound per frame: from counts, not measured; 0: no cost in a frame.
  double expected_ns = 0.0;
};

/// Placeholder for the spring of a virtual tool while the device is unknown: stiffer than any
/// device can display, and for rotation times the squared lever. The fit reduces it to what device
/// and certificates allow (design_problem.hpp).
inline constexpr double kSpringOfAnyDevice = 1e8;  ///< [N/m]
inline StiffnessBounds spring_of_any_device(double lever_m) noexcept {
  const double k = kSpringOfAnyDevice, kr = k * lever_m * lever_m;
  return {{k, k}, {kr, kr}};
}
/// Whether the contact, without effects, is such a spring. The plan thus informs the node that fits
/// a coupling, independent of the scene that this node has read.
inline bool is_spring(const StiffnessBounds& bounds) noexcept {
  return bounds.translation.one_point == kSpringOfAnyDevice;
}

/// Stiffness bounds for the device: contact and effects together, or only the grip if the object is
/// a body.
StiffnessBounds with_effects(const StiffnessBounds& contact,
                             std::span<const effects::EffectSpec> effects);

struct Plan {
  std::string scene, scene_hash, contact_model;
  double voxel_size_m = 0.0;
  std::uint64_t shell_points = 0, surface_voxels = 0, interior_voxels = 0;
  std::uint64_t bytes = 0;  ///< memory used by a frame: voxmap, pointshell, fields
  double expected_ns_per_frame =
      0.0;  ///< of the rendering, contact and effects: from counts, not measured
  /// Upper bounds of the contact stiffness in W ahead of the coupling: translation, and rotation
  /// about the tool's origin.
  coupling::design::ContactRange contact_n_per_m, contact_nm_per_rad;
  StiffnessBounds of_contact_alone;  ///< the same without any effect
  double tool_reach_m = 0.0;  ///< farthest point of the tool's shell from its origin, at the hand
  std::vector<std::string> built, skipped, warnings;  ///< one sentence each
  std::vector<PlanPart> parts;                        ///< parts of a frame, in their order
};

/// Cost of one shell point that culling leaves to be transformed and queried, and of a frame
/// without its points [ns]. Valid for a server processor of the 2020s, one thread on a shared core,
/// voxmap in the caches.
inline constexpr double kNsPerPoint = 6.0, kNsPerFrame = 150.0;
/// Cost of a point in contact, with its stiffness sums and the latching in the stage [ns]:
/// `original` and `adapted`; `field`, eight nodes.
inline constexpr double kNsPerPlainPoint = 12.0, kNsPerFieldPoint = 35.0;
/// Cost of one unit of a virtual tool's work (core/exact/work.hpp) [ns].
inline constexpr double kNsPerWork = 11.0;
/// Cost of an effect's gate and sum in addition to its own law, of a disabled effect, and of a
/// coupling step with cap, law, damping and observer [ns].
inline constexpr double kNsPerEffect = 60.0, kNsPerEffectOff = 15.0, kNsPerCoupling = 300.0;

/// Additional cost of an effect that needs distances, for each tool point near a static object
/// [ns]: 27 nodes. A distant point costs about a seventh.
inline constexpr double kNsPerProximityPoint = 200.0;

/// The plan for `scene` and the counts of its builders.
Plan make_plan(const scene::Scene& scene, const BuildCounts& counts);

/// The parts of a frame of `scene`; in plan_parts.cpp.
std::vector<PlanPart> plan_parts(const scene::Scene& scene, const BuildCounts& counts);
/// Upper bound of an effect's cost per frame with its initial settings [ns]; `tool_points`: number
/// of its query points.
double expected_ns(const effects::EffectSpec& effect, std::uint64_t tool_points) noexcept;
/// Cost of one point in contact [ns]; `contact_model` as spelled in scenes.
double ns_per_contact_point(std::string_view contact_model) noexcept;
/// For example "812 bytes", "96.0 kB", "2.5 MB".
std::string bytes_text(std::uint64_t bytes);

}  // namespace voxtouch::rendering
