#pragma once
/// For the files that write the table of keys down, one row a key.
#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>

#include "core/scene/keys.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::scene::keys {

using enum KeyKind;
using enum KeyRule;

/// For a key without a default.
inline constexpr std::nullptr_t kNone = nullptr;

/// Values as text of a scene file.
inline std::string in_file(double value) { return fmt::format("{}", value); }
inline std::string in_file(std::uint32_t value) { return fmt::format("{}", value); }
inline std::string in_file(bool value) { return value ? "true" : "false"; }
inline std::string in_file(const std::string& value) { return value; }
inline std::string in_file(ShellKind value) {
  return value == ShellKind::kExact ? "exact" : "naive";
}
inline std::string in_file(const Vec3& v) {
  return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z());
}
inline std::string in_file(const Quat& q) {
  return fmt::format("[{}, {}, {}, {}]", q.w(), q.x(), q.y(), q.z());
}

template <class Struct, class Value>
std::string initial_of(Value Struct::*member) {
  return in_file(Struct{}.*member);
}
/// The initialiser of the member that the key is read into: the one place of the key's standard.
template <auto kMember>
std::string initial() {
  return initial_of(kMember);
}

/// The rows of both, those of `first` before.
template <std::size_t N, std::size_t M>
constexpr std::array<Key, N + M> joined(const std::array<Key, N>& first,
                                        const std::array<Key, M>& second) {
  std::array<Key, N + M> out;
  std::copy(second.begin(), second.end(), std::copy(first.begin(), first.end(), out.begin()));
  return out;
}

}  // namespace voxtouch::scene::keys
