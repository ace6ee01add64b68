#pragma once
/// The sections of a scene file, one function each. All throw SceneError; see scene_file.hpp for the keys.
#include "core/scene/map_reader.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch {

/// Entries of `static`; sets `origin` where one entry gives the grid's.
std::vector<MeshSpec> read_static_meshes(SceneSource& source, const YamlNode& node, std::optional<Vec3>& origin);
MeshSpec read_dynamic_mesh(SceneSource& source, const YamlNode& node, ShellKind& shell);
ContactSpec read_contact(SceneSource& source, const YamlNode& node);
/// In effects_section.cpp.
std::vector<EffectSpec> read_effects(SceneSource& source, const YamlNode& node);
/// The coupling as set by hand, or, where it is to be designed, `design` and a spec of defaults. In coupling_section.cpp.
CouplingSpec read_coupling(SceneSource& source, const YamlNode& node, std::optional<DesignAsk>& design);
DeviceSpec read_device(SceneSource& source, const YamlNode& node);
std::map<std::string, Motion> read_motions(SceneSource& source, const YamlNode& node);

}  // namespace voxtouch
