#pragma once
/// Reads a device file strictly: a device that the project has no driver for, or another one than
/// its driver says, to be designed for and rehearsed. Whatever is unknown, doubled, of the wrong
/// type, not finite or out of its range is a SceneError that says where and what would be right.
/// All that is missing is reported at once. What data sheets leave out has standards by class
/// (device_figures.hpp), and the reader says which ones it took.
///
/// ```yaml
/// device: third                     # a name
/// rate_hz: 1000                     # 1 to 100000
/// max_force_n: 22
/// max_torque_nm: 0                  # 0: gives none
/// max_stiffness_n_per_m: 1000       # what it can show, not what its structure has
/// mass_kg: [0.08, 0.16]             # apparent at the tool, least and most over workspace and
/// axes; or one number position_resolution_m: 2e-5 grip: pen                         # pen: a
/// stylus | arm # May be left out from here on. workspace_m: [0.4, 0.6, 0.8]      # edges of the
/// box that the tool reaches; left out: unknown damping_ns_per_m: 0.005           # the least
/// coulomb_friction_n: 0.2
/// delay_s: 0.001                    # from the sample to the force, excluding the hold of a period
/// force_bandwidth_hz: 50            # left out: no lag
/// rotation: {inertia_kg_m2: [0.1, 0.1], damping_nms_per_rad: 0.3, coulomb_friction_nm: 0.1,
/// orientation_resolution_rad: 1e-4,
///            max_stiffness_nm_per_rad: 300}   # only where max_torque_nm is above 0
/// jitter: 0.2                       # the longest period is (1 + jitter) / rate_hz
/// lost_in_a_row: 1                  # samples that may be lost one after the other
/// measured: {date: 2026-11-29, command: voxtouch identify --device x, serial: "7"}
/// ```
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/scene_error.hpp"
#include "core/types/device_description.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::scene {

/// Where the figures of a file come from.
struct Measurement {
  std::string date, command;
  std::string serial;  ///< of the device; empty: its driver reported none
};

struct DeviceFile {
  /// As of a simulated device: `delay_s` is all that lies between a sample and its force. How fast
  /// force may change is no key: it follows from the other numbers (derive_slew_limits).
  DeviceDescription description;
  std::optional<Vec3> workspace_m;  ///< edges of the box that the tool reaches, along the axes of D
  std::vector<std::string>
      assumed;  ///< "damping_ns_per_m 0.005": what the file leaves out, with what stands for it
  std::optional<Measurement> measured;  ///< absent: the figures are assumed
};

/// Reads `file`. Throws SceneError.
DeviceFile load_device_file(const std::filesystem::path& file);

/// The same for text that stands in memory; `file` names it in messages.
DeviceFile parse_device_file(const std::string& text, const std::filesystem::path& file);

/// "figures that the file leaves out, with the standards of a stylus: ..."; empty where it leaves
/// nothing out.
std::string assumed_sentence(const DeviceFile& file);

/// Date and command of the measurement; empty where the file names none.
std::string measured_sentence(const DeviceFile& file);

/// Why `file` cannot be that of the open device that `driver` describes: its name, serial number,
/// rate, grip or torque differ. Empty: nothing contradicts it. `serial`: empty where the driver
/// reports none; then the name decides.
std::string other_device(const DeviceFile& file, const DeviceDescription& driver,
                         std::string_view serial);

/// The file's figures within the driver's limits of force, torque and stiffness. The file counts
/// the whole delay from a sample to its force; that of a device whose command may leave a period
/// later is stored without this period. Requires that `other_device` is empty.
DeviceDescription measured_device(const DeviceFile& file, const DeviceDescription& driver);

}  // namespace voxtouch::scene
