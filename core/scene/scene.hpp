#pragma once
/// The contents of a scene file as values. scene_file.hpp reads it; plan.hpp lists what is built.
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/coupling/coupling_spec.hpp"
#include "core/effects/effect_spec.hpp"
#include "core/scene/design_options.hpp"
#include "core/types/geometry.hpp"
#include "core/types/motion.hpp"

namespace voxtouch::scene {

/// Closed forms of a mesh, or of a convex part of it, for the validator. In the mesh's frame after
/// scaling [m].
struct SpherePrimitive {
  Vec3 centre = Vec3::Zero();
  double radius_m = 0;
};
struct BoxPrimitive {
  Pose pose;
  Vec3 size_m = Vec3::Zero();
};
struct CylinderPrimitive {
  Pose pose;
  double radius_m = 0, length_m = 0;
};  ///< axis = local z
using Primitive = std::variant<SpherePrimitive, BoxPrimitive, CylinderPrimitive>;

struct MeshSpec {
  std::filesystem::path path;  ///< absolute, resolved against the scene file's folder
  double scale = 1.0;          ///< file units to metres
  Pose pose;                   ///< static: mesh in W; dynamic: mesh in T
  std::vector<Primitive>
      primitives;  ///< declared equivalents, checked against the mesh by a test; may be empty
  std::uint32_t object = 0;  ///< static: 0 the static scene, n for Scene::objects[n - 1]
};

enum class ShellKind { kExact, kNaive };

/// How a contact is displayed to the hand.
enum class RenderingKind {
  kPenalty,      ///< forces of the contact model at the hand's pose, with latched depths
  kMemoryless,   ///< the same without latched depths, as in the paper
  kVirtualTool,  ///< a spring from the hand to a tool that stays outside
};

inline constexpr double kRestDepthM =
    1e-4;  ///< depth of a body at rest on a sixth of its surface; defines its stiffness by mass

struct ContactSpec {
  std::string model = "adapted";  ///< original | adapted | field
  double stiffness_n_per_m =
      0.0;  ///< per shell point, as in the paper (original, adapted); 0: use the other
  double stiffness_n_per_m3 = 0.0;  ///< per area of the tool's surface, any model; 0: use the other
  RenderingKind rendering =
      RenderingKind::kPenalty;  ///< kVirtualTool: with `field` alone, and both stiffnesses are 0
  double body_mass_kg = 0.0;    ///< mass that defines the stiffness; then both stiffnesses are 0
};

/// Static meshes with one material, and optionally a motion.
struct ObjectSpec {
  std::string name;
  ContactSpec contact;  ///< the scene's model; its stiffness, or the scene's
  std::optional<Motion>
      moves;  ///< displacement of the object in W [m] over the time since the session began
  std::optional<Vec3> grid_origin =
      {};  ///< of its voxel grid before it moves, in W [m]; default: voxmap::object_grid
};

/// How the device moves the tool in the world: pose_WT = pose_WD * scaled(pose_DP) * pose_PT.
struct WorkspaceMapping {
  double position_scale = 1.0;  ///< metres in W for one metre of the device
  double force_scale =
      1.0;       ///< newtons at the device for one newton in W; loop gain is the product of both
  Pose pose_WD;  ///< D, the device's base, in W
  Pose pose_PT;  ///< T in P, the device's tip
  std::optional<std::uint32_t>
      clutch_button;  ///< while pressed, the tool rests and the device moves freely
  bool operator==(const WorkspaceMapping&) const = default;
};

struct Scene {
  std::string name;
  std::filesystem::path file;  ///< the file that was read
  std::string hash;            ///< 16 hex digits over the scene's text and the bytes of its meshes
  std::map<std::filesystem::path, std::string>
      mesh_hashes;  ///< of each mesh's bytes (mesh_parts.hpp), as the scene was read
  double voxel_size_m = 0.0;
  std::vector<MeshSpec> static_meshes;
  std::vector<ObjectSpec>
      objects;  ///< in addition to the static scene, to which all meshes without an object belong
  std::optional<Vec3> grid_origin;  ///< of the static scene; default: voxmap::object_grid
  MeshSpec dynamic_mesh;
  ShellKind shell = ShellKind::kExact;
  ContactSpec contact;
  std::optional<double> lever_m;  ///< of a virtual tool; default: the tool's reach
  bool virtual_tool() const noexcept { return contact.rendering == RenderingKind::kVirtualTool; }
  std::vector<effects::EffectSpec> effects;  ///< in the file's order; others are not computed
  coupling::CouplingSpec coupling;           ///< set by hand; unused with `design`
  std::optional<DesignOptions>
      design;  ///< set: the coupling is designed for device, scene and hand
  WorkspaceMapping device;
  std::map<std::string, Motion> motions;  ///< in W
  std::vector<std::string> warnings;      ///< `file:line:column: sentence` each
};

}  // namespace voxtouch::scene
