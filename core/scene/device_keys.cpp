// Device files.
#include "core/scene/key_rows.hpp"

namespace voxtouch::scene::keys {
namespace {

// The columns are those of keys.cpp.
// Above the largest a number is in the wrong unit (milliseconds, millimetres, per cent), not the
// property of a haptic device.
constexpr auto kDeviceFile = std::to_array<Key>(
    {{"device", kText, kRequired, kNone, "Name of the device."},
     {"rate_hz", kNumber, kRequired, kNone, "Sampling rate [Hz].", "", nullptr, 1, 1e5},
     {"max_force_n", kPositive, kRequired, kNone, "Largest force [N]."},
     {"max_torque_nm", kNotNegative, kRequired, kNone, "Largest torque [Nm]; 0: none."},
     {"max_stiffness_n_per_m", kPositive, kRequired, kNone,
      "Largest stiffness that it can display, not its structural stiffness [N/m]."},
     {"mass_kg", kRange, kRequired, kNone,
      "Apparent mass at the tool: smallest and largest over workspace and axes [kg]."},
     {"workspace_m", kSize, kOptional, kNone, "Edge lengths of the reachable box [m]."},
     {"damping_ns_per_m", kNotNegative, kOptional, kNone, "Smallest viscous damping [Ns/m]."},
     {"coulomb_friction_n", kNotNegative, kOptional, kNone, "Coulomb friction [N]."},
     {"position_resolution_m", kNumber, kRequired, kNone, "Encoder step [m].", "", nullptr, 0,
      0.01},
     {"delay_s", kNumber, kOptional, kNone,
      "Delay from sample to force, excluding the hold of one period [s].", "", nullptr, 0, 1},
     {"force_bandwidth_hz", kPositive, kOptional, kNone,
      "Bandwidth of the force [Hz]. Default: no lag."},
     {"rotation", kMap, kOptional, kNone, "", "", &device_rotation},
     {"jitter", kNumber, kOptional, kNone, "The longest period is (1 + jitter) / rate_hz.", "",
      nullptr, 0, 10},
     {"consecutive_losses", kCount, kOptional, kNone, "Largest number of consecutive samples lost.",
      "", nullptr, 0, 1000},
     {"grip", kWord, kRequired, kNone, "How the hand grips it.", "pen arm"},
     {"measured", kMap, kOptional, kNone, "", "", &device_measured}});
constexpr auto kDeviceMeasured = std::to_array<Key>(
    {{"date", kText, kRequired, kNone, "Day of the measurement."},
     {"command", kText, kRequired, kNone, "Command that measured."},
     {"serial", kText, kOptional, kNone, "Serial number, if the driver reports one."}});
constexpr auto kDeviceRotation = std::to_array<Key>(
    {{"inertia_kg_m2", kRange, kOptional, kNone,
      "Apparent inertia: smallest and largest [kg m^2]."},
     {"damping_nms_per_rad", kNotNegative, kOptional, kNone, "Smallest viscous damping [Nms/rad]."},
     {"coulomb_friction_nm", kNotNegative, kOptional, kNone, "Coulomb friction [Nm]."},
     {"orientation_resolution_rad", kNumber, kOptional, kNone, "Encoder step [rad].", "", nullptr,
      0, 0.1},
     {"max_stiffness_nm_per_rad", kPositive, kOptional, kNone,
      "Largest displayed stiffness [Nm/rad]."}});

}  // namespace

constinit const KeyGroup device_file{"", "Properties of a device that the coupling designer uses.",
                                     kDeviceFile};
constinit const KeyGroup device_rotation{
    "", "Required if max_torque_nm is above 0, otherwise refused.", kDeviceRotation};
constinit const KeyGroup device_measured{
    "", "Written by `voxtouch identify`: the figures are those of one device.", kDeviceMeasured};

}  // namespace voxtouch::scene::keys
