#pragma once
/// Reads a scene file strictly. Whatever is unknown, missing, doubled, of the wrong type, not finite or out of its range is
/// a SceneError that says where and what would be right; nothing is guessed and nothing is skipped.
///
/// ```yaml
/// scene: cup                       # required, a name
/// voxel_size: 0.002                # required, m
/// static:                          # required, at least one
///   - mesh: ../meshes/cup.obj      # required; beside the scene file
///     scale: 1                     # file units to metres
///     position: [0, 0, 0]          # m
///     orientation: [1, 0, 0, 0]    # w x y z, norm within 0.001 of 1
///     origin: [0, 0, 0]            # of the grid; on one static mesh at most
///     parts:                       # closed forms that stand for the mesh in the validator
///       - sphere: {centre: [0, 0, 0], radius: 0.01}
///       - box: {size: [1, 1, 1], position: [0, 0, 0], orientation: [1, 0, 0, 0]}
///       - cylinder: {radius: 1, length: 1, position: [0, 0, 0], orientation: [1, 0, 0, 0]}
/// dynamic: {mesh: ../meshes/sphere.obj, scale: 0.01, shell: exact}   # required; shell: exact | naive; static's keys but origin
/// contact: {model: adapted, stiffness_n_per_m: 10}   # required; model: original | adapted; per shell point
/// effects: []
/// coupling: {kind: shaping_filter, cutoff_hz: 100, damping_ratio: 0.707, gain: 1}
/// #         {kind: spring_damper, stiffness_n_per_m: 500, damping_ns_per_m: 2} or {kind: direct}; each may add, in W:
/// #         {stiffness_cap_n_per_m: 800, stiffness_cap_nm_per_rad: 2}             # what the contact may show at most
/// #         {injected_damping_ns_per_m: 3, injected_damping_nms_per_rad: 0.01, velocity_filter_hz: 100}   # in contact
/// # or let it be designed for the device; all keys but `design` may be left out, these are what they are then:
/// coupling: {design: auto, kind: auto, cutoff_hz: 5, gain_margin: 2, hand: pen, released: true, inject_damping: true,
///            run_infeasible: false}
/// #         kind: auto | shaping_filter | spring_damper | direct; cutoff_hz is a wish, the designer may raise it
/// #         stiffness_cap_n_per_m, stiffness_cap_nm_per_rad: fixed, in W; where both are left out the designer may cap
/// #         hand: pen | arm | any_passive | {mass_kg: [0.02, 0.2], damping_ns_per_m: [0.5, 8],
/// #         stiffness_n_per_m: [20, 800]} with all or none of inertia_kg_m2, damping_nms_per_rad, stiffness_nm_per_rad;
/// #         left out: as the device is held. released: must be stable with nobody holding it too
/// #         run_infeasible: run what was found even where the design says that it will not do
/// device: {position_scale: 1, force_scale: 1, pose: {position: [0, 0, 0], orientation: [1, 0, 0, 0]},
///          tool: {position: [0, 0, 0], orientation: [1, 0, 0, 0]}, clutch_button: 0}
/// motions:
///   slide: {path: [[0, 0, 0], [0.1, 0, 0]], speed_m_per_s: 0.05, hold_s: 0.2, repeat_from: 0, orientation: [1, 0, 0, 0]}
///   circle: {path: [[0.1, 0, 0]], circle: {centre: [0, 0, 0], axis: [0, 0, 1]}, speed_m_per_s: 0.05}
/// ```
///
/// `cutoff_hz` is w0 / (2 pi): the -3 dB frequency only for damping_ratio = 1/sqrt(2).
#include <filesystem>
#include <string>

#include "core/scene/scene.hpp"
#include "core/scene/scene_error.hpp"

namespace voxtouch {

/// Period that a scene's coupling is judged for; check_device judges it again for the device's own.
inline constexpr double kSceneSampleTimeS = 1e-3;

/// Reads `file`. Throws SceneError. Relative mesh paths start at the scene file's folder.
Scene load_scene(const std::filesystem::path& file);

/// The same for text that stands in memory; `file` names it and says where its meshes are.
Scene parse_scene(const std::string& text, const std::filesystem::path& file);

}  // namespace voxtouch
