#include "devices/fr3/fci_codec.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <numbers>

namespace voxtouch::fr3::fci {
namespace {

static_assert(std::endian::native == std::endian::little, "the wire is little-endian");

template <class T>
void put(std::byte* at, T value) noexcept {
  std::memcpy(at, &value, sizeof value);
}
template <class T>
T get(const std::byte* at) noexcept {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

// The state: its count, then numbers of one kind, then modes and flags. Places are counted in
// numbers.
constexpr std::size_t kId = 8;
constexpr std::size_t kPoseEe = 0, kPoseEeD = 16, kFlangeEe = 32, kEeK = 48, kFlangeNe = 64,
                      kNeEe = 80, kTau = 126, kTauD = 133, kQ = 147, kQd = 154, kDq = 161,
                      kPoseEeC = 242, kTheta = 270, kDtheta = 277, kNumbers = 284,
                      kAccelerometers = 36;
/// Two modes, two lists of errors, the mode of the robot.
constexpr std::size_t flags_size(std::size_t errors) noexcept {
  return 1 + 1 + errors + errors + 1;
}
// The newest version with doubles has all numbers. Older ones lack two transforms, and still older
// ones also the three numbers of the base's acceleration.
constexpr std::size_t kNominalFrames = 32, kBehindNominalFrames = kFlangeNe + kNominalFrames;
constexpr std::size_t kBaseAcceleration = 3, kBehindBaseAcceleration = 236;
constexpr std::size_t double_state(std::size_t numbers, std::size_t errors) noexcept {
  return kId + numbers * 8 + flags_size(errors) + 8;
}
constexpr std::size_t kOldErrors = 37;
constexpr std::size_t kState4 = double_state(kNumbers - kBaseAcceleration, kOldErrors);
constexpr std::size_t kState3 =
    double_state(kNumbers - kBaseAcceleration - kNominalFrames, kOldErrors);
static_assert(double_state(kNumbers, kErrors) == kMaxStateBytes);
constexpr std::size_t kFloatState =
    kId + (kNumbers + kAccelerometers) * 4 + flags_size(kErrors) + 4;
static_assert(kFloatState == 1377);

// The command: its count, the fields of a motion generator, torques.
constexpr std::size_t kGenerator = 8 + (7 + 7 + 16 + 6 + 2) * 8, kMotionFinished = kGenerator + 1,
                      kTorques = kGenerator + 2, kTorqueFinished = kTorques + 7 * 8;
static_assert(kTorqueFinished + 1 == kMaxCommandBytes);

constexpr std::uint32_t kNone = 4, kJointVelocity = 1, kExternalController = 2;  // of Move
constexpr std::uint8_t kNoneMode = 5, kJointVelocityMode = 2;                    // of the state

constexpr Dialect fr3_with_doubles(std::uint16_t version, bool torque_finished) noexcept {
  return {version,
          false,
          false,
          torque_finished,
          true,
          true,
          kErrors,
          kJointVelocity,
          kJointVelocityMode,
          kMaxStateBytes,
          kMaxCommandBytes - (torque_finished ? 0 : 1)};
}
constexpr Dialect panda(std::uint16_t version, std::size_t errors,
                        std::size_t state_size) noexcept {
  return {version,
          true,
          false,
          false,
          version >= 4,
          version >= 5,
          errors,
          kJointVelocity,
          kJointVelocityMode,
          state_size,
          kMaxCommandBytes - 1};
}

constexpr std::array<Dialect, 8> kDialects{{
    {10, false, true, true, true, true, kErrors, kNone, kNoneMode, kFloatState, kMaxCommandBytes},
    fr3_with_doubles(9, true),
    fr3_with_doubles(8, true),
    fr3_with_doubles(7, true),
    fr3_with_doubles(6, false),
    panda(5, kErrors, kMaxStateBytes),
    panda(4, kOldErrors, kState4),
    panda(3, kOldErrors, kState3),
}};

constexpr std::array<std::uint32_t, 6> kCommands = {0, 1, 2, 3, 9, 10},
                                       kPandaCommands = {0, 1, 2, 4, 10, 12};

std::uint32_t number_of(const Dialect& dialect, Request request) noexcept {
  return (dialect.panda ? kPandaCommands : kCommands)[static_cast<std::size_t>(request)];
}

void head(Message& message, std::uint32_t command, std::uint32_t id, std::size_t size) noexcept {
  message.size = size;
  put(&message.bytes[0], command);
  put(&message.bytes[4], id);
  put(&message.bytes[8], static_cast<std::uint32_t>(size));
}

using enum Outcome;
constexpr std::array kMove = {kSuccess,        kStarted,     kPreempted,     kSafetyFunction,
                              kSafetyFunction, kNotPossible, kSingularStart, kInvalidArgument,
                              kReflex,         kEmergency,   kInputError,    kAborted};
constexpr std::array kPandaMove = {kSuccess,       kStarted,         kPreempted, kNotPossible,
                                   kSingularStart, kInvalidArgument, kReflex,    kEmergency,
                                   kInputError,    kAborted};
constexpr std::array kStop = {kSuccess,   kNotPossible, kSafetyFunction,
                              kEmergency, kReflex,      kAborted};
constexpr std::array kPandaStop = {kSuccess, kNotPossible, kEmergency, kReflex, kAborted};
constexpr std::array kSet = {kSuccess, kNotPossible, kInvalidArgument, kSafetyFunction};
constexpr std::array kPandaSet = {kSuccess, kNotPossible, kInvalidArgument};
constexpr std::array kRecovery = {kSuccess, kNotPossible, kSafetyFunction, kManualRecovery,
                                  kReflex,  kEmergency,   kAborted};
constexpr std::array kPandaRecovery = {kSuccess, kNotPossible, kManualRecovery,
                                       kReflex,  kEmergency,   kAborted};

std::span<const Outcome> outcomes(const Dialect& dialect, Request request) noexcept {
  using Span = std::span<const Outcome>;
  switch (request) {
    case Request::kConnect:
      return {};
    case Request::kMove:
      return dialect.panda ? Span(kPandaMove) : Span(kMove);
    case Request::kStopMove:
      return dialect.panda ? Span(kPandaStop) : Span(kStop);
    case Request::kSetCollisionBehavior:
    case Request::kSetLoad:
      return dialect.panda ? Span(kPandaSet) : Span(kSet);
    case Request::kErrorRecovery:
      return dialect.panda ? Span(kPandaRecovery) : Span(kRecovery);
  }
  return {};
}

/// Reads and writes numbers of a state of either kind. A transform that the version lacks is never
/// accessed.
struct Numbers {
  const Dialect& dialect;
  std::size_t at(std::size_t place) const noexcept {
    if (place >= kBehindBaseAcceleration && !dialect.base_acceleration)
      place -= kBaseAcceleration;
    if (place >= kBehindNominalFrames && !dialect.nominal_frames)
      place -= kNominalFrames;
    return kId + place * (dialect.floats ? 4 : 8);
  }
  double read(std::span<const std::byte> bytes, std::size_t place) const noexcept {
    const std::byte* number = bytes.data() + at(place);
    return dialect.floats ? static_cast<double>(get<float>(number)) : get<double>(number);
  }
  void write(std::span<std::byte> bytes, std::size_t place, double value) const noexcept {
    std::byte* number = bytes.data() + at(place);
    dialect.floats ? put(number, static_cast<float>(value)) : put(number, value);
  }
  Joints joints(std::span<const std::byte> bytes, std::size_t place) const noexcept {
    Joints j;
    for (std::size_t i = 0; i < 7; ++i)
      j[static_cast<Eigen::Index>(i)] = read(bytes, place + i);
    return j;
  }
  void joints(std::span<std::byte> bytes, std::size_t place, const Joints& j) const noexcept {
    for (std::size_t i = 0; i < 7; ++i)
      write(bytes, place + i, j[static_cast<Eigen::Index>(i)]);
  }
  /// Origin of a column-major transform.
  Vec3 origin(std::span<const std::byte> bytes, std::size_t place) const noexcept {
    return {read(bytes, place + 12), read(bytes, place + 13), read(bytes, place + 14)};
  }
  void transform(std::span<std::byte> bytes, std::size_t place, const Vec3& origin) const noexcept {
    for (const std::size_t diagonal : {0, 5, 10, 15})
      write(bytes, place + diagonal, 1.0);
    for (std::size_t i = 0; i < 3; ++i)
      write(bytes, place + 12 + i, origin[static_cast<Eigen::Index>(i)]);
  }
};

Errors errors_at(const std::byte* at, std::size_t count) noexcept {
  Errors errors = 0;
  for (std::size_t i = 0; i < count; ++i)
    if (at[i] != std::byte{0})
      errors |= Errors{1} << i;
  return errors;
}
void errors_to(std::byte* at, std::size_t count, Errors errors) noexcept {
  for (std::size_t i = 0; i < count; ++i)
    at[i] = static_cast<std::byte>(errors >> i & 1);
}

/// Position after the numbers.
std::size_t flags_at(const Dialect& dialect) noexcept {
  return dialect.state_size - flags_size(dialect.errors) - (dialect.floats ? 4 : 8);
}

constexpr std::array<std::string_view, kErrors> kErrorNames = {
    "joint position limits violation",
    "cartesian position limits violation",
    "self collision avoidance violation",
    "joint velocity violation",
    "cartesian velocity violation",
    "force control safety violation",
    "joint reflex",
    "cartesian reflex",
    "maximum goal pose deviation violation",
    "maximum path pose deviation violation",
    "cartesian velocity profile safety violation",
    "joint position motion generator start pose invalid",
    "joint motion generator position limits violation",
    "joint motion generator velocity limits violation",
    "joint motion generator velocity discontinuity",
    "joint motion generator acceleration discontinuity",
    "cartesian position motion generator start pose invalid",
    "cartesian motion generator elbow limit violation",
    "cartesian motion generator velocity limits violation",
    "cartesian motion generator velocity discontinuity",
    "cartesian motion generator acceleration discontinuity",
    "cartesian motion generator elbow sign inconsistent",
    "cartesian motion generator start elbow invalid",
    "force controller desired force tolerance violation",
    "start elbow sign inconsistent",
    "communication constraints violation",
    "power limit violation",
    "cartesian motion generator joint position limits violation",
    "cartesian motion generator joint velocity limits violation",
    "cartesian motion generator joint velocity discontinuity",
    "cartesian motion generator joint acceleration discontinuity",
    "cartesian position motion generator invalid frame",
    "controller torque discontinuity",
    "joint p2p insufficient torque for planning",
    "joint torque range violation",
    "instability detected",
    "joint move in wrong direction",
    "cartesian spline motion generator violation",
    "joint via motion generator planning joint limit violation",
    "base acceleration initialization timeout",
    "base acceleration invalid reading"};

}  // namespace

std::string_view name_of(Request request) noexcept {
  switch (request) {
    case Request::kConnect:
      return "Connect";
    case Request::kMove:
      return "Move";
    case Request::kStopMove:
      return "StopMove";
    case Request::kSetCollisionBehavior:
      return "SetCollisionBehavior";
    case Request::kSetLoad:
      return "SetLoad";
    case Request::kErrorRecovery:
      return "AutomaticErrorRecovery";
  }
  return "unknown";
}

std::string_view sentence_of(Outcome outcome) noexcept {
  switch (outcome) {
    case kSuccess:
      return "done";
    case kStarted:
      return "the motion has begun";
    case kWrongVersion:
      return "the robot has a different FCI version";
    case kPreempted:
      return "the motion was ended by another command";
    case kSafetyFunction:
      return "a safety function is active: release it on the robot's web page";
    case kNotPossible:
      return "not possible in this mode: unlock the joints and activate FCI on the robot's web "
             "page";
    case kSingularStart:
      return "the arm is at a singular pose: bend its elbow by hand";
    case kInvalidArgument:
      return "a value was refused";
    case kReflex:
      return "the motion was ended by a reflex";
    case kEmergency:
      return "the user stop is pressed";
    case kInputError:
      return "the robot refused the command";
    case kAborted:
      return "the robot ended the motion";
    case kManualRecovery:
      return "recover the arm manually on the robot's web page";
    case kUnknown:
      return "an unknown reply";
  }
  return "unknown";
}

const Dialect* dialect_of(std::uint16_t version) noexcept {
  const auto found = std::find_if(kDialects.begin(), kDialects.end(),
                                  [&](const Dialect& d) { return d.version == version; });
  return found == kDialects.end() ? nullptr : &*found;
}

std::string_view spoken_versions() noexcept { return "3 to 10"; }

Message connect_request(std::uint32_t id, std::uint16_t version, std::uint16_t udp_port) noexcept {
  Message m;
  head(m, 0, id, kConnectSize);
  put(&m.bytes[12], version);
  put(&m.bytes[14], udp_port);
  return m;
}

Message move_request(const Dialect& dialect, std::uint32_t id) noexcept {
  Message m;
  head(m, number_of(dialect, Request::kMove), id, kMoveSize);
  put(&m.bytes[12], kExternalController);
  put(&m.bytes[16], dialect.generator);
  // [m], [rad], [rad] of the elbow.
  constexpr std::array<double, 3> kWide = {10.0, 3.12, 2.0 * std::numbers::pi};
  for (std::size_t i = 0; i < 6; ++i)
    put(&m.bytes[20 + 8 * i], kWide[i % 3]);
  return m;
}

Message bare_request(const Dialect& dialect, Request request, std::uint32_t id) noexcept {
  Message m;
  head(m, number_of(dialect, request), id, kHeaderSize);
  return m;
}

Message collision_request(const Dialect& dialect, std::uint32_t id,
                          const CollisionBehavior& behavior) noexcept {
  Message m;
  head(m, number_of(dialect, Request::kSetCollisionBehavior), id, kCollisionSize);
  std::byte* at = &m.bytes[12];
  for (int list = 0; list < 4; ++list)
    for (int i = 0; i < 7; ++i, at += 8)
      put(at, behavior.torque_nm[i]);
  for (int list = 0; list < 4; ++list)
    for (int i = 0; i < 6; ++i, at += 8)
      put(at, behavior.force[i]);
  return m;
}

Message load_request(const Dialect& dialect, std::uint32_t id, const Load& load) noexcept {
  Message m;
  head(m, number_of(dialect, Request::kSetLoad), id, kLoadSize);
  put(&m.bytes[12], load.mass_kg);
  for (int i = 0; i < 3; ++i) {
    put(&m.bytes[20 + 8 * static_cast<std::size_t>(i)], load.centre_m[i]);
    // Diagonal of nine.
    put(&m.bytes[44 + 32 * static_cast<std::size_t>(i)], load.inertia_kg_m2[i]);
  }
  return m;
}

std::optional<Received> StreamReader::next() noexcept {
  const auto drop = [this](std::size_t n) {
    std::memmove(buffer_.data(), buffer_.data() + n, filled_ - n);
    filled_ -= n;
  };
  if (skip_ > 0) {
    const std::size_t now = std::min(skip_, filled_);
    skip_ -= now;
    drop(now);
  }
  if (broken_ || skip_ > 0 || filled_ < kHeaderSize)
    return std::nullopt;
  Received message{get<std::uint32_t>(&buffer_[0]),
                   get<std::uint32_t>(&buffer_[4]),
                   get<std::uint32_t>(&buffer_[8]),
                   {}};
  constexpr std::size_t kLongest = 1 << 24;  // a robot model has some ten thousand bytes
  if (message.size < kHeaderSize || message.size > kLongest) {
    broken_ = true;
    return std::nullopt;
  }
  const std::size_t requested = std::min(message.size, kHeaderSize + message.body.size());
  if (filled_ < requested)
    return std::nullopt;
  std::memcpy(message.body.data(), &buffer_[kHeaderSize], requested - kHeaderSize);
  const std::size_t here = std::min(message.size, filled_);
  skip_ = message.size - here;
  drop(here);
  return message;
}

std::optional<Request> request_of(const Dialect& dialect, std::uint32_t command) noexcept {
  const auto& commands = dialect.panda ? kPandaCommands : kCommands;
  const auto found = std::find(commands.begin(), commands.end(), command);
  if (found == commands.end())
    return std::nullopt;
  return static_cast<Request>(found - commands.begin());
}

Outcome outcome_of(const Dialect& dialect, Request request, const Received& received) noexcept {
  if (request == Request::kConnect)
    return connect_outcome(received);
  const std::span<const Outcome> all = outcomes(dialect, request);
  const auto status = std::to_integer<std::size_t>(received.body[0]);
  return received.size > kHeaderSize && status < all.size() ? all[status] : kUnknown;
}

Message answer(const Dialect& dialect, Request request, std::uint32_t id,
               Outcome outcome) noexcept {
  Message m;
  head(m, number_of(dialect, request), id, kHeaderSize + 1);
  const std::span<const Outcome> all = outcomes(dialect, request);
  m.bytes[12] = static_cast<std::byte>(std::find(all.begin(), all.end(), outcome) - all.begin());
  return m;
}

Message connect_answer(std::uint32_t id, bool accepted, std::uint16_t version) noexcept {
  Message m;
  head(m, 0, id, kHeaderSize + 3);
  m.bytes[12] = static_cast<std::byte>(!accepted);
  put(&m.bytes[13], version);
  return m;
}

Outcome connect_outcome(const Received& received) noexcept {
  if (received.size < kHeaderSize + 3)
    return kUnknown;
  if (received.body[0] == std::byte{0})
    return kSuccess;
  return received.body[0] == std::byte{1} ? kWrongVersion : kUnknown;
}

std::uint16_t version_in(const Received& received) noexcept {
  return received.size < kHeaderSize + 3 ? std::uint16_t{0} : get<std::uint16_t>(&received.body[1]);
}

std::string words_of(Errors errors) {
  std::string words;
  for (std::size_t i = 0; i < kErrors; ++i) {
    if (!(errors >> i & 1))
      continue;
    if (!words.empty())
      words += ", ";
    words += kErrorNames[i];
  }
  return words;
}

PacketFault decode(const Dialect& dialect, std::span<const std::byte> datagram,
                   State& state) noexcept {
  if (datagram.size() != dialect.state_size)
    return PacketFault::kLength;
  const Numbers numbers{dialect};
  state.message_id = get<std::uint64_t>(datagram.data());
  state.q = numbers.joints(datagram, kQ);
  state.dq = numbers.joints(datagram, kDq);
  state.tau = numbers.joints(datagram, kTau);
  state.tau_d = numbers.joints(datagram, kTauD);
  state.ee_in_base = numbers.origin(datagram, kPoseEe);
  state.ee_in_flange = numbers.origin(datagram, kFlangeEe);
  const std::byte* flags = datagram.data() + flags_at(dialect);
  state.errors = errors_at(flags + 2, dialect.errors);
  state.reflex = errors_at(flags + 2 + dialect.errors, dialect.errors);
  const std::byte* rate = flags + flags_size(dialect.errors);
  state.success_rate = dialect.floats ? static_cast<double>(get<float>(rate)) : get<double>(rate);
  const auto generator = std::to_integer<std::uint8_t>(flags[0]),
             controller = std::to_integer<std::uint8_t>(flags[1]),
             mode = std::to_integer<std::uint8_t>(rate[-1]);
  if (generator > kNoneMode || controller > 3 || mode > 6)
    return PacketFault::kEnum;
  state.generator_mode = generator;
  state.controller = static_cast<ControllerMode>(controller);
  state.mode = static_cast<RobotMode>(mode);
  const bool finite = state.q.allFinite() && state.dq.allFinite() && state.tau_d.allFinite();
  return finite ? PacketFault::kNone : PacketFault::kNotFinite;
}

std::size_t encode(const Dialect& dialect, const State& state, std::span<std::byte> out) noexcept {
  const std::span<std::byte> bytes = out.first(dialect.state_size);
  std::fill(bytes.begin(), bytes.end(), std::byte{0});
  const Numbers numbers{dialect};
  put(bytes.data(), state.message_id);
  numbers.transform(bytes, kEeK, Vec3::Zero());
  if (dialect.nominal_frames)
    for (const std::size_t place : {kFlangeNe, kNeEe})
      numbers.transform(bytes, place, Vec3::Zero());
  for (const std::size_t place : {kPoseEe, kPoseEeD, kPoseEeC})
    numbers.transform(bytes, place, state.ee_in_base);
  numbers.transform(bytes, kFlangeEe, state.ee_in_flange);
  numbers.joints(bytes, kTau, state.tau);
  numbers.joints(bytes, kTauD, state.tau_d);
  for (const std::size_t place : {kQ, kQd, kTheta})
    numbers.joints(bytes, place, state.q);
  for (const std::size_t place : {kDq, kDtheta})
    numbers.joints(bytes, place, state.dq);
  std::byte* flags = bytes.data() + flags_at(dialect);
  flags[0] = static_cast<std::byte>(state.generator_mode);
  flags[1] = static_cast<std::byte>(state.controller);
  errors_to(flags + 2, dialect.errors, state.errors);
  errors_to(flags + 2 + dialect.errors, dialect.errors, state.reflex);
  std::byte* rate = flags + flags_size(dialect.errors);
  rate[-1] = static_cast<std::byte>(state.mode);
  dialect.floats ? put(rate, static_cast<float>(state.success_rate))
                 : put(rate, state.success_rate);
  return bytes.size();
}

PacketFault decode(const Dialect& dialect, std::span<const std::byte> datagram,
                   Command& command) noexcept {
  if (datagram.size() != dialect.command_size)
    return PacketFault::kLength;
  command.message_id = get<std::uint64_t>(datagram.data());
  for (int i = 0; i < 7; ++i)
    command.torque_nm[i] =
        get<double>(datagram.data() + kTorques + 8 * static_cast<std::size_t>(i));
  command.finished = datagram[kMotionFinished] != std::byte{0} ||
                     (dialect.torque_finished && datagram[kTorqueFinished] != std::byte{0});
  return command.torque_nm.allFinite() ? PacketFault::kNone : PacketFault::kNotFinite;
}

std::size_t encode(const Dialect& dialect, const Command& command,
                   std::span<std::byte, kMaxCommandBytes> out) noexcept {
  std::fill(out.begin(), out.end(), std::byte{0});
  put(out.data(), command.message_id);
  const auto finished = static_cast<std::byte>(command.finished);
  out[kMotionFinished] = finished;
  if (dialect.torque_finished)
    out[kTorqueFinished] = finished;
  for (int i = 0; i < 7; ++i)
    put(out.data() + kTorques + 8 * static_cast<std::size_t>(i), command.torque_nm[i]);
  return dialect.command_size;
}

}  // namespace voxtouch::fr3::fci
