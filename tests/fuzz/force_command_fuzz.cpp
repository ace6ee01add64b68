// ForceCommands from the network, through gate and guard before a device: the output is finite,
// within force, torque and slew limits, and the last check of the driver accepts it.
#include "devices/command_gate.hpp"
#include "devices/force_guard.hpp"
#include "devices/limits.hpp"
#include "nodes/runtime/convert.hpp"
#include "tests/fuzz/wire.hpp"

namespace {

using namespace voxtouch;

constexpr std::uint64_t kSession = 7;
constexpr std::int64_t kPeriodNs = 1'000'000;

DeviceDescription device() {
  DeviceDescription d;
  d.rate_hz = 1000.0;
  d.max_force_n = 8.0, d.max_torque_nm = 0.5;
  d.max_force_rate_n_per_s = 4000.0, d.max_torque_rate_nm_per_s = 250.0;
  return d;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::Wire<msg::ForceCommand> wire;
  static const DeviceDescription description = device();
  devices::ForceGuard guard(devices::guard_config(description));
  devices::CommandGate gate(kSession);
  Wrench last;
  std::uint64_t sample = 0;
  const auto cycle = [&](const std::optional<devices::GuardInput>& command) {
    const Wrench out = guard.pass(command, static_cast<std::int64_t>(sample++) * kPeriodNs);
    FUZZ_REQUIRE(devices::check_command(out, description).has_value());
    const double slack = 1.0 + 1e-9,
                 dt_s = 3e-3;  // a gap opens the slew limit by the hold time at most
    FUZZ_REQUIRE((out.force - last.force).norm() <=
                 slack * description.max_force_rate_n_per_s * dt_s);
    FUZZ_REQUIRE((out.torque - last.torque).norm() <=
                 slack * description.max_torque_rate_nm_per_s * dt_s);
    last = out;
  };
  cycle({});
  fuzz::each_message(wire, data, size, [&](const msg::ForceCommand& command) {
    const devices::GateVerdict verdict =
        gate.accept(1, command.session_id, command.sequence_number, sample);
    guard.count(verdict);
    if (verdict == devices::GateVerdict::kAccepted)
      cycle(devices::GuardInput{runtime::from_msg(command.wrench), command.valid_until_ns});
    else
      cycle({});
  });
  // No more commands: zero after three periods and the fade.
  for (int n = 0; n < 26; ++n)
    cycle({});
  FUZZ_REQUIRE(last.zero());
  return 0;
}
