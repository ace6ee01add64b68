// A million datagrams and streams of anything: nothing is read beyond them, and whatever is taken
// can be worked with.
#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

#include "devices/fr3/fci_codec.hpp"

namespace voxtouch::fr3::fci {
namespace hostile_test {

TEST(FciHostile, AMillionPacketsAreTakenOrRefused) {
  std::mt19937_64 random(33);
  const std::array<const Dialect*, 4> dialects = {dialect_of(10), dialect_of(9), dialect_of(6),
                                                  dialect_of(5)};
  std::vector<std::byte> bytes(kMaxStateBytes);
  int taken = 0, refused = 0;
  for (int n = 0; n < 1'000'000; ++n) {
    const Dialect& dialect = *dialects[random() % dialects.size()];
    const bool of_state = random() % 2 != 0;
    std::size_t size = of_state ? dialect.state_size : dialect.command_size;
    if (random() % 8 == 0)
      size = random() % kMaxStateBytes;
    // Changes a few places; the previous content is as hostile.
    for (int i = 0; i < 8; ++i) {
      const std::uint64_t word = random();
      std::memcpy(&bytes[random() % (bytes.size() - 8)], &word, 1 + random() % 8);
    }
    if (n % 4 == 0)
      std::fill(bytes.begin(), bytes.end(), std::byte{0});
    const std::vector<std::byte>& all = bytes;
    const std::span datagram(all.data(), std::min(size, all.size()));
    if (of_state) {
      State state;
      const PacketFault fault = decode(dialect, datagram, state);
      ASSERT_EQ(fault == PacketFault::kLength, datagram.size() != dialect.state_size);
      fault == PacketFault::kNone ? ++taken : ++refused;
      if (fault != PacketFault::kNone)
        continue;
      ASSERT_TRUE(state.q.allFinite() && state.dq.allFinite() && state.tau_d.allFinite());
      ASSERT_LE(static_cast<int>(state.mode), 6);
      ASSERT_LE(static_cast<int>(state.controller), 3);
      ASSERT_EQ(state.errors >> kErrors, 0U);
    } else {
      Command command;
      const PacketFault fault = decode(dialect, datagram, command);
      fault == PacketFault::kNone ? ++taken : ++refused;
      if (fault == PacketFault::kNone) {
        ASSERT_TRUE(command.torque_nm.allFinite());
      }
    }
  }
  EXPECT_GT(taken, 100'000);
  EXPECT_GT(refused, 100'000);
}

TEST(FciHostile, AnyStreamStaysWithinItsBuffer) {
  std::mt19937_64 random(34);
  for (int n = 0; n < 2000; ++n) {
    StreamReader reader;
    for (int piece = 0; piece < 50 && !reader.broken(); ++piece) {
      const std::span<std::byte> room = reader.room();
      ASSERT_FALSE(room.empty()) << "it would wait for ever";
      const std::size_t size = std::min<std::size_t>(1 + random() % 600, room.size());
      for (std::size_t i = 0; i < size; ++i)
        room[i] = static_cast<std::byte>(random() % 3 == 0 ? random() : 0);
      reader.took(size);
      while (const auto message = reader.next())
        for (const std::uint16_t version : std::initializer_list<std::uint16_t>{10, 5})
          if (const auto request = request_of(*dialect_of(version), message->command))
            (void)sentence_of(outcome_of(*dialect_of(version), *request, *message));
    }
  }
}

}  // namespace hostile_test
}  // namespace voxtouch::fr3::fci
