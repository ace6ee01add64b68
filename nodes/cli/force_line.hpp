#pragma once
/// The force preview as one or two lines.
#include <string>
#include <string_view>
#include <vector>

#include "core/device_fit/force_preview.hpp"

namespace voxtouch::cli {

/// For a device without torque: the effect of a rotation of the tool
/// (core/rendering/latched_rotation.hpp).
inline constexpr std::string_view kRotationIsLatched =
    "The device returns no torque: only translation of the hand is resisted, rotation is not.";

/// The displayed stiffness at the tool's reach if the tool rotates under the lever of the contact,
/// and the limit of a body's grip. Empty if neither applies.
std::string contact_line(const device_fit::ForcePreview& preview, const std::string& device);

/// "Certified: 371 N/m, gain margin 2. sim-phantom saturates at 8.5 N, 22.9 mm deep. Limited by:
/// ..."; then `contact_line`, unless it is empty.
std::vector<std::string> force_lines(const device_fit::ForcePreview& preview,
                                     const std::string& device);

}  // namespace voxtouch::cli
