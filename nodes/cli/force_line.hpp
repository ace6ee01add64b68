#pragma once
/// The force preview as a line.
#include <string>
#include <string_view>

#include "core/device_fit/force_preview.hpp"

namespace voxtouch::cli {

/// For a device without torque: the effect of a rotation of the tool
/// (core/rendering/latched_rotation.hpp).
inline constexpr std::string_view kTurnsAreHeld =
    "The device returns no torque: only translation of the hand is resisted, rotation is not.";

/// The displayed stiffness at the tool's reach if the tool rotates under the lever of the contact,
/// and the limit of a body's grip. Empty if neither applies.
std::string contact_line(const device_fit::ForcePreview& preview, const std::string& device);

/// Both: "Certified: 371 N/m with a gain margin of 2. sim-phantom saturates at 8.5 N, 22.9 mm deep.
/// Limit: ..."
std::string force_line(const device_fit::ForcePreview& preview, const std::string& device);

}  // namespace voxtouch::cli
