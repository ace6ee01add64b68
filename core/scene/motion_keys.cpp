// Motions of simulated hands and moving objects.
#include "core/scene/key_rows.hpp"

namespace voxtouch::scene::keys {
namespace {

// The columns are those of keys.cpp.
constexpr auto kCircle =
    std::to_array<Key>({{"centre", kVector, kRequired, kNone, "[m]"},
                        {"axis", kVector, kOptional, initial<&Motion::circle_axis>}});
constexpr auto kPress =
    std::to_array<Key>({{"button", kButton, kRequired, kNone, "Index of the button, from 0."},
                        {"from_s", kNotNegative, kRequired, kNone, "[s]"},
                        {"to_s", kPositive, kRequired, kNone, "[s]"}});
constexpr auto kTurn = std::to_array<Key>(
    {{"axis", kVector, kRequired, kNone, "Axis in the scene, right-handed."},
     {"angle_rad", kNumber, kRequired, kNone, "[rad]", "", nullptr, -3.1, 3.1},
     {"from_s", kNotNegative, kOptional, initial<&MotionRotation::from_s>, "[s]"},
     {"to_s", kPositive, kRequired, kNone, "[s]"}});
constexpr auto kObjectMotion = std::to_array<Key>(
    {{"path", kVectors, kRequired, kNone, "Way points [m], joined by straight lines.", "", nullptr,
      1},
     {"speed_m_per_s", kPositive, kOptional, initial<&Motion::speed_m_per_s>,
      "Largest speed on a line [m/s]."},
     {"hold_s", kNotNegative, kOptional, initial<&Motion::hold_s>, "Rest at each way point [s]."},
     {"repeat_from", kCount, kNotTogether, kNone,
      "Index from 0: the path repeats back and forth from this point to the last."},
     {"circle", kMap, kNotTogether, kNone, "", "", &circle}});
constexpr auto kMotion = joined(
    kObjectMotion,
    std::to_array<Key>({{"orientation", kQuaternion, kOptional, initial<&Motion::orientation>},
                        {"turn", kMap, kOptional, kNone, "", "", &turn},
                        {"press", kMaps, kOptional, kNone,
                         "Buttons that the hand presses during the motion.", "", &press}}));

}  // namespace

constinit const KeyGroup motion{
    "motion", "Motion of the tool's origin by a simulated hand, in the scene.", kMotion};
constinit const KeyGroup press{"", "", kPress};
constinit const KeyGroup turn{"", "Rotation of the hand about the device's tip, from rest to rest.",
                              kTurn};
constinit const KeyGroup circle{"", "Circle after the way points, starting at the last.", kCircle};
constinit const KeyGroup object_motion{
    "object_motion", "Motion of an object: its displacement since the session began.",
    kObjectMotion};

}  // namespace voxtouch::scene::keys
