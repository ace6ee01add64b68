// The codec against bytes written by hand from the layout: offsets are counted here, once more, and
// not taken from the codec.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <tuple>
#include <vector>

#include "devices/fr3/fci_codec.hpp"

namespace voxtouch::fr3::fci {
namespace codec_test {

using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(const Message& m) {
  const auto* at = reinterpret_cast<const std::uint8_t*>(m.bytes.data());
  return {at, at + m.size};
}
template <class T>
void set(Bytes& bytes, std::size_t at, T value) {
  std::memcpy(&bytes[at], &value, sizeof value);
}
template <class T>
T value_at(std::span<const std::byte> bytes, std::size_t at) {
  T value;
  std::memcpy(&value, &bytes[at], sizeof value);
  return value;
}
std::span<const std::byte> span_of(const Bytes& bytes) { return std::as_bytes(std::span(bytes)); }

constexpr std::size_t kSuccessRate = 284 * 8 + 8 + 85;

TEST(FciCodec, ConnectIsVersionAndPort) {
  EXPECT_EQ(bytes_of(connect_request(7, 10, 0xABCD)),
            (Bytes{0, 0, 0, 0, 7, 0, 0, 0, 16, 0, 0, 0, 10, 0, 0xCD, 0xAB}));
}

TEST(FciCodec, MoveRequestsTorquesInEveryVersion) {
  const Bytes newest = bytes_of(move_request(*dialect_of(10), 0x01020304));
  ASSERT_EQ(newest.size(), 68U);
  EXPECT_EQ(Bytes(newest.begin(), newest.begin() + 20),
            (Bytes{1, 0, 0, 0, 4, 3, 2, 1, 68, 0, 0, 0, 2, 0, 0, 0, 4, 0, 0, 0}));
  // 10 m as a double: 0x4024000000000000
  EXPECT_EQ(Bytes(newest.begin() + 20, newest.begin() + 28), (Bytes{0, 0, 0, 0, 0, 0, 0x24, 0x40}));
  EXPECT_EQ(Bytes(newest.begin() + 20, newest.begin() + 44),
            Bytes(newest.begin() + 44, newest.end()));
  for (const std::uint16_t version : std::initializer_list<std::uint16_t>{9, 8, 7, 6, 5, 4, 3})
    EXPECT_EQ(bytes_of(move_request(*dialect_of(version), 1))[16], 1) << version;
}

TEST(FciCodec, RequestsHaveTheNumbersOfTheirVersion) {
  const Dialect &fr3 = *dialect_of(10), &panda = *dialect_of(5);
  EXPECT_EQ(bytes_of(bare_request(fr3, Request::kStopMove, 1)),
            (Bytes{2, 0, 0, 0, 1, 0, 0, 0, 12, 0, 0, 0}));
  EXPECT_EQ(bytes_of(bare_request(panda, Request::kStopMove, 1))[0], 2);
  EXPECT_EQ(bytes_of(bare_request(fr3, Request::kErrorRecovery, 1))[0], 10);
  EXPECT_EQ(bytes_of(bare_request(panda, Request::kErrorRecovery, 1))[0], 12);
  const Bytes collision = bytes_of(collision_request(fr3, 1, {}));
  EXPECT_EQ(collision.size(), 428U);
  EXPECT_EQ(collision[0], 3);
  EXPECT_EQ(bytes_of(collision_request(panda, 1, {}))[0], 4);
  const Bytes load = bytes_of(load_request(fr3, 1, {2.0, Vec3(0, 0, 1.0), Vec3(0, 2.0, 0)}));
  EXPECT_EQ(load.size(), 116U);
  EXPECT_EQ(load[0], 9);
  EXPECT_EQ(bytes_of(load_request(panda, 1, {}))[0], 10);
  EXPECT_EQ(Bytes(load.begin() + 12, load.begin() + 20),
            (Bytes{0, 0, 0, 0, 0, 0, 0, 0x40}));  // 2 kg
  EXPECT_EQ(Bytes(load.begin() + 36, load.begin() + 44),
            (Bytes{0, 0, 0, 0, 0, 0, 0xF0, 0x3F}));  // z of the centre
  EXPECT_EQ(Bytes(load.begin() + 76, load.begin() + 84),
            (Bytes{0, 0, 0, 0, 0, 0, 0, 0x40}));  // the middle of nine
}

TEST(FciCodec, DecodesAnswersByTheirVersion) {
  Received received;
  received.size = 13;
  const auto says = [&](std::uint16_t version, Request request, int status) {
    received.body[0] = static_cast<std::byte>(status);
    return outcome_of(*dialect_of(version), request, received);
  };
  EXPECT_EQ(says(10, Request::kMove, 1), Outcome::kStarted);
  EXPECT_EQ(says(10, Request::kMove, 5), Outcome::kNotPossible);
  EXPECT_EQ(says(5, Request::kMove, 3), Outcome::kNotPossible);
  EXPECT_EQ(says(10, Request::kMove, 8), Outcome::kReflex);
  EXPECT_EQ(says(5, Request::kMove, 6), Outcome::kReflex);
  EXPECT_EQ(says(6, Request::kMove, 11), Outcome::kAborted);
  EXPECT_EQ(says(5, Request::kMove, 10), Outcome::kUnknown);
  EXPECT_EQ(says(10, Request::kErrorRecovery, 3), Outcome::kManualRecovery);
  EXPECT_EQ(says(5, Request::kErrorRecovery, 2), Outcome::kManualRecovery);
  EXPECT_EQ(says(10, Request::kSetLoad, 3), Outcome::kSafetyFunction);
  received.size = 12;
  EXPECT_EQ(says(10, Request::kMove, 0), Outcome::kUnknown) << "without a status";
}

TEST(FciCodec, VersionsAreThoseThatWereRead) {
  for (const std::uint16_t version : std::initializer_list<std::uint16_t>{10, 9, 8, 7, 6, 5, 4, 3})
    EXPECT_NE(dialect_of(version), nullptr) << version;
  for (const std::uint16_t version : std::initializer_list<std::uint16_t>{0, 1, 2, 11, 65535})
    EXPECT_EQ(dialect_of(version), nullptr) << version;
  EXPECT_EQ(dialect_of(10)->state_size, 1377U);
  EXPECT_EQ(dialect_of(10)->command_size, 371U);
  EXPECT_EQ(dialect_of(9)->state_size, 2373U);
  EXPECT_EQ(dialect_of(5)->command_size, 370U);
  EXPECT_EQ(dialect_of(4)->state_size, 8U + 281 * 8 + (1 + 1 + 37 + 37 + 1) + 8);
  EXPECT_EQ(dialect_of(3)->state_size, 8U + 249 * 8 + (1 + 1 + 37 + 37 + 1) + 8);
  for (const std::uint16_t version : std::initializer_list<std::uint16_t>{8, 7}) {
    EXPECT_EQ(dialect_of(version)->state_size, 2373U) << version;
    EXPECT_EQ(dialect_of(version)->command_size, 371U) << version;
  }
  for (const std::uint16_t version : std::initializer_list<std::uint16_t>{4, 3})
    EXPECT_EQ(dialect_of(version)->command_size, 370U) << version;
}

/// Places by the public headers of these versions: transforms of 16, then 26 numbers of masses, 4
/// of the elbow, 21 of torques, 7 angles, 7 desired ones and 7 rates.
TEST(FciCodec, ReadsTheStatesOfOlderPandas) {
  for (const auto& [version, transforms, numbers] :
       {std::tuple<std::uint16_t, std::size_t, std::size_t>{4, 6, 281}, {3, 4, 249}}) {
    const std::size_t q = 8 + 8 * (transforms * 16 + 26 + 4 + 21), modes = 8 + 8 * numbers;
    Bytes bytes(dialect_of(version)->state_size, 0);
    set(bytes, 0, std::uint64_t{42});
    set(bytes, 8 + 8 * (32 + 14), 0.1034);
    set(bytes, q + 8 * 6, 1.25), set(bytes, q + 8 * 14, -2.5), set(bytes, q - 8 * 14, 3.0);
    bytes[modes] = 2, bytes[modes + 1] = 2, bytes[modes + 2 + 36] = 1,
    bytes[modes + 2 + 37 + 6] = 1, bytes[modes + 76] = 2;
    set(bytes, modes + 77, 0.5);
    State state;
    ASSERT_EQ(decode(*dialect_of(version), span_of(bytes), state), PacketFault::kNone) << version;
    EXPECT_EQ(state.ee_in_flange.z(), 0.1034);
    EXPECT_EQ(state.q[6], 1.25);
    EXPECT_EQ(state.dq[0], -2.5);
    EXPECT_EQ(state.tau_d[0], 3.0);
    EXPECT_EQ(words_of(state.errors), "joint move in wrong direction");
    EXPECT_EQ(words_of(state.reflex), "joint reflex");
    EXPECT_EQ(state.mode, RobotMode::kMove);
    EXPECT_EQ(state.success_rate, 0.5);
  }
}

TEST(FciCodec, ReadsFloatStateFieldsAtTheirOffsets) {
  Bytes bytes(1377, 0);
  set(bytes, 0, std::uint64_t{0x0102030405060708});
  // Before the angles: six transforms of 16, masses and inertias 26, elbow 4, three torques of 7.
  const std::size_t q = 8 + 4 * (6 * 16 + 26 + 4 + 3 * 7), dq = q + 4 * 14, tau_d = q - 4 * 14;
  for (std::size_t i = 0; i < 7; ++i) {
    set(bytes, q + 4 * i, 0.5F * static_cast<float>(i));
    set(bytes, dq + 4 * i, -0.25F * static_cast<float>(i));
    set(bytes, tau_d + 4 * i, 2.0F * static_cast<float>(i));
  }
  set(bytes, 8 + 4 * 12, 0.25F), set(bytes, 8 + 4 * 13, 0.5F),
      set(bytes, 8 + 4 * 14, 0.75F);  // O_T_EE
  const std::size_t modes =
      8 + 4 * (284 + 36);  // accelerometers, twice six of three, before the modes
  bytes[modes] = 5, bytes[modes + 1] = 2;
  bytes[modes + 2 + 25] = 1;
  bytes[modes + 2 + 41 + 6] = 1;
  bytes[modes + 2 + 82] = 4;
  set(bytes, modes + 85, 0.75F);
  ASSERT_EQ(modes + 89, bytes.size());
  State state;
  ASSERT_EQ(decode(*dialect_of(10), span_of(bytes), state), PacketFault::kNone);
  EXPECT_EQ(state.message_id, 0x0102030405060708U);
  EXPECT_EQ(state.q[3], 1.5);
  EXPECT_EQ(state.dq[4], -1.0);
  EXPECT_EQ(state.tau_d[6], 12.0);
  EXPECT_EQ(state.ee_in_base, Vec3(0.25, 0.5, 0.75));
  EXPECT_EQ(state.generator_mode, 5);
  EXPECT_EQ(state.controller, ControllerMode::kExternal);
  EXPECT_EQ(state.mode, RobotMode::kReflex);
  EXPECT_EQ(state.errors, kLostPacketsError);
  EXPECT_EQ(words_of(state.errors | state.reflex),
            "joint reflex, communication constraints violation");
  EXPECT_EQ(state.success_rate, 0.75);
}

TEST(FciCodec, ReadsDoubleStateFieldsAtTheirOffsets) {
  Bytes bytes(2373, 0);
  set(bytes, 0, std::uint64_t{42});
  set(bytes, 8 + 8 * (147 + 6), 1.25);  // the last angle
  set(bytes, 8 + 8 * 161, -2.5);        // the first rate
  set(bytes, 8 + 8 * (32 + 14), 0.1034);
  bytes[kSuccessRate - 85] = 2, bytes[kSuccessRate - 84] = 2, bytes[kSuccessRate - 1] = 2;
  set(bytes, kSuccessRate, 0.5);
  for (const std::uint16_t version : std::initializer_list<std::uint16_t>{9, 8, 7, 6, 5}) {
    State state;
    ASSERT_EQ(decode(*dialect_of(version), span_of(bytes), state), PacketFault::kNone);
    EXPECT_EQ(state.q[6], 1.25);
    EXPECT_EQ(state.dq[0], -2.5);
    EXPECT_EQ(state.ee_in_flange.z(), 0.1034);
    EXPECT_EQ(state.mode, RobotMode::kMove);
    EXPECT_EQ(state.success_rate, 0.5);
  }
}

TEST(FciCodec, RefusesBadLengthsModesAndNumbers) {
  Bytes good(1377, 0);
  State state;
  EXPECT_EQ(decode(*dialect_of(10), span_of(good), state), PacketFault::kNone);
  for (const std::size_t size : {0U, 8U, 1233U, 1376U, 1378U, 2373U})
    EXPECT_EQ(decode(*dialect_of(10), span_of(Bytes(size, 0)), state), PacketFault::kLength)
        << size;
  const std::size_t modes = 1377 - 89;
  for (const auto& [at, value] :
       {std::pair{modes, 6}, std::pair{modes + 1, 4}, std::pair{modes + 84, 7}}) {
    Bytes bad = good;
    bad[at] = static_cast<std::uint8_t>(value);
    EXPECT_EQ(decode(*dialect_of(10), span_of(bad), state), PacketFault::kEnum) << at;
  }
  for (const std::size_t field : {147U, 161U, 133U}) {
    Bytes bad = good;
    set(bad, 8 + 4 * (field + 3), std::numeric_limits<float>::quiet_NaN());
    EXPECT_EQ(decode(*dialect_of(10), span_of(bad), state), PacketFault::kNotFinite) << field;
  }
}

TEST(FciCodec, ACommandIsACountSevenTorquesAndItsEnd) {
  std::array<std::byte, kMaxCommandBytes> out;
  Command command{0x1122334455667788, Joints::Zero(), true};
  command.torque_nm << 1, 2, 3, 4, 5, 6, 7;
  for (const std::uint16_t version :
       std::initializer_list<std::uint16_t>{10, 9, 8, 7, 6, 5, 4, 3}) {
    const Dialect& dialect = *dialect_of(version);
    const std::size_t size = encode(dialect, command, out);
    ASSERT_EQ(size, dialect.command_size);
    EXPECT_EQ(value_at<std::uint64_t>(out, 0), command.message_id);
    EXPECT_EQ(out[312], std::byte{0}) << "no elbow";
    EXPECT_EQ(out[313], std::byte{1}) << "the motion is over";
    for (std::size_t i = 0; i < 7; ++i)
      EXPECT_EQ(value_at<double>(out, 314 + 8 * i), 1.0 + static_cast<double>(i));
    if (version >= 7) {
      EXPECT_EQ(out[370], std::byte{1});
    }
    for (std::size_t at = 8; at < 312; ++at)
      EXPECT_EQ(out[at], std::byte{0}) << at;
    Command back;
    ASSERT_EQ(decode(dialect, std::span(out).first(size), back), PacketFault::kNone);
    EXPECT_EQ(back.torque_nm, command.torque_nm);
    EXPECT_TRUE(back.finished);
  }
}

TEST(FciCodec, ReadsBackASimulatedRobotsState) {
  State state;
  state.message_id = 99;
  state.q << 0.5, -0.5, 0.25, -2.0, 0.125, 1.5, 0.75;
  state.dq = 2.0 * state.q;
  state.tau_d = -state.q;
  state.ee_in_base = Vec3(0.5, 0.25, 0.125);
  state.mode = RobotMode::kMove;
  state.controller = ControllerMode::kExternal;
  for (const std::uint16_t version :
       std::initializer_list<std::uint16_t>{10, 9, 8, 7, 6, 5, 4, 3}) {
    state.errors = version >= 5 ? 0x1FFFFFFFFFF : 0x1FFFFFFFFF;
    std::array<std::byte, kMaxStateBytes> out;
    const std::size_t size = encode(*dialect_of(version), state, out);
    State back;
    ASSERT_EQ(decode(*dialect_of(version), std::span(out).first(size), back), PacketFault::kNone);
    EXPECT_EQ(back.q, state.q);
    EXPECT_EQ(back.dq, state.dq);
    EXPECT_EQ(back.tau_d, state.tau_d);
    EXPECT_EQ(back.ee_in_base, state.ee_in_base);
    EXPECT_EQ(back.errors, state.errors);
    EXPECT_EQ(back.mode, state.mode);
  }
}

TEST(FciStream, ReassemblesMessagesAndDropsLongBodies) {
  Bytes stream;
  const auto append = [&](const Bytes& more) {
    stream.insert(stream.end(), more.begin(), more.end());
  };
  append(bytes_of(connect_answer(1, true, 10)));
  Bytes model(20000, 'x');  // a robot model, which was not requested
  set(model, 0, std::uint32_t{12}), set(model, 4, std::uint32_t{2}),
      set(model, 8, std::uint32_t{20000});
  append(model);
  append(bytes_of(answer(*dialect_of(10), Request::kMove, 3, Outcome::kStarted)));
  for (const std::size_t piece : {1U, 7U, 13U, 500U, 4000U}) {
    StreamReader reader;
    std::vector<std::uint32_t> ids;
    for (std::size_t at = 0; at < stream.size();) {
      const std::span<std::byte> room = reader.room();
      const std::size_t n = std::min({piece, room.size(), stream.size() - at});
      ASSERT_GT(n, 0U);
      std::memcpy(room.data(), &stream[at], n);
      reader.took(n);
      at += n;
      while (const auto message = reader.next())
        ids.push_back(message->id);
    }
    EXPECT_EQ(ids, (std::vector<std::uint32_t>{1, 2, 3})) << piece;
    EXPECT_FALSE(reader.broken());
  }
}

TEST(FciStream, InvalidHeaderEndsIt) {
  for (const std::uint32_t size : {0U, 11U, 0x7FFFFFFFU}) {
    StreamReader reader;
    Bytes header(12, 0);
    set(header, 8, size);
    std::memcpy(reader.room().data(), header.data(), header.size());
    reader.took(header.size());
    EXPECT_FALSE(reader.next());
    EXPECT_TRUE(reader.broken()) << size;
  }
}

}  // namespace codec_test
}  // namespace voxtouch::fr3::fci
