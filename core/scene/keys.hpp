#pragma once
/// The keys of scene and device files: one table that the reader, its schema and the manual are
/// made from. What a kind of effect takes stands in the effects' own table,
/// core/effects/effect_kind.hpp.
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace voxtouch::scene {

/// How a value is written; the reader and the schema each have one place for every kind.
enum class KeyKind : std::uint8_t {
  kText,         ///< not empty
  kName,         ///< that may become part of file and topic names
  kFlag,         ///< true or false
  kPositive,     ///< a number above 0
  kNotNegative,  ///< a number from 0
  kNumber,       ///< a number within [low, high]
  kCount,        ///< 0, 1, 2, ...
  kButton,       ///< a count up to kLastButton
  kRange,        ///< [least, most] with 0 <= least <= most
  kVector,       ///< [x, y, z]
  kVectors,      ///< a list of them
  kSize,         ///< [x, y, z], above 0 along each axis
  kQuaternion,   ///< [w, x, y, z] of unit length
  kWord,         ///< one of `words`
  kMap,          ///< with the keys of `group`, or one of `words` where there are some
  kMaps,         ///< a list of such maps
  kNamedMaps,    ///< a map of names to such maps
};
inline constexpr std::uint32_t kLastButton = 31;

/// Which keys go with which.
enum class KeyRule : std::uint8_t {
  kOptional,
  kRequired,
  kOneOf,         ///< exactly one of the group's keys with this rule
  kNotTogether,   ///< at most one of them
  kAllOrNone,     ///< all of them or none
  kWithFirst,     ///< only where the group's first key is there
  kWithoutFirst,  ///< only where it is not
};

struct KeyGroup;

struct Key {
  std::string_view name = {};  ///< with the unit, where it has one (`speed_m_per_s`)
  KeyKind kind = KeyKind::kText;
  KeyRule rule = KeyRule::kOptional;
  std::string (*standard)() =
      nullptr;  ///< what a key that is left out means, as it would stand in the file; null: nothing
  std::string_view meaning =
      {};  ///< a sentence for the manual and for editors; that of a single map stands in its group
  std::string_view words = {};  ///< the choices, parted by single spaces
  const KeyGroup* group = nullptr;
  double low = 0.0,
         high = std::numeric_limits<double>::infinity();  ///< of a kNumber or kCount; `low`: least
                                                          ///< entries of a list
};

/// The keys of one map, in the order in which they are listed.
struct KeyGroup {
  std::string_view defined = {};  ///< its name in the schema, where it stands at several places
  std::string_view meaning = {};
  std::span<const Key> keys = {};
};

/// Words that are parted by single spaces.
std::vector<std::string_view> words_of(std::string_view list);

namespace keys {

/// What rules between keys name, in addition to the rows: the contact model that weighs points by
/// their area, kinds of a coupling that is set by hand, and what an effect that works everywhere,
/// all or nothing, does not have.
inline constexpr std::string_view kModelByArea = "field",
                                  kKindsByHand = "shaping_filter spring_damper direct",
                                  kNotEverywhere = "region gain on";

extern const KeyGroup scene, static_mesh, dynamic_mesh, object, contact, tool, effect, coupling,
    device, motion;
extern const KeyGroup pose, part, sphere, box, cylinder, region, region_sphere, hand, press, turn,
    circle;
/// A device file, its part for devices that give torque, and where its figures come from.
extern const KeyGroup device_file, device_rotation, device_measured;
/// A motion without what only a hand has.
extern const KeyGroup object_motion;

}  // namespace keys
}  // namespace voxtouch::scene
