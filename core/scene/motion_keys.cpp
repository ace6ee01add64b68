// What simulated hands and moving objects do.
#include "core/scene/key_rows.hpp"

namespace voxtouch::scene::keys {
namespace {

// clang-format off: one row a key, as in keys.cpp
constexpr auto kCircle = std::to_array<Key>(
    {{"centre", kVector, kRequired, "", "[m]"}, {"axis", kVector, kOptional, "[0, 0, 1]"}});
constexpr auto kPress = std::to_array<Key>({{"button", kButton, kRequired, "", "Counted from 0."},
                                            {"from_s", kNotNegative, kRequired, "", "[s]"},
                                            {"to_s", kPositive, kRequired, "", "[s]"}});
constexpr auto kTurn =
    std::to_array<Key>({{"axis", kVector, kRequired, "", "In the scene, right-handed."},
                        {"angle_rad", kNumber, kRequired, "", "[rad]", "", nullptr, -3.1, 3.1},
                        {"from_s", kNotNegative, kOptional, "0", "[s]"},
                        {"to_s", kPositive, kRequired, "", "[s]"}});
constexpr auto kWay = std::to_array<Key>(
    {{"path", kVectors, kRequired, "", "Way points [m], walked in straight pieces.", "", nullptr,
      1},
     {"speed_m_per_s", kPositive, kOptional, "0.05", "Largest speed of a straight piece [m/s]."},
     {"hold_s", kNotNegative, kOptional, "0", "Rest at each way point [s]."},
     {"repeat_from", kCount, kNotTogether, "",
      "Back and forth between this point, counted from 0, and the last, for ever."},
     {"circle", kMap, kNotTogether, "", "", "", &circle}});
constexpr auto kMotion =
    joined(kWay, std::to_array<Key>({{"orientation", kQuaternion, kOptional, "[1, 0, 0, 0]"},
                                     {"turn", kMap, kOptional, "", "", "", &turn},
                                     {"press", kMaps, kOptional, "",
                                      "Buttons that the hand holds down meanwhile.", "", &press}}));
// clang-format on

}  // namespace

constinit const KeyGroup motion{
    "motion", "What a simulated hand does with the tool's origin, in the scene.", kMotion};
constinit const KeyGroup press{"", "", kPress};
constinit const KeyGroup turn{
    "", "The hand turns from its orientation, about the device's tip, from rest to rest.", kTurn};
constinit const KeyGroup circle{"", "Round and round after the way points, beginning at the last.",
                                kCircle};
constinit const KeyGroup way{
    "way", "How an object moves: its displacement over the time since the session's begin.", kWay};

}  // namespace voxtouch::scene::keys
