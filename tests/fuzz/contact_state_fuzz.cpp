// ContactStates from the network, through the coupling as its node runs it: every command is finite
// and within the device's limits.
#include "core/rendering/device_mapping.hpp"
#include "nodes/coupling/ring_messages.hpp"
#include "tests/fuzz/wire.hpp"

namespace {

using namespace voxtouch;

constexpr double kPeriodS = 1e-3, kMaxForceN = 8.0, kMaxTorqueNm = 0.5;

coupling::CouplingSpec spec_of(std::uint8_t choice) {
  constexpr std::array kinds = {"shaping_filter", "spring_damper", "direct"};
  coupling::CouplingSpec spec;
  spec.kind = kinds[choice % kinds.size()];
  if (choice & 4)
    spec.stiffness_cap_n_per_m = 300.0, spec.stiffness_cap_nm_per_rad = 1.0;
  if (choice & 8)
    spec.injected_damping_ns_per_m = 2.0, spec.injected_damping_nms_per_rad = 0.01;
  return spec;
}

scene::WorkspaceMapping device() {
  scene::WorkspaceMapping d;
  d.pose_WD = {Vec3(0.1, 0.2, 0.3), Quat(0.5, 0.5, 0.5, 0.5)};
  d.pose_PT.position = Vec3(0.0, 0.0, 0.05);
  return d;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::Wire<msg::ContactState> wire;
  static const scene::WorkspaceMapping spec = device();
  if (size == 0)
    return 0;
  coupling::RunningCoupling coupling(spec_of(data[0]), {kMaxForceN, kMaxTorqueNm}, kPeriodS);
  rendering::WrenchToDevice to_device(spec);
  std::optional<std::int64_t> last_ns;
  const double arm_m = spec.pose_PT.position.norm(), slack = 1.0 + 1e-9;
  fuzz::each_message(wire, data + 1, size - 1, [&](const msg::ContactState& contact) {
    const double dt_s =
        last_ns ? runtime::seconds_between(*last_ns, contact.sample_time_ns) : kPeriodS;
    last_ns = contact.sample_time_ns;
    const coupling::CouplingInput input = coupling_node::coupling_input(contact);
    const coupling::CouplingOutput out = coupling.step(input, dt_s);
    const Wrench in_device = to_device(out.wrench, input.tool.orientation);
    const msg::ForceCommand command =
        coupling_node::force_command(contact, out, in_device, 5.0 * kPeriodS);
    const Wrench wrench = runtime::from_msg(command.wrench);
    FUZZ_REQUIRE(wrench.finite() && wrench.force.norm() <= slack * kMaxForceN);
    FUZZ_REQUIRE(wrench.torque.norm() <= slack * (kMaxTorqueNm + arm_m * kMaxForceN));
    FUZZ_REQUIRE(std::isfinite(command.energy_j) && std::isfinite(command.energy_rotation_j));
    FUZZ_REQUIRE(std::isfinite(command.injected_n));
    FUZZ_REQUIRE(command.valid_until_ns >= command.sample_time_ns);
    FUZZ_REQUIRE(coupling.velocity().finite());
  });
  return 0;
}
