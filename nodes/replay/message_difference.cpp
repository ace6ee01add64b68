#include "nodes/replay/message_difference.hpp"

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

#include <fmt/format.h>

namespace voxtouch::replay {
namespace {

enum class Word : std::uint8_t {
  kDouble,
  kUnsigned,
  kSigned,
  kShort,
  kFloat
};  ///< 8, 8, 8, 4 and 4 bytes

/// A field of a ring's message: `count` words in a row.
struct MessageField {
  std::string_view name;
  std::size_t offset = 0, size = 0;
  Word word = Word::kDouble;
  std::span<const std::string_view> parts = {};
};

constexpr std::string_view kVectorParts[] = {".x", ".y", ".z"};
constexpr std::string_view kPoseParts[] = {".position.x",    ".position.y",    ".position.z",
                                           ".orientation.x", ".orientation.y", ".orientation.z",
                                           ".orientation.w"};
constexpr std::string_view kWrenchParts[] = {".force.x",  ".force.y",  ".force.z",
                                             ".torque.x", ".torque.y", ".torque.z"};

template <class Field>
constexpr MessageField field(std::string_view name, std::size_t offset) {
  MessageField out{name, offset, sizeof(Field)};
  if constexpr (std::is_same_v<Field, std::uint64_t>)
    out.word = Word::kUnsigned;
  if constexpr (std::is_same_v<Field, std::int64_t>)
    out.word = Word::kSigned;
  if constexpr (std::is_same_v<Field, std::uint32_t>)
    out.word = Word::kShort;
  if constexpr (std::is_same_v<Field, float>)
    out.word = Word::kFloat;
  static_assert(std::is_same_v<Field, std::uint32_t> || std::is_same_v<Field, float> ||
                    sizeof(Field) % 8 == 0,
                "a word of different size");
  if constexpr (std::is_same_v<Field, msg::geometry_msgs_Vector3> ||
                std::is_same_v<Field, msg::geometry_msgs_Point>)
    out.parts = kVectorParts;
  if constexpr (std::is_same_v<Field, msg::geometry_msgs_Pose>)
    out.parts = kPoseParts;
  if constexpr (std::is_same_v<Field, msg::geometry_msgs_Wrench>)
    out.parts = kWrenchParts;
  return out;
}

#define VOXTOUCH_FIELD(type, name) field<decltype(type::name)>(#name, offsetof(type, name))
using Contact = msg::ContactState;
constexpr MessageField kContactFields[] = {VOXTOUCH_FIELD(Contact, session_id),
                                           VOXTOUCH_FIELD(Contact, sequence_number),
                                           VOXTOUCH_FIELD(Contact, sample_time_ns),
                                           VOXTOUCH_FIELD(Contact, tool_pose),
                                           VOXTOUCH_FIELD(Contact, object_pose),
                                           VOXTOUCH_FIELD(Contact, wrench),
                                           VOXTOUCH_FIELD(Contact, contact_wrench),
                                           VOXTOUCH_FIELD(Contact, effects_wrench),
                                           VOXTOUCH_FIELD(Contact, mean_normal),
                                           VOXTOUCH_FIELD(Contact, deepest_point),
                                           VOXTOUCH_FIELD(Contact, deepest_depth_m),
                                           VOXTOUCH_FIELD(Contact, residual_m),
                                           VOXTOUCH_FIELD(Contact, coherence),
                                           VOXTOUCH_FIELD(Contact, stiffness_bound_n_per_m),
                                           VOXTOUCH_FIELD(Contact, stiffness),
                                           VOXTOUCH_FIELD(Contact, spring_n_per_m),
                                           VOXTOUCH_FIELD(Contact, series_m_per_n),
                                           VOXTOUCH_FIELD(Contact, series_effects_m_per_n),
                                           VOXTOUCH_FIELD(Contact, series_rad_per_nm),
                                           VOXTOUCH_FIELD(Contact, supplied_energy_j),
                                           VOXTOUCH_FIELD(Contact, scene_time_ns),
                                           VOXTOUCH_FIELD(Contact, time_spent_ns),
                                           VOXTOUCH_FIELD(Contact, surface_hits),
                                           VOXTOUCH_FIELD(Contact, interior_hits),
                                           VOXTOUCH_FIELD(Contact, points_tested),
                                           VOXTOUCH_FIELD(Contact, model),
                                           VOXTOUCH_FIELD(Contact, flags),
                                           VOXTOUCH_FIELD(Contact, queries)};
using Command = msg::ForceCommand;
constexpr MessageField kCommandFields[] = {VOXTOUCH_FIELD(Command, session_id),
                                           VOXTOUCH_FIELD(Command, sequence_number),
                                           VOXTOUCH_FIELD(Command, sample_time_ns),
                                           VOXTOUCH_FIELD(Command, valid_until_ns),
                                           VOXTOUCH_FIELD(Command, wrench),
                                           VOXTOUCH_FIELD(Command, energy_j),
                                           VOXTOUCH_FIELD(Command, energy_rotation_j),
                                           VOXTOUCH_FIELD(Command, status),
                                           VOXTOUCH_FIELD(Command, injected_n)};
#undef VOXTOUCH_FIELD

/// The fields are adjacent and cover the whole message, so a new field is not omitted.
template <std::size_t N>
constexpr bool whole(const MessageField (&fields)[N], std::size_t size) {
  std::size_t at = 0;
  for (const MessageField& one : fields) {
    if (one.offset != at)
      return false;
    at += one.size;
  }
  return at == size;
}
static_assert(whole(kContactFields, sizeof(Contact)) && whole(kCommandFields, sizeof(Command)));

template <class T>
T word_at(const std::byte* at) noexcept {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

FieldDifference difference_of(std::string name, Word word, const std::byte* a, const std::byte* b) {
  const auto whole_numbers = [&]<class T>(T recorded, T replayed) {
    return FieldDifference{
        std::move(name), fmt::format("{}", recorded), fmt::format("{}", replayed),
        fmt::format("{}", recorded > replayed ? static_cast<std::uint64_t>(recorded) -
                                                    static_cast<std::uint64_t>(replayed)
                                              : static_cast<std::uint64_t>(replayed) -
                                                    static_cast<std::uint64_t>(recorded))};
  };
  const auto real_numbers = [&]<class Bits, class T>(T recorded, T replayed) {
    const T by = std::abs(recorded - replayed);
    return FieldDifference{
        std::move(name), fmt::format("{}", recorded), fmt::format("{}", replayed),
        by > 0 ? fmt::format("{:.3g}", by)
               : fmt::format("bits {:0{}x} and {:0{}x}", std::bit_cast<Bits>(recorded),
                             2 * sizeof(T), std::bit_cast<Bits>(replayed), 2 * sizeof(T))};
  };
  switch (word) {
    case Word::kUnsigned:
      return whole_numbers(word_at<std::uint64_t>(a), word_at<std::uint64_t>(b));
    case Word::kSigned:
      return whole_numbers(word_at<std::int64_t>(a), word_at<std::int64_t>(b));
    case Word::kShort:
      return whole_numbers(word_at<std::uint32_t>(a), word_at<std::uint32_t>(b));
    case Word::kFloat:
      return real_numbers.operator()<std::uint32_t>(word_at<float>(a), word_at<float>(b));
    case Word::kDouble:
      break;
  }
  return real_numbers.operator()<std::uint64_t>(word_at<double>(a), word_at<double>(b));
}

std::vector<FieldDifference> differences_of(std::span<const MessageField> fields,
                                            const std::byte* a, const std::byte* b) {
  std::vector<FieldDifference> out;
  for (const MessageField& one : fields) {
    const std::size_t step = one.word == Word::kShort || one.word == Word::kFloat ? 4 : 8;
    for (std::size_t n = 0; n * step < one.size; ++n) {
      const std::size_t at = one.offset + n * step;
      if (std::memcmp(a + at, b + at, step) == 0)
        continue;
      std::string name(one.name);
      if (!one.parts.empty())
        name += one.parts[n];
      else if (one.size > step)
        name += fmt::format("[{}]", n);
      out.push_back(difference_of(std::move(name), one.word, a + at, b + at));
    }
  }
  return out;
}

template <class T>
const std::byte* bytes_of(const T& message) noexcept {
  return reinterpret_cast<const std::byte*>(&message);
}

double distance(const msg::geometry_msgs_Vector3& a, const msg::geometry_msgs_Vector3& b) noexcept {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

}  // namespace

std::vector<FieldDifference> differences(const msg::ContactState& recorded,
                                         const msg::ContactState& replayed) {
  return differences_of(kContactFields, bytes_of(recorded), bytes_of(replayed));
}
std::vector<FieldDifference> differences(const msg::ForceCommand& recorded,
                                         const msg::ForceCommand& replayed) {
  return differences_of(kCommandFields, bytes_of(recorded), bytes_of(replayed));
}

template <class T>
void Comparison<T>::take(const T& recorded, const T& replayed) {
  ++compared;
  if (std::memcmp(&recorded, &replayed, sizeof recorded) == 0)
    return;
  ++differ;
  if (!first)
    first = recorded, fields = differences(recorded, replayed);
  force_n.add(distance(recorded.wrench.force, replayed.wrench.force), recorded.sequence_number);
  torque_nm.add(distance(recorded.wrench.torque, replayed.wrench.torque), recorded.sequence_number);
}

template class Comparison<msg::ContactState>;
template class Comparison<msg::ForceCommand>;

}  // namespace voxtouch::replay
