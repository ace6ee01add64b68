#pragma once
/// Wire format of the Franka Control Interface: packed little-endian messages of the command
/// channel (TCP) and of the 1 kHz exchange (UDP). Field names, order, sizes and enumerations are
/// facts of the manufacturer's public headers; devices/README.md lists the versions that were read.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "devices/arm/joints.hpp"

namespace voxtouch::fr3::fci {

using arm::Joints;

inline constexpr std::uint16_t kCommandPort = 1337;  ///< TCP

// --- the command channel

/// The order is that of the command tables of the dialects.
enum class Request : std::uint8_t {
  kConnect,
  kMove,
  kStopMove,
  kSetCollisionBehavior,
  kSetLoad,
  kErrorRecovery
};
std::string_view name_of(Request request) noexcept;

/// Meaning of a reply, independent of the numbers of its version.
enum class Outcome : std::uint8_t {
  kSuccess,
  kStarted,         ///< of Move: the motion has begun; another reply follows at its end
  kWrongVersion,    ///< of Connect
  kPreempted,       ///< another command ended the motion
  kSafetyFunction,  ///< refused or ended by an active safety function
  kNotPossible,     ///< not possible in this mode
  kSingularStart,
  kInvalidArgument,
  kReflex,
  kEmergency,  ///< user stop
  kInputError,
  kAborted,
  kManualRecovery,  ///< the operator must recover the arm
  kUnknown,         ///< a number that the version does not define
};
/// Its meaning as a sentence.
std::string_view sentence_of(Outcome outcome) noexcept;

/// Differences between the versions of the server.
struct Dialect {
  std::uint16_t version;
  bool panda;               ///< the older list of commands and replies
  bool floats;              ///< numbers of the state are floats, and there are accelerometers
  bool torque_finished;     ///< a command ends with one more flag
  bool nominal_frames;      ///< the state contains the two transforms of the nominal end effector
  bool base_acceleration;   ///< the state contains the acceleration of the base
  std::size_t errors;       ///< number of flags in each list of the state
  std::uint32_t generator;  ///< of Move for torques only: none, or joint velocities of zero
  std::uint8_t generator_mode;  ///< the same in the state
  std::size_t state_size, command_size;
};
/// Null for an unsupported version.
const Dialect* dialect_of(std::uint16_t version) noexcept;
/// "3 to 10".
std::string_view spoken_versions() noexcept;
inline constexpr std::uint16_t kOldestVersion = 3, kNewestVersion = 10;

inline constexpr std::size_t kHeaderSize = 12, kConnectSize = 16, kMoveSize = 68,
                             kCollisionSize = 428, kLoadSize = 116;
static_assert(kConnectSize == kHeaderSize + 2 * 2);
static_assert(kMoveSize == kHeaderSize + 2 * 4 + 6 * 8);
static_assert(kCollisionSize == kHeaderSize + (4 * 7 + 4 * 6) * 8);
static_assert(kLoadSize == kHeaderSize + (1 + 3 + 9) * 8);

/// Numbers of the requests.
struct CollisionBehavior {
  Joints torque_nm = Joints::Constant(100.0);  ///< contact and collision thresholds, all equal
  Vec6 force = Vec6::Constant(150.0);          ///< N, Nm
};
struct Load {
  double mass_kg = 0.0;
  Vec3 centre_m = Vec3::Zero();       ///< in the flange
  Vec3 inertia_kg_m2 = Vec3::Zero();  ///< diagonal, about the centre
};

/// One message ready to send.
struct Message {
  std::array<std::byte, kCollisionSize> bytes{};
  std::size_t size = 0;
  std::span<const std::byte> span() const noexcept { return {bytes.data(), size}; }
};
// All of these are real-time safe.
Message connect_request(std::uint32_t id, std::uint16_t version, std::uint16_t udp_port) noexcept;
/// Torques only, without deviation limits that an operator would exceed.
Message move_request(const Dialect& dialect, std::uint32_t id) noexcept;
/// Requests without a body: kStopMove, kErrorRecovery.
Message bare_request(const Dialect& dialect, Request request, std::uint32_t id) noexcept;
Message collision_request(const Dialect& dialect, std::uint32_t id,
                          const CollisionBehavior& behavior) noexcept;
Message load_request(const Dialect& dialect, std::uint32_t id, const Load& load) noexcept;

/// A complete message of the channel in either direction: header and the first bytes of its body.
struct Received {
  std::uint32_t command = 0, id = 0;
  std::size_t size = 0;  ///< including the header
  /// The rest of a longer body is dropped.
  std::array<std::byte, kCollisionSize - kHeaderSize> body{};
};
/// Splits a byte stream into messages. Real-time safe.
class StreamReader {
 public:
  /// Buffer for the next bytes; it limits their number.
  std::span<std::byte> room() noexcept { return std::span(buffer_).subspan(filled_); }
  void took(std::size_t bytes) noexcept { filled_ += bytes; }
  /// The next complete message; nullopt if it is incomplete or broken.
  std::optional<Received> next() noexcept;
  /// An invalid header was received: the rest of the stream is meaningless.
  bool broken() const noexcept { return broken_; }
  /// Number of bytes of an incomplete message.
  std::size_t pending() const noexcept { return filled_; }

 private:
  std::array<std::byte, 4096> buffer_;
  // skip_: remaining bytes of a long body, which are dropped.
  std::size_t filled_ = 0, skip_ = 0;
  bool broken_ = false;
};
/// nullopt for a number that is undefined in the dialect or unknown to this driver.
std::optional<Request> request_of(const Dialect& dialect, std::uint32_t command) noexcept;
/// Meaning of the reply `received` to `request`. Only Connect is equal in all versions.
Outcome outcome_of(const Dialect& dialect, Request request, const Received& received) noexcept;
Outcome connect_outcome(const Received& received) noexcept;
/// Robot's side: the reply to `request`, and to Connect with the server's version.
Message answer(const Dialect& dialect, Request request, std::uint32_t id, Outcome outcome) noexcept;
Message connect_answer(std::uint32_t id, bool accepted, std::uint16_t version) noexcept;
/// The server's version in its reply to Connect; 0 if it contains none.
std::uint16_t version_in(const Received& received) noexcept;

// --- the exchange

/// The values of RobotMode and ControllerMode are those on the wire.
enum class RobotMode : std::uint8_t {
  kOther,
  kIdle,
  kMove,
  kGuiding,
  kReflex,
  kUserStopped,
  kErrorRecovery
};
enum class ControllerMode : std::uint8_t {
  kJointImpedance,
  kCartesianImpedance,
  kExternal,
  kOther
};
inline constexpr std::size_t kErrors = 41;
using Errors = std::uint64_t;  ///< bit i: error i of the manufacturer's list
/// The list as text: "joint reflex, power limit violation". Allocates.
std::string words_of(Errors errors);
/// Communication constraints violation.
inline constexpr Errors kLostPacketsError = Errors{1} << 25;
inline constexpr Errors kTorqueJumpError = Errors{1} << 32;  ///< controller torque discontinuity
inline constexpr Errors kTorqueRangeError = Errors{1} << 34;

/// The fields of a state that this driver reads and a simulated robot writes.
struct State {
  std::uint64_t message_id = 0;   ///< counts milliseconds
  Joints q = Joints::Zero();      ///< measured [rad]
  Joints dq = Joints::Zero();     ///< measured [rad/s]
  Joints tau_d = Joints::Zero();  ///< last torque received by the robot, without gravity [Nm]
  Joints tau = Joints::Zero();    ///< sensed, gravity included [Nm]
  /// Origin of the end effector's frame [m].
  Vec3 ee_in_base = Vec3::Zero(), ee_in_flange = Vec3::Zero();
  std::uint8_t generator_mode = 0;
  ControllerMode controller = ControllerMode::kOther;
  RobotMode mode = RobotMode::kIdle;
  Errors errors = 0, reflex = 0;  ///< present ones; then those of the last motion's end
  double success_rate = 0.0;      ///< fraction of the last 100 commands that arrived in time
};

enum class PacketFault : std::uint8_t {
  kNone,
  kLength,
  kEnum,       ///< an undefined mode
  kNotFinite,  ///< an angle, a rate or a torque is not finite
};

/// After kEnum and kNotFinite only `state.message_id` is valid, after kLength nothing. Real-time
/// safe.
PacketFault decode(const Dialect& dialect, std::span<const std::byte> datagram,
                   State& state) noexcept;
/// Writes the datagram of a state; fields missing in State are zero or unit transforms. `out` must
/// have room. Returns its size.
std::size_t encode(const Dialect& dialect, const State& state, std::span<std::byte> out) noexcept;

struct Command {
  std::uint64_t message_id = 0;  ///< of the state that it replies to
  Joints torque_nm = Joints::Zero();
  bool finished = false;  ///< the motion shall end
};
inline constexpr std::size_t kMaxCommandBytes = 371, kMaxStateBytes = 2373;
/// Robot's side: decodes a datagram of the driver as a command; `command` is invalid after a fault.
/// Real-time safe.
PacketFault decode(const Dialect& dialect, std::span<const std::byte> datagram,
                   Command& command) noexcept;
/// Returns the size. Real-time safe.
std::size_t encode(const Dialect& dialect, const Command& command,
                   std::span<std::byte, kMaxCommandBytes> out) noexcept;

}  // namespace voxtouch::fr3::fci
