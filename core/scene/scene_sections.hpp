#pragma once
/// The sections of a scene file, one function each. All throw SceneError; see keys.hpp for the
/// keys.
#include "core/scene/map_reader.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::scene {

/// Entries of `static`: meshes, objects, and the grid's origin if an entry has it. `scene.contact`
/// must be read first: it is the default material of objects. In static_section.cpp.
void read_static(SceneSource& source, const YamlNode& node, Scene& scene);
/// `position` and `orientation`.
Pose read_pose(const MapReader& map);
/// The keys that a static mesh and the dynamic one have in common.
MeshSpec read_mesh(const SceneSource& source, const MapReader& map);
/// One motion; an object's is not `by_hand`.
Motion read_motion(const SceneSource& source, const YamlNode& node, std::string_view what,
                   bool by_hand);
/// `dynamic`: the tool's mesh in T, and the kind of its shell. All these functions throw
/// SceneError.
MeshSpec read_dynamic_mesh(const SceneSource& source, const MapReader& map, ShellKind& shell);
/// `contact`: the model and its stiffness in W.
ContactSpec read_contact(const SceneSource& source, const MapReader& map);
/// A scene with the effect `body` and without a contact stiffness gets one from the body's mass.
void follow_body_mass(const MapReader& contact, Scene& scene);
/// Checks the whole scene: refuses what contradicts a virtual tool, and warns of keys that only a
/// virtual tool uses.
void check_virtual_tool(SceneSource& source, const MapReader& map, const Scene& scene);
/// `scene.objects` are read before. In effects_section.cpp.
std::vector<effects::EffectSpec> read_effects(SceneSource& source, const YamlNode& node,
                                              const Scene& scene);
/// The manual coupling, or, for a design, `design` and default parameters. In coupling_section.cpp.
coupling::CouplingSpec read_coupling(SceneSource& source, const YamlNode& node,
                                     std::optional<DesignOptions>& design);
/// `device`: pose, tool, scales and clutch; see WorkspaceMapping for the frames.
WorkspaceMapping read_device(const MapReader& map);
/// `motions`, by name; in W, SI units.
std::map<std::string, Motion> read_motions(SceneSource& source, const YamlNode& node);

}  // namespace voxtouch::scene
