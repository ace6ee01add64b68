#pragma once
/// The two packets of KUKA's Fast Research Interface 1.0 (KRC2-LR controllers, light-weight robot 4
/// and 4+), declared from their layout: little-endian, IEEE floats, aligned to four bytes without
/// gaps. The controller sends a measurement (MSR) every period. The remote side answers each with a
/// command (CMD) to the address of its sender.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace voxtouch::lwr::fri {

static_assert(std::endian::native == std::endian::little,
              "the packets are copied, so the host has to be little-endian");
static_assert(std::numeric_limits<float>::is_iec559 && sizeof(float) == 4);

inline constexpr std::uint16_t kMsrId = 0x2006;
inline constexpr std::uint16_t kCmdId = 0x1005;
inline constexpr std::uint16_t kMsrSize = 916;
inline constexpr std::uint16_t kCmdSize = 376;
inline constexpr std::uint16_t kDefaultPort = 49938;  ///< UDP, of the remote side
inline constexpr std::size_t kJoints = 7;  ///< in the order A1 A2 E1 A3 A4 A5 A6; E1 is index 2
inline constexpr std::size_t kKrlCount = 16;
inline constexpr std::uint16_t kAllDrives = 0x7F;  ///< robot.power with every drive on

using Joints = std::array<float, kJoints>;
using Frame = std::array<float, 12>;      ///< 3 x 4, row-major [R | p], p in m
using CartVector = std::array<float, 6>;  ///< x, y, z, then about Z, Y, X: see from_wire / to_wire
                                          ///< in fri_codec.hpp
using JacobianRows = std::array<float, 42>;  ///< 6 x 7, row-major, rows as in CartVector

/// msr.intf.state. The wire type is unsigned: -1 reads as 0xFFFF.
enum class State : std::uint16_t { kOff = 0, kMon = 1, kCmd = 2, kInvalid = 0xFFFF };
/// msr.intf.quality; ordered, except kInvalid.
enum class Quality : std::uint16_t {
  kUnacceptable = 0,
  kBad = 1,
  kOk = 2,
  kPerfect = 3,
  kInvalid = 0xFFFF
};
/// msr.robot.control.
enum class Control : std::uint16_t {
  kOther = 0,
  kPosition = 1,
  kCartesianImpedance = 2,
  kJointImpedance = 3
};
/// $stiffness.strategy in KRL, as requested in $FRI_FRM_INT[1].
enum class Strategy : std::int32_t {
  kPosition = 10,
  kCartesianImpedance = 20,
  kJointImpedance = 30
};

/// Bits of cmd.cmd_flags; may change only in MON.
inline constexpr std::uint32_t kFlagJntPos = 0x0001, kFlagJntTrq = 0x0004, kFlagJntStiff = 0x0010,
                               kFlagJntDamp = 0x0020, kFlagCartPos = 0x0100, kFlagTcpFt = 0x0400,
                               kFlagCartStiff = 0x1000, kFlagCartDamp = 0x2000;

/// The handshake variables of the KRL program, as wire indices (KRL counts from one).
inline constexpr std::size_t kFrmIntStrategy = 0;  ///< $FRI_FRM_INT[1]: the requested Strategy
inline constexpr std::size_t kFrmIntRun = 1;       ///< $FRI_FRM_INT[2]: 1 friStart, 0 friStop
inline constexpr std::size_t kToIntEcho = 1;  ///< $FRI_TO_INT[2]: echo of it, or kKrlInitialised
/// $FRI_TO_INT[16]: kVirtualTime, from the simulated controller only.
inline constexpr std::size_t kToIntSimulated = 15;
inline constexpr std::int32_t kRun = 1, kHalt = 0, kKrlInitialised = 10;
/// "VTXT": the controller runs in virtual time and sends its next measurement only after the reply
/// to the last.
inline constexpr std::int32_t kVirtualTime = 0x56545854;

struct Header {
  std::uint16_t send_seq;     ///< the sender's count, wraps
  std::uint16_t refl_seq;     ///< the last send_seq of the other side
  std::uint16_t packet_size;  ///< of the whole datagram, bytes
  std::uint16_t datagram_id;
};

struct Krl {
  std::array<float, kKrlCount> real;
  std::array<std::int32_t, kKrlCount> integer;
  std::uint16_t boolean;  ///< one bit each
  std::uint16_t fill;
};

struct Statistics {
  float answer_rate;  ///< of the last 100 packets
  float latency_s, jitter_s;
  float miss_rate;
  std::uint32_t miss_counter;
};

struct Interface {
  float timestamp_s;
  State state;
  Quality quality;
  float msr_period_s, cmd_period_s;  ///< as opened by friOpen
  float safety_limits;               ///< argument of friStart
  Statistics statistics;
};

struct Robot {
  std::uint16_t power;  ///< a bit a drive
  Control control;
  std::uint16_t error, warning;  ///< a bit a drive
  Joints temperature;
};

struct Measured {
  Joints jnt_pos;  ///< rad
  Frame cart_pos;
  Joints cmd_jnt_pos;  ///< the KRL side's command, rad
  Joints cmd_jnt_pos_fri_offset;
  Frame cmd_cart_pos;
  Frame cmd_cart_pos_fri_offset;
  Joints jnt_trq;             ///< Nm
  Joints est_ext_jnt_trq;     ///< Nm
  CartVector est_ext_tcp_ft;  ///< in $STIFFNESS.TASKFRAME
  JacobianRows jacobian;      ///< in $STIFFNESS.TASKFRAME
  std::array<float, 49> mass_matrix;
  Joints gravity;  ///< meaning unconfirmed: joint torque or acceleration
};

struct MsrPacket {
  Header header;
  Krl krl;  ///< $FRI_TO_...
  Interface interface;
  Robot robot;
  Measured data;
};

struct Command {
  std::uint32_t cmd_flags;
  Joints jnt_pos;  ///< rad; the null-space posture in Cartesian impedance
  Frame cart_pos;
  Joints add_jnt_trq;         ///< Nm
  CartVector add_tcp_ft;      ///< N, Nm; in $STIFFNESS.TASKFRAME
  Joints jnt_stiffness;       ///< Nm/rad
  Joints jnt_damping;         ///< normalised
  CartVector cart_stiffness;  ///< N/m, Nm/rad
  CartVector cart_damping;    ///< normalised
};

struct CmdPacket {
  Header header;
  Krl krl;  ///< $FRI_FRM_...
  Command command;
};

// The sizes; tests/unit/lwr/layout_test.cpp and tests/interop/fri/decode_fri.py have the layout
// field by field.
static_assert(std::is_trivially_copyable_v<MsrPacket> && std::is_standard_layout_v<MsrPacket> &&
              sizeof(MsrPacket) == kMsrSize);
static_assert(std::is_trivially_copyable_v<CmdPacket> && std::is_standard_layout_v<CmdPacket> &&
              sizeof(CmdPacket) == kCmdSize);
static_assert(alignof(MsrPacket) == 4 && alignof(CmdPacket) == 4);
static_assert(sizeof(Header) == 8 && sizeof(Krl) == 132 && sizeof(Statistics) == 20 &&
              sizeof(Interface) == 40);
static_assert(sizeof(Robot) == 36 && sizeof(Measured) == 700 && sizeof(Command) == 236);

}  // namespace voxtouch::lwr::fri
