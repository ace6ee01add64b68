// What simulated hands and moving objects do.
#include "core/scene/key_rows.hpp"

namespace voxtouch::scene::keys {
namespace {

// The columns are those of keys.cpp.
constexpr auto kCircle =
    std::to_array<Key>({{"centre", kVector, kRequired, none, "[m]"},
                        {"axis", kVector, kOptional, initial<&Motion::circle_axis>}});
constexpr auto kPress = std::to_array<Key>({{"button", kButton, kRequired, none, "Counted from 0."},
                                            {"from_s", kNotNegative, kRequired, none, "[s]"},
                                            {"to_s", kPositive, kRequired, none, "[s]"}});
constexpr auto kTurn =
    std::to_array<Key>({{"axis", kVector, kRequired, none, "In the scene, right-handed."},
                        {"angle_rad", kNumber, kRequired, none, "[rad]", "", nullptr, -3.1, 3.1},
                        {"from_s", kNotNegative, kOptional, initial<&MotionTurn::from_s>, "[s]"},
                        {"to_s", kPositive, kRequired, none, "[s]"}});
constexpr auto kObjectMotion = std::to_array<Key>(
    {{"path", kVectors, kRequired, none, "Way points [m], walked in straight pieces.", "", nullptr,
      1},
     {"speed_m_per_s", kPositive, kOptional, initial<&Motion::speed_m_per_s>,
      "Largest speed of a straight piece [m/s]."},
     {"hold_s", kNotNegative, kOptional, initial<&Motion::hold_s>, "Rest at each way point [s]."},
     {"repeat_from", kCount, kNotTogether, none,
      "Back and forth between this point, counted from 0, and the last, for ever."},
     {"circle", kMap, kNotTogether, none, "", "", &circle}});
constexpr auto kMotion = joined(
    kObjectMotion,
    std::to_array<Key>({{"orientation", kQuaternion, kOptional, initial<&Motion::orientation>},
                        {"turn", kMap, kOptional, none, "", "", &turn},
                        {"press", kMaps, kOptional, none,
                         "Buttons that the hand holds down meanwhile.", "", &press}}));

}  // namespace

constinit const KeyGroup motion{
    "motion", "What a simulated hand does with the tool's origin, in the scene.", kMotion};
constinit const KeyGroup press{"", "", kPress};
constinit const KeyGroup turn{
    "", "The hand turns from its orientation, about the device's tip, from rest to rest.", kTurn};
constinit const KeyGroup circle{"", "Round and round after the way points, beginning at the last.",
                                kCircle};
constinit const KeyGroup object_motion{
    "object_motion",
    "How an object moves: its displacement over the time since the session's begin.",
    kObjectMotion};

}  // namespace voxtouch::scene::keys
