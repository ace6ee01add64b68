#pragma once
/// The Franka Control Interface on the wire: packed little-endian messages of the command channel
/// (TCP) and of the 1 kHz exchange (UDP). Field names, order, sizes and enumerations are facts of
/// the maker's public headers; devices/README.md says which version was read where.
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

enum class Request : std::uint8_t {
  kConnect,
  kMove,
  kStopMove,
  kSetCollisionBehavior,
  kSetLoad,
  kErrorRecovery
};
std::string_view name_of(Request request) noexcept;

/// What an answer says, whatever number its version has for it.
enum class Outcome : std::uint8_t {
  kSuccess,
  kStarted,         ///< of Move: the motion has begun, another answer follows at its end
  kWrongVersion,    ///< of Connect
  kPreempted,       ///< another command ended the motion
  kSafetyFunction,  ///< refused or ended by an active safety function
  kNotPossible,     ///< not in this mode
  kSingularStart,
  kInvalidArgument,
  kReflex,
  kEmergency,  ///< user stop
  kInputError,
  kAborted,
  kManualRecovery,  ///< a person has to recover the arm
  kUnknown,         ///< a number that the version has not got
};
/// What it means, for people.
std::string_view sentence_of(Outcome outcome) noexcept;

/// What the versions of the server differ in.
struct Dialect {
  std::uint16_t version;
  bool panda;                   ///< the older list of commands and of answers
  bool floats;                  ///< numbers of the state are floats, and there are accelerometers
  bool torque_finished;         ///< a command ends with one more flag
  bool nominal_frames;          ///< the state has the nominal end effector's two transforms
  bool base_acceleration;       ///< the state has the acceleration of the base
  std::size_t errors;           ///< flags in each list of the state
  std::uint32_t generator;      ///< of Move for torques alone: none, or joint velocities of zero
  std::uint8_t generator_mode;  ///< the same in the state
  std::size_t state_size, command_size;
};
/// Null: a version that this driver does not speak.
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

/// Numbers that the requests carry.
struct CollisionBehavior {
  Joints torque_nm = Joints::Constant(100.0);  ///< contact and collision thresholds, all alike
  Vec6 force = Vec6::Constant(150.0);          ///< N, Nm
};
struct Load {
  double mass_kg = 0.0;
  Vec3 centre_m = Vec3::Zero();       ///< in the flange
  Vec3 inertia_kg_m2 = Vec3::Zero();  ///< diagonal, about the centre
};

/// One message ready to be sent.
struct Message {
  std::array<std::byte, kCollisionSize> bytes{};
  std::size_t size = 0;
  std::span<const std::byte> span() const noexcept { return {bytes.data(), size}; }
};
// Real-time safe, all of them.
Message connect_request(std::uint32_t id, std::uint16_t version, std::uint16_t udp_port) noexcept;
/// Torques alone, without deviation limits that a hand would break.
Message move_request(const Dialect& dialect, std::uint32_t id) noexcept;
/// Requests without a body: kStopMove, kErrorRecovery.
Message bare_request(const Dialect& dialect, Request request, std::uint32_t id) noexcept;
Message collision_request(const Dialect& dialect, std::uint32_t id,
                          const CollisionBehavior& behavior) noexcept;
Message load_request(const Dialect& dialect, std::uint32_t id, const Load& load) noexcept;

/// A whole message of the channel, either way: header and the first bytes of its body.
struct Received {
  std::uint32_t command = 0, id = 0;
  std::size_t size = 0;                                        ///< header included
  std::array<std::byte, kCollisionSize - kHeaderSize> body{};  ///< what is longer was dropped
};
/// Cuts a byte stream into messages. Real-time safe.
class StreamReader {
 public:
  /// Where the next bytes go; as many as there is room for.
  std::span<std::byte> room() noexcept { return std::span(buffer_).subspan(filled_); }
  void took(std::size_t bytes) noexcept { filled_ += bytes; }
  /// The next whole message; nullopt: not there yet, or broken.
  std::optional<Received> next() noexcept;
  /// A header that cannot be: what follows means nothing.
  bool broken() const noexcept { return broken_; }
  /// Bytes that are no whole message yet.
  std::size_t pending() const noexcept { return filled_; }

 private:
  std::array<std::byte, 4096> buffer_;
  std::size_t filled_ = 0,
              skip_ = 0;  // skip_: bytes of a long body that still come and are dropped
  bool broken_ = false;
};
/// nullopt: no request that a dialect has at this number (or that this driver knows).
std::optional<Request> request_of(const Dialect& dialect, std::uint32_t command) noexcept;
/// What the answer `received` to `request` says. Connect alone is the same in every version.
Outcome outcome_of(const Dialect& dialect, Request request, const Received& received) noexcept;
Outcome connect_outcome(const Received& received) noexcept;
/// The robot's side: the answer to `request`, and to Connect with the server's version.
Message answer(const Dialect& dialect, Request request, std::uint32_t id, Outcome outcome) noexcept;
Message connect_answer(std::uint32_t id, bool accepted, std::uint16_t version) noexcept;
/// The server's version in its answer to Connect; 0: none in it.
std::uint16_t version_in(const Received& received) noexcept;

// --- the exchange

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
using Errors = std::uint64_t;  ///< bit i: error i of the maker's list
/// The list as words: "joint reflex, power limit violation". Allocates.
std::string words_of(Errors errors);
inline constexpr Errors kLostPacketsError = Errors{1}
                                            << 25;  ///< communication constraints violation
inline constexpr Errors kTorqueJumpError = Errors{1} << 32;  ///< controller torque discontinuity
inline constexpr Errors kTorqueRangeError = Errors{1} << 34;

/// What this driver reads of a state, and a simulated robot writes.
struct State {
  std::uint64_t message_id = 0;   ///< counts milliseconds
  Joints q = Joints::Zero();      ///< measured [rad]
  Joints dq = Joints::Zero();     ///< measured [rad/s]
  Joints tau_d = Joints::Zero();  ///< torque that the robot received last, without gravity [Nm]
  Joints tau = Joints::Zero();    ///< sensed, gravity included [Nm]
  Vec3 ee_in_base = Vec3::Zero(),
       ee_in_flange = Vec3::Zero();  ///< origin of the end effector's frame [m]
  std::uint8_t generator_mode = 0;
  ControllerMode controller = ControllerMode::kOther;
  RobotMode mode = RobotMode::kIdle;
  Errors errors = 0, reflex = 0;  ///< now; of the last motion's end
  double success_rate = 0.0;      ///< fraction of the last 100 commands that came in time
};

enum class PacketFault : std::uint8_t {
  kNone,
  kLength,
  kEnum,       ///< a mode that there is not
  kNotFinite,  ///< an angle, a rate or a torque is no number
};

/// kEnum and kNotFinite leave `state.message_id` valid, kLength nothing. Real-time safe.
PacketFault decode(const Dialect& dialect, std::span<const std::byte> datagram,
                   State& state) noexcept;
/// The datagram of a state: what State does not hold is zero, or a unit transform. `out` has to
/// have room for it. Returns its size.
std::size_t encode(const Dialect& dialect, const State& state, std::span<std::byte> out) noexcept;

struct Command {
  std::uint64_t message_id = 0;  ///< of the state that it answers
  Joints torque_nm = Joints::Zero();
  bool finished = false;  ///< the motion is to end
};
inline constexpr std::size_t kMaxCommandBytes = 371, kMaxStateBytes = 2373;
/// The robot's side: a datagram of the driver as a command; `command` is not to be used where there
/// is a fault. Real-time safe.
PacketFault decode(const Dialect& dialect, std::span<const std::byte> datagram,
                   Command& command) noexcept;
/// Real-time safe. Returns the size.
std::size_t encode(const Dialect& dialect, const Command& command,
                   std::span<std::byte, kMaxCommandBytes> out) noexcept;

}  // namespace voxtouch::fr3::fci
