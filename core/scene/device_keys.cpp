// Device files.
#include "core/scene/key_rows.hpp"

namespace voxtouch::scene::keys {
namespace {

// The columns are those of keys.cpp.
// Above the largest a number is in the wrong unit (milliseconds, millimetres, per cent), not the
// property of a haptic device.
constexpr auto kDeviceFile = std::to_array<Key>(
    {{"device", kText, kRequired, none, "Name of the device."},
     {"rate_hz", kNumber, kRequired, none, "Sampling rate [Hz].", "", nullptr, 1, 1e5},
     {"max_force_n", kPositive, kRequired, none, "Largest force [N]."},
     {"max_torque_nm", kNotNegative, kRequired, none, "Largest torque [Nm]; 0: none."},
     {"max_stiffness_n_per_m", kPositive, kRequired, none,
      "Largest stiffness that it can display, not its structural stiffness [N/m]."},
     {"mass_kg", kRange, kRequired, none,
      "Apparent mass at the tool: smallest and largest over workspace and axes [kg]."},
     {"workspace_m", kSize, kOptional, none, "Edge lengths of the reachable box [m]."},
     {"damping_ns_per_m", kNotNegative, kOptional, none, "Smallest viscous damping [Ns/m]."},
     {"coulomb_friction_n", kNotNegative, kOptional, none, "Coulomb friction [N]."},
     {"position_resolution_m", kNumber, kRequired, none, "Encoder step [m].", "", nullptr, 0, 0.01},
     {"delay_s", kNumber, kOptional, none,
      "Delay from sample to force, excluding the hold of one period [s].", "", nullptr, 0, 1},
     {"force_bandwidth_hz", kPositive, kOptional, none,
      "Bandwidth of the force [Hz]. Default: no lag."},
     {"rotation", kMap, kOptional, none, "", "", &device_rotation},
     {"jitter", kNumber, kOptional, none, "The longest period is (1 + jitter) / rate_hz.", "",
      nullptr, 0, 10},
     {"lost_in_a_row", kCount, kOptional, none, "Largest number of consecutive samples lost.", "",
      nullptr, 0, 1000},
     {"grip", kWord, kRequired, none, "How the hand grips it.", "pen arm"},
     {"measured", kMap, kOptional, none, "", "", &device_measured}});
constexpr auto kDeviceMeasured = std::to_array<Key>(
    {{"date", kText, kRequired, none, "Day of the measurement."},
     {"command", kText, kRequired, none, "Command that measured."},
     {"serial", kText, kOptional, none, "Serial number, if the driver reports one."}});
constexpr auto kDeviceRotation = std::to_array<Key>(
    {{"inertia_kg_m2", kRange, kOptional, none, "Apparent inertia: smallest and largest [kg m^2]."},
     {"damping_nms_per_rad", kNotNegative, kOptional, none, "Smallest viscous damping [Nms/rad]."},
     {"coulomb_friction_nm", kNotNegative, kOptional, none, "Coulomb friction [Nm]."},
     {"orientation_resolution_rad", kNumber, kOptional, none, "Encoder step [rad].", "", nullptr, 0,
      0.1},
     {"max_stiffness_nm_per_rad", kPositive, kOptional, none,
      "Largest displayed stiffness [Nm/rad]."}});

}  // namespace

constinit const KeyGroup device_file{"", "Properties of a device that the coupling designer uses.",
                                     kDeviceFile};
constinit const KeyGroup device_rotation{
    "", "Required if max_torque_nm is above 0, otherwise refused.", kDeviceRotation};
constinit const KeyGroup device_measured{
    "", "Written by `voxtouch identify`: the figures are those of one device.", kDeviceMeasured};

}  // namespace voxtouch::scene::keys
