// Device files.
#include "core/scene/key_rows.hpp"

namespace voxtouch::scene::keys {
namespace {

// The columns are those of keys.cpp.
// Above the largest a number is in the wrong unit (milliseconds, millimetres, per cent), not the
// property of a haptic device.
constexpr auto kDeviceFile = std::to_array<Key>(
    {{"device", kText, kRequired, none, "Its name."},
     {"rate_hz", kNumber, kRequired, none, "Samples a second [Hz].", "", nullptr, 1, 1e5},
     {"max_force_n", kPositive, kRequired, none, "[N]"},
     {"max_torque_nm", kNotNegative, kRequired, none, "0: gives none [Nm]."},
     {"max_stiffness_n_per_m", kPositive, kRequired, none,
      "What it can show, not what its structure has [N/m]."},
     {"mass_kg", kRange, kRequired, none,
      "Apparent at the tool, least and most over workspace and axes [kg]."},
     {"workspace_m", kSize, kOptional, none, "Edges of the box that the tool reaches [m]."},
     {"damping_ns_per_m", kNotNegative, kOptional, none, "The least [Ns/m]."},
     {"coulomb_friction_n", kNotNegative, kOptional, none, "[N]"},
     {"position_resolution_m", kNumber, kRequired, none, "[m]", "", nullptr, 0, 0.01},
     {"delay_s", kNumber, kOptional, none,
      "From the sample to the force, without the hold of a period [s].", "", nullptr, 0, 1},
     {"force_bandwidth_hz", kPositive, kOptional, none, "Left out: no lag [Hz]."},
     {"rotation", kMap, kOptional, none, "", "", &device_rotation},
     {"jitter", kNumber, kOptional, none, "The longest period is (1 + jitter) / rate_hz.", "",
      nullptr, 0, 10},
     {"lost_in_a_row", kCount, kOptional, none, "Samples that may be lost one after the other.", "",
      nullptr, 0, 1000},
     {"grip", kWord, kRequired, none, "How it is held.", "pen arm"},
     {"measured", kMap, kOptional, none, "", "", &device_measured}});
constexpr auto kDeviceMeasured = std::to_array<Key>(
    {{"date", kText, kRequired, none, "Day of the measurement."},
     {"command", kText, kRequired, none, "What measured."},
     {"serial", kText, kOptional, none, "Serial number, if the driver reports one."}});
constexpr auto kDeviceRotation = std::to_array<Key>(
    {{"inertia_kg_m2", kRange, kOptional, none, "[kg m^2]"},
     {"damping_nms_per_rad", kNotNegative, kOptional, none, "[Nms/rad]"},
     {"coulomb_friction_nm", kNotNegative, kOptional, none, "[Nm]"},
     {"orientation_resolution_rad", kNumber, kOptional, none, "[rad]", "", nullptr, 0, 0.1},
     {"max_stiffness_nm_per_rad", kPositive, kOptional, none, "[Nm/rad]"}});

}  // namespace

constinit const KeyGroup device_file{"", "A device, as the coupling designer needs it.",
                                     kDeviceFile};
constinit const KeyGroup device_rotation{"", "Only and always where max_torque_nm is above 0.",
                                         kDeviceRotation};
constinit const KeyGroup device_measured{
    "", "Written by `voxtouch identify`: the figures are those of one device.", kDeviceMeasured};

}  // namespace voxtouch::scene::keys
