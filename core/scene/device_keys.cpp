// Device files.
#include "core/scene/key_rows.hpp"

namespace voxtouch::scene::keys {
namespace {

// clang-format off: one row a key, as in keys.cpp
// Above the largest a number is in the wrong unit (milliseconds, millimetres, per cent), not the
// property of a haptic device.
constexpr auto kDeviceFile = std::to_array<Key>(
    {{"device", kText, kRequired, "", "Its name."},
     {"rate_hz", kNumber, kRequired, "", "Samples a second [Hz].", "", nullptr, 1, 1e5},
     {"max_force_n", kPositive, kRequired, "", "[N]"},
     {"max_torque_nm", kNotNegative, kRequired, "", "0: gives none [Nm]."},
     {"max_stiffness_n_per_m", kPositive, kRequired, "",
      "What it can show, not what its structure has [N/m]."},
     {"mass_kg", kRange, kRequired, "",
      "Apparent at the tool, least and most over workspace and axes [kg]."},
     {"workspace_m", kSize, kOptional, "", "Edges of the box that the tool reaches [m]."},
     {"damping_ns_per_m", kNotNegative, kOptional, "", "The least [Ns/m]."},
     {"coulomb_friction_n", kNotNegative, kOptional, "", "[N]"},
     {"position_resolution_m", kNumber, kRequired, "", "[m]", "", nullptr, 0, 0.01},
     {"delay_s", kNumber, kOptional, "",
      "From the sample to the force, beside the hold of a period [s].", "", nullptr, 0, 1},
     {"force_bandwidth_hz", kPositive, kOptional, "", "Left out: no lag [Hz]."},
     {"rotation", kMap, kOptional, "", "", "", &device_rotation},
     {"jitter", kNumber, kOptional, "", "The longest period is (1 + jitter) / rate_hz.", "",
      nullptr, 0, 10},
     {"lost_in_a_row", kCount, kOptional, "", "Samples that may be lost one after the other.", "",
      nullptr, 0, 1000},
     {"grip", kWord, kRequired, "", "How it is held.", "pen arm"}});
constexpr auto kDeviceRotation = std::to_array<Key>(
    {{"inertia_kg_m2", kRange, kOptional, "", "[kg m^2]"},
     {"damping_nms_per_rad", kNotNegative, kOptional, "", "[Nms/rad]"},
     {"coulomb_friction_nm", kNotNegative, kOptional, "", "[Nm]"},
     {"orientation_resolution_rad", kNumber, kOptional, "", "[rad]", "", nullptr, 0, 0.1},
     {"max_stiffness_nm_per_rad", kPositive, kOptional, "", "[Nm/rad]"}});
// clang-format on

}  // namespace

constinit const KeyGroup device_file{"", "A device, as the coupling designer needs it.",
                                     kDeviceFile};
constinit const KeyGroup device_rotation{"", "Only and always where max_torque_nm is above 0.",
                                         kDeviceRotation};

}  // namespace voxtouch::scene::keys
