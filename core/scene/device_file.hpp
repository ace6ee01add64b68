#pragma once
/// Reads a device file strictly: a device that the project has no driver for, or another one than its driver says, as the
/// coupling designer needs it. Whatever is unknown, missing, doubled, of the wrong type, not finite or out of its range
/// is a SceneError that says where and what would be right; nothing is guessed.
///
/// ```yaml
/// device: third                     # a name
/// rate_hz: 1000                     # 1 to 100000
/// max_force_n: 22
/// max_torque_nm: 0                  # 0: gives none
/// max_stiffness_n_per_m: 1000       # what it can show, not what its structure has
/// mass_kg: [0.08, 0.16]             # apparent at the tool, least and most over workspace and axes
/// damping_ns_per_m: 0.005           # the least
/// coulomb_friction_n: 0.2
/// position_resolution_m: 2e-5
/// delay_s: 0.001                    # from the sample to the force, beside the hold of a period
/// force_bandwidth_hz: 50            # may be left out: no lag
/// rotation: {inertia_kg_m2: [0.1, 0.1], damping_nms_per_rad: 0.3, coulomb_friction_nm: 0.1, orientation_resolution_rad: 1e-4,
///            max_stiffness_nm_per_rad: 300}   # only and always where max_torque_nm is above 0
/// jitter: 0.2                       # the longest period is (1 + jitter) / rate_hz
/// lost_in_a_row: 1                  # samples that may be lost one after the other
/// grip: pen                         # pen | arm
/// ```
#include <filesystem>
#include <string>

#include "core/coupling/design/loop_parts.hpp"
#include "core/scene/scene_error.hpp"

namespace voxtouch::scene {

/// Reads `file`. Throws SceneError.
coupling::design::DeviceModel load_device_file(const std::filesystem::path& file);

/// The same for text that stands in memory; `file` names it in messages.
coupling::design::DeviceModel parse_device_file(const std::string& text, const std::filesystem::path& file);

}  // namespace voxtouch::scene
