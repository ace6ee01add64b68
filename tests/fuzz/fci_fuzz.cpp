// Messages of a Franka arm, or of an impostor. First byte: one of four versions, and the kind of
// the rest. Below 128: a stream of the command channel, cut as the next byte selects; no message
// exceeds its data. Otherwise: states, each the previous one with some bytes patched, through
// decoder, session and torque ramp: no NaN or infinity, no force outside torque control, no torque
// beyond a joint's limit or a step, whatever the robot reports as last received.
#include <algorithm>
#include <array>
#include <vector>

#include "devices/fr3/fci_codec.hpp"
#include "devices/fr3/fci_session.hpp"
#include "devices/fr3/fr3_arm.hpp"
#include "devices/fr3/torque_ramp.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace voxtouch;
using namespace voxtouch::fr3;

void stream(const fci::Dialect& dialect, fuzz::Bytes in) {
  fci::StreamReader reader;
  while (!in.empty() && !reader.broken()) {
    const std::span<std::byte> room = reader.room();
    FUZZ_REQUIRE(!room.empty());
    const std::string_view piece =
        in.take(std::min<std::size_t>(1 + in.take<std::uint8_t>(), room.size()));
    std::memcpy(room.data(), piece.data(), piece.size());
    reader.took(piece.size());
    while (const auto message = reader.next()) {
      FUZZ_REQUIRE(message->size >= fci::kHeaderSize);
      if (const auto request = fci::request_of(dialect, message->command))
        FUZZ_REQUIRE(!fci::sentence_of(fci::outcome_of(dialect, *request, *message)).empty());
    }
  }
}

void states(const fci::Dialect& dialect, fuzz::Bytes in) {
  const arm::Joints most = (arm::Joints() << 60, 45, 60, 45, 10, 10, 10).finished();
  constexpr double kStep = 0.95;
  fci::FciSession session(dialect);
  TorqueRamp ramp(kStep, most);
  const Fr3Arm arm;
  fci::State first;
  first.q = fr3_rest_posture();
  std::vector<std::byte> bytes(dialect.state_size);
  (void)fci::encode(dialect, first, bytes);
  for (int n = 0; n < 128 && !in.empty(); ++n) {
    for (int patches = in.take<std::uint8_t>() & 7; patches > 0; --patches) {
      const std::size_t at = in.take<std::uint16_t>() % bytes.size();
      const std::string_view patch =
          in.take(std::min<std::size_t>(in.take<std::uint8_t>() % 33, bytes.size() - at));
      std::memcpy(&bytes[at], patch.data(), patch.size());
    }
    fci::State state;
    if (fci::decode(dialect, bytes, state) != fci::PacketFault::kNone)
      continue;
    FUZZ_REQUIRE(state.q.allFinite() && state.dq.allFinite() && state.tau_d.allFinite() &&
                 state.errors >> fci::kErrors == 0);
    session.update(state, 1e-3, false);
    if (const auto due = session.due())
      session.answered(*due, static_cast<fci::Outcome>(in.take<std::uint8_t>() % 14));
    FUZZ_REQUIRE(!session.force_allowed() || (state.mode == fci::RobotMode::kMove &&
                                              state.controller == fci::ControllerMode::kExternal));
    session.listens() ? ramp.acknowledge(state.tau_d) : ramp.forget();
    const Wrench push =
        session.force_allowed() ? Wrench{Vec3(20.0, -10.0, 30.0), Vec3(1.0, 0.0, -1.0)} : Wrench{};
    const arm::Joints torque = ramp.next(arm.at(state.q).jacobian, push, arm::Joints::Zero());
    FUZZ_REQUIRE(torque.allFinite() && (torque.array().abs() <= most.array() + kStep).all());
    FUZZ_REQUIRE(session.listens() || torque.isZero(0.0));
    std::array<std::byte, fci::kMaxCommandBytes> out;
    fci::Command back;
    const std::size_t size = fci::encode(dialect, {state.message_id, torque, false}, out);
    FUZZ_REQUIRE(fci::decode(dialect, std::span(out).first(size), back) ==
                     fci::PacketFault::kNone &&
                 back.torque_nm == torque);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array<std::uint16_t, 8> kVersions = {10, 9, 6, 5, 3, 4, 7, 8};
  fuzz::Bytes in(data, size);
  const auto choice = in.take<std::uint8_t>();
  const fci::Dialect& dialect = *fci::dialect_of(kVersions[choice % kVersions.size()]);
  choice < 128 ? stream(dialect, in) : states(dialect, in);
  return 0;
}
