#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <vector>

#include "devices/lwr/fri_codec.hpp"
#include "tests/interop/fri/named_packets.hpp"

namespace voxtouch::lwr::fri {
namespace {

const float kNaN = std::numeric_limits<float>::quiet_NaN();

std::vector<std::byte> read_file(const std::string& name) {
  std::ifstream file(std::string(VOXTOUCH_TEST_DATA) + "/fri/" + name, std::ios::binary);
  const std::vector<char> chars{std::istreambuf_iterator<char>(file), {}};
  std::vector<std::byte> bytes(chars.size());
  if (!chars.empty())
    std::memcpy(bytes.data(), chars.data(), chars.size());
  return bytes;
}

template <class Packet>
std::vector<std::byte> bytes_of(const Packet& packet) {
  const auto bytes = std::as_bytes(std::span(&packet, 1));
  return {bytes.begin(), bytes.end()};
}

TEST(FriCodec, ReadsTheGoldenMeasurement) {
  MsrPacket packet;
  const auto bytes = read_file("measurement.bin");
  ASSERT_EQ(decode(bytes, packet), PacketFault::kNone);
  EXPECT_EQ(packet.interface.state, State::kCmd);
  EXPECT_EQ(packet.header.packet_size, 916);
  EXPECT_EQ(bytes_of(packet), bytes_of(test::named_msr()))
      << "a field holds another field's numbers";
  EXPECT_EQ(bytes, bytes_of(test::named_msr()));
}

TEST(FriCodec, ReadsTheGoldenCommand) {
  CmdPacket packet;
  const auto bytes = read_file("command.bin");
  ASSERT_EQ(decode(bytes, packet), PacketFault::kNone);
  EXPECT_EQ(bytes, bytes_of(test::named_cmd()));
  EXPECT_EQ(bytes_of(packet), bytes);
}

TEST(FriCodec, RefusesAnotherLengthIdOrSizeField) {
  MsrPacket msr;
  CmdPacket cmd;
  auto bytes = bytes_of(test::named_msr());
  EXPECT_EQ(decode(std::span(bytes).first(915), msr), PacketFault::kLength);
  EXPECT_EQ(decode(bytes, cmd), PacketFault::kLength);
  EXPECT_EQ(decode({}, msr), PacketFault::kLength);
  bytes[6] = std::byte{5};
  EXPECT_EQ(decode(bytes, msr), PacketFault::kId);
  bytes = bytes_of(test::named_msr());
  bytes[4] = std::byte{0};
  EXPECT_EQ(decode(bytes, msr), PacketFault::kSizeField);
}

TEST(FriCodec, RefusesUndefinedStatesQualitiesAndModes) {
  MsrPacket out, packet = test::named_msr();
  packet.interface.state = static_cast<State>(3);
  EXPECT_EQ(decode(bytes_of(packet), out), PacketFault::kEnum);
  packet = test::named_msr(), packet.interface.quality = static_cast<Quality>(4);
  EXPECT_EQ(decode(bytes_of(packet), out), PacketFault::kEnum);
  packet = test::named_msr(), packet.robot.control = static_cast<Control>(4);
  EXPECT_EQ(decode(bytes_of(packet), out), PacketFault::kEnum);
  packet = test::named_msr(), packet.interface.state = State::kInvalid,
  packet.interface.quality = Quality::kInvalid;
  EXPECT_EQ(decode(bytes_of(packet), out), PacketFault::kNone) << "-1 is defined";
}

TEST(FriCodec, RefusesAMeasurementWithoutTimeOrAPositionToMirror) {
  MsrPacket out;
  for (float* field : {&out.interface.timestamp_s, &out.interface.msr_period_s,
                       &out.data.cmd_jnt_pos[6], &out.data.cmd_jnt_pos_fri_offset[0]})
    for (const float bad : {kNaN, std::numeric_limits<float>::infinity()}) {
      out = test::named_msr();
      *field = bad;
      const auto bytes = bytes_of(out);
      EXPECT_EQ(decode(bytes, out), PacketFault::kNotFinite);
    }
  MsrPacket packet = test::named_msr();
  packet.data.cmd_jnt_pos[3] = packet.data.cmd_jnt_pos_fri_offset[3] = 3e38F;
  EXPECT_EQ(decode(bytes_of(packet), out), PacketFault::kNotFinite)
      << "their sum is what is mirrored";
}

TEST(FriCodec, DetectsANonFiniteMeasuredPosition) {
  MsrPacket out, packet = test::named_msr();
  EXPECT_TRUE(measured_finite(packet));
  packet.data.jnt_pos[5] = kNaN;
  EXPECT_EQ(decode(bytes_of(packet), out), PacketFault::kNone) << "it still has to be answered";
  EXPECT_FALSE(measured_finite(out));
}

TEST(FriCodec, RefusesACommandWithAnyNonFiniteNumber) {
  for (std::size_t at = 140 + 4; at < kCmdSize; at += 4) {
    CmdPacket packet = test::named_cmd();
    std::memcpy(reinterpret_cast<char*>(&packet) + at, &kNaN, 4);
    EXPECT_FALSE(finite(packet)) << "byte " << at;
  }
}

TEST(FriCodec, TransposesTheRotationsBetweenTheWireAndOurs) {
  const CartVector wire = {1, 2, 3, 40, 50, 60};  // x y z, about z, y, x
  Vec6 ours;
  ours << 1, 2, 3, 60, 50, 40;
  EXPECT_EQ(to_wire(ours), wire);
  LwrJacobian jacobian;
  for (int row = 0; row < 6; ++row)
    for (int col = 0; col < 7; ++col)
      jacobian(row, col) = 10 * row + col;
  const JacobianRows rows = to_wire(jacobian);
  EXPECT_EQ(rows[0 * 7 + 2], 2.0F);
  EXPECT_EQ(rows[3 * 7 + 2], 52.0F) << "the fourth row on the wire is about z";
  EXPECT_EQ(rows[5 * 7 + 2], 32.0F);
}

TEST(FriCodec, KeepsAPoseThroughTheWire) {
  const Pose pose{Vec3(0.1, -0.2, 0.3), Quat(0.5, -0.5, 0.1, 0.7).normalized()};
  const Frame wire = to_wire(pose);
  EXPECT_EQ(wire[7], -0.2F) << "positions are the fourth column";
  const Mat3 rotation = pose.orientation.toRotationMatrix();
  for (int row = 0; row < 3; ++row)
    for (int col = 0; col < 4; ++col)
      EXPECT_EQ(wire[static_cast<std::size_t>(4 * row + col)],
                static_cast<float>(col < 3 ? rotation(row, col) : pose.position[row]));
}

TEST(FriCodec, CountsAcrossTheWrap) {
  EXPECT_EQ(sequence_distance(65535, 0), 1);
  EXPECT_EQ(sequence_distance(0, 65535), -1);
  EXPECT_EQ(sequence_distance(65000, 100), 636);
  EXPECT_EQ(sequence_distance(7, 7), 0);
}

}  // namespace
}  // namespace voxtouch::lwr::fri
