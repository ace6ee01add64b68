#pragma once
/// The sections of a scene file, one function each. All throw SceneError; see scene_file.hpp for the keys.
#include "core/scene/map_reader.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch {

/// Entries of `static`: meshes, objects, and the grid's origin where one entry gives it. `scene.contact` is read before: the
/// objects' material where they name none. In static_section.cpp.
void read_static(SceneSource& source, const YamlNode& node, Scene& scene);
/// The keys of one mesh: mesh, scale, position, orientation, parts.
MeshSpec read_mesh(const SceneSource& source, const MapReader& map);
/// One motion; an object's has no orientation.
Motion read_motion(const SceneSource& source, const YamlNode& node, std::string_view what, bool with_orientation);
MeshSpec read_dynamic_mesh(SceneSource& source, const YamlNode& node, ShellKind& shell);
ContactSpec read_contact(SceneSource& source, const YamlNode& node);
/// `scene.objects` are read before. In effects_section.cpp.
std::vector<EffectSpec> read_effects(SceneSource& source, const YamlNode& node, const Scene& scene);
/// The coupling as set by hand, or, where it is to be designed, `design` and a spec of defaults. In coupling_section.cpp.
CouplingSpec read_coupling(SceneSource& source, const YamlNode& node, std::optional<DesignOptions>& design);
WorkspaceMapping read_device(SceneSource& source, const YamlNode& node);
std::map<std::string, Motion> read_motions(SceneSource& source, const YamlNode& node);

}  // namespace voxtouch
