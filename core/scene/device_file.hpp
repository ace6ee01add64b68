#pragma once
/// Reads a device file strictly: the figures of a device, to design a coupling for it and to
/// simulate it. An unknown or duplicate key, a wrong type, or a value that is not finite or out of
/// range is a SceneError with its place and the valid values. All missing keys are reported at
/// once. Optional keys have defaults by class (device_figures.hpp), which the reader lists.
///
/// deploy/devices/README.md explains the keys; deploy/devices/touch.yaml is an example.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/scene_error.hpp"
#include "core/types/device_description.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::scene {

/// Source of a file's figures.
struct Measurement {
  std::string date, command;
  std::string serial;  ///< of the device; empty: its driver reported none
};

struct DeviceFile {
  /// As for a simulated device: `delay_s` is the whole delay from a sample to its force. The slew
  /// limits follow from the other figures (derive_slew_limits).
  DeviceDescription description;
  std::optional<Vec3> workspace_m;  ///< edges of the box that the tool reaches, along the axes of D
  std::vector<std::string> assumed;  ///< defaults of missing keys, such as "damping_ns_per_m 0.005"
  std::optional<Measurement> measured;  ///< absent: the figures are assumed
};

/// Reads `file`. Throws SceneError.
DeviceFile load_device_file(const std::filesystem::path& file);

/// The same for text in memory; messages name `file`.
DeviceFile parse_device_file(const std::string& text, const std::filesystem::path& file);

/// Lists the defaults of missing keys; empty if there are none.
std::string assumed_sentence(const DeviceFile& file);

/// Date and command of the measurement; empty without one.
std::string measured_sentence(const DeviceFile& file);

/// The reason if `file` describes another device than `driver`: a different name, serial number,
/// rate, grip or torque. Empty if they agree. `serial`: empty if the driver reports none; then the
/// name decides.
std::string other_device(const DeviceFile& file, const DeviceDescription& driver,
                         std::string_view serial);

/// The file's figures within the driver's limits of force, torque and stiffness. The delay of the
/// file is the whole delay from a sample to its force; for a device that sends commands a period
/// later this period is subtracted. Requires that `other_device` is empty.
DeviceDescription measured_device(const DeviceFile& file, const DeviceDescription& driver);

}  // namespace voxtouch::scene
