// DeviceDescription and ScenePlan from the network, as the coupling node fits a coupling to them: a
// refusal with a sentence, or a coupling that starts and answers within the limits.
#include "core/coupling/running_coupling.hpp"
#include "core/device_fit/design_problem.hpp"
#include "core/device_fit/fit_coupling.hpp"
#include "nodes/coupling/coupling_fit.hpp"
#include "nodes/runtime/device_message.hpp"
#include "tests/fuzz/wire.hpp"

namespace {

using namespace voxtouch;

scene::Scene scene_of(bool designed) {
  scene::Scene scene;
  scene.name = "fuzz";
  scene.voxel_size_m = 0.002;
  scene.contact.stiffness_n_per_m = 10.0;
  if (designed)
    scene.design.emplace();
  return scene;
}

void check(const scene::Scene& scene, coupling_node::Fitting& fitting) {
  const device_fit::FittedCoupling fitted = fitting.fit();
  if (!fitted.refusal.empty())
    return;
  const coupling::design::DeviceModel& device = fitting.device();
  const coupling::CouplingLimits limits = device_fit::limits_W(scene.device, device);
  coupling::RunningCoupling running(fitted.spec, limits, device.timing.period_s);
  coupling::CouplingInput input;
  input.contact.force = Vec3(0.0, 0.0, 1.0);
  input.contact_stiffness_n_per_m = 100.0;
  for (int n = 0; n < 10; ++n) {
    const coupling::CouplingOutput out = running.step(input, device.timing.period_s);
    FUZZ_REQUIRE(out.wrench.finite() &&
                 out.wrench.force.norm() <= limits.max_force_n * (1.0 + 1e-9));
  }
}

}  // namespace

/// First byte: whether the coupling is designed (slow), and the length of the description; then
/// both messages.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::Wire<msg::DeviceDescription> descriptions;
  static fuzz::Wire<msg::ScenePlan> plans;
  static const scene::Scene by_hand = scene_of(false), designed = scene_of(true);
  fuzz::Bytes in(data, size);
  const scene::Scene& scene = in.take<std::uint8_t>() % 64 == 63 ? designed : by_hand;
  coupling_node::Fitting fitting(scene);
  const auto with_header = [](std::string_view body) {
    return std::string("\0\1\0\0", 4).append(body);
  };
  const std::string_view description = in.take(in.take<std::uint16_t>());
  const bool both =
      descriptions.through(with_header(description),
                           [&](const msg::DeviceDescription& d) {
                             fitting.set_device(runtime::from_msg(d), d.session_id);
                           }) &&
      plans.through(with_header(in.rest()), [&](const msg::ScenePlan& p) { fitting.set_plan(p); });
  if (both)
    check(scene, fitting);
  return 0;
}
