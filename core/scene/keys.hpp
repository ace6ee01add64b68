#pragma once
/// The keys of scene and device files: one table for the reader, its schema and the manual. The
/// keys of an effect are in core/effects/effect_kind.hpp.
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
  kMap,          ///< with the keys of `group`, or one of `words` if there are any
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
  kWithFirst,     ///< only with the group's first key
  kWithoutFirst,  ///< only without the group's first key
};

struct KeyGroup;

struct Key {
  std::string_view name = {};  ///< with its unit, if any (`speed_m_per_s`)
  KeyKind kind = KeyKind::kText;
  KeyRule rule = KeyRule::kOptional;
  std::string (*standard)() = nullptr;  ///< the default as text of the file; null: none
  std::string_view meaning = {};  ///< a sentence for the manual and for editors; empty for a single
                                  ///< map, whose group has it
  std::string_view words = {};    ///< the choices, parted by single spaces
  const KeyGroup* group = nullptr;
  double low = 0.0,
         high = std::numeric_limits<double>::infinity();  ///< of a kNumber or kCount; `low`: least
                                                          ///< entries of a list
};

/// The keys of one map, in the order in which they are listed.
struct KeyGroup {
  std::string_view defined = {};  ///< its name in the schema, if several places use it
  std::string_view meaning = {};
  std::span<const Key> keys = {};
};

/// Words that are parted by single spaces.
std::vector<std::string_view> words_of(std::string_view list);

namespace keys {

/// Names used by rules between keys, in addition to the rows: the contact model that weighs points
/// by area, kinds of a manual coupling, and keys that an effect without partial strength lacks.
inline constexpr std::string_view kModelByArea = "field",
                                  kKindsByHand = "shaping_filter spring_damper direct",
                                  kNotEverywhere = "region gain on";

extern const KeyGroup scene, static_mesh, dynamic_mesh, object, contact, tool, effect, coupling,
    device, motion;
extern const KeyGroup pose, part, sphere, box, cylinder, region, region_sphere, hand, press, turn,
    circle;
/// A device file, its part for devices with torque, and the source of its figures.
extern const KeyGroup device_file, device_rotation, device_measured;
/// A motion, without the keys for hands.
extern const KeyGroup object_motion;

}  // namespace keys
}  // namespace voxtouch::scene
