#pragma once
/// A remote side that uses only the protocol's table of offsets: it has no declaration in common
/// with the code under test.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "core/types/geometry.hpp"

namespace voxtouch::lwr_sim::test {

using MsrBytes = std::array<std::byte, 916>;
using CmdBytes = std::array<std::byte, 376>;

template <class T>
T get(std::span<const std::byte> bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}
template <class T>
void put(std::span<std::byte> bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
}

/// Fields of a measurement, by offset.
inline std::uint16_t sequence(std::span<const std::byte> msr) { return get<std::uint16_t>(msr, 0); }
inline float timestamp(std::span<const std::byte> msr) { return get<float>(msr, 140); }
inline int state(std::span<const std::byte> msr) { return get<std::uint16_t>(msr, 144); }
inline int quality(std::span<const std::byte> msr) { return get<std::uint16_t>(msr, 146); }
inline int power(std::span<const std::byte> msr) { return get<std::uint16_t>(msr, 180); }
inline int control(std::span<const std::byte> msr) { return get<std::uint16_t>(msr, 182); }
inline int error(std::span<const std::byte> msr) { return get<std::uint16_t>(msr, 184); }
inline int warning(std::span<const std::byte> msr) { return get<std::uint16_t>(msr, 186); }
inline int echo(std::span<const std::byte> msr) { return get<std::int32_t>(msr, 76); }
inline float joint(std::span<const std::byte> msr, std::size_t i) {
  return get<float>(msr, 216 + 4 * i);
}
inline Vec3 tip(std::span<const std::byte> msr) {
  return {get<float>(msr, 256), get<float>(msr, 272), get<float>(msr, 288)};
}

/// Answers as a haptic device does: mirrors the position in MON; in CMD stiffness zero, position as
/// measured, torque on top.
struct ScriptedRemote {
  std::int32_t strategy = 30, run = 1;
  std::uint32_t flags = 0x35;  // joint position, torque, stiffness, damping
  float torque[7] = {};
  float joint_stiffness = 0.0F;
  float mirror_error = 0.0F;  // added to joint 2
  bool follows =
      true;  // the position follows the measured one in CMD; otherwise it stays at the mirrored
  float step = 0.0F;    // added to the position of joint 1 with every answer in CMD
  float offset = 0.0F;  // sum of these
  std::uint16_t count = 0;

  CmdBytes answer(std::span<const std::byte> msr) {
    CmdBytes cmd{};
    put<std::uint16_t>(cmd, 0, ++count);
    put<std::uint16_t>(cmd, 2, sequence(msr));
    put<std::uint16_t>(cmd, 4, 376);
    put<std::uint16_t>(cmd, 6, 0x1005);
    put<std::int32_t>(cmd, 72, strategy);
    put<std::int32_t>(cmd, 76, run);
    put<std::uint32_t>(cmd, 140, flags);
    const bool command = state(msr) == 2;
    if (command)
      offset += step;
    for (std::size_t i = 0; i < 7; ++i) {
      const float mirrored =
          get<float>(msr, 292 + 4 * i) + (command ? 0.0F : get<float>(msr, 320 + 4 * i));
      float q = command && follows ? joint(msr, i) : mirrored;
      if (i == 1 && !command)
        q += mirror_error;
      if (i == 0 && command)
        q += offset;
      put<float>(cmd, 144 + 4 * i, q);
      put<float>(cmd, 220 + 4 * i, command ? torque[i] : 0.0F);
      put<float>(cmd, 272 + 4 * i, joint_stiffness);
      put<float>(cmd, 300 + 4 * i, 0.7F);
    }
    for (std::size_t i = 0; i < 12; ++i)
      put<float>(cmd, 172 + 4 * i, get<float>(msr, 348 + 4 * i));
    return cmd;
  }
};

}  // namespace voxtouch::lwr_sim::test
