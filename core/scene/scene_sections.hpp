#pragma once
/// The sections of a scene file, one function each. All throw SceneError; see keys.hpp for the
/// keys.
#include "core/scene/map_reader.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::scene {

/// Entries of `static`: meshes, objects, and the grid's origin where one entry gives it.
/// `scene.contact` is read before: the objects' material where they name none. In
/// static_section.cpp.
void read_static(SceneSource& source, const YamlNode& node, Scene& scene);
/// `position` and `orientation`.
Pose read_pose(const MapReader& map);
/// The keys that a static mesh and the dynamic one have in common.
MeshSpec read_mesh(const SceneSource& source, const MapReader& map);
/// One motion; an object's is not `by_hand`.
Motion read_motion(const SceneSource& source, const YamlNode& node, std::string_view what,
                   bool by_hand);
/// `dynamic`: the tool's mesh in T, and of which shell it is to be made. Throws SceneError, as all
/// of these.
MeshSpec read_dynamic_mesh(const SceneSource& source, const MapReader& map, ShellKind& shell);
/// `contact`: the model and its stiffness in W.
ContactSpec read_contact(const SceneSource& source, const MapReader& map);
/// A scene with the effect `body` and without a contact stiffness gets one from the body's mass.
void follow_body_mass(const MapReader& contact, Scene& scene);
/// Of the whole scene as read: refuses what a virtual tool does not go with, and warns of what only
/// it would read.
void check_virtual_tool(SceneSource& source, const MapReader& map, const Scene& scene);
/// `scene.objects` are read before. In effects_section.cpp.
std::vector<effects::EffectSpec> read_effects(SceneSource& source, const YamlNode& node,
                                              const Scene& scene);
/// The coupling as set by hand, or, where it is to be designed, `design` and a spec of defaults. In
/// coupling_section.cpp.
coupling::CouplingSpec read_coupling(SceneSource& source, const YamlNode& node,
                                     std::optional<DesignOptions>& design);
/// `device`: pose, tool, scales and clutch; see WorkspaceMapping for the frames.
WorkspaceMapping read_device(const MapReader& map);
/// `motions`, by name; in W, SI units.
std::map<std::string, Motion> read_motions(SceneSource& source, const YamlNode& node);

}  // namespace voxtouch::scene
