// DeviceStates from the network, as the rendering receives them: an accepted sample gives a finite
// tool pose and a finite force of every effect.
#include <memory>

#include "core/effects/effect_chain.hpp"
#include "core/rendering/device_mapping.hpp"
#include "core/rendering/scene_renderer.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/stamps.hpp"
#include "tests/fuzz/effects.hpp"
#include "tests/fuzz/wire.hpp"

namespace {

using namespace voxtouch;

scene::WorkspaceMapping device() {
  scene::WorkspaceMapping d;
  d.position_scale = 10.0;
  d.pose_WD = {Vec3(0.1, 0.2, 0.3), Quat(0.5, 0.5, 0.5, 0.5)};
  d.pose_PT.position = Vec3(0.0, 0.0, 0.05);
  d.clutch_button = 0;
  return d;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::Wire<msg::DeviceState> wire;
  static const scene::WorkspaceMapping spec = device();
  rendering::DeviceMapping mapping(spec);
  effects::EffectChain effects(fuzz::all_effects());
  std::optional<std::int64_t> begin_ns;
  fuzz::each_message(wire, data, size, [&](const msg::DeviceState& state) {
    if (mapping.update(runtime::from_msg(state.pose), runtime::from_msg(state.twist), state.buttons)
            .refused)
      return;
    if (!begin_ns)
      begin_ns = state.sample_time_ns;
    const rendering::ToolState& tool = mapping.tool();
    FUZZ_REQUIRE(tool.pose.finite() && std::abs(tool.pose.orientation.norm() - 1.0) < 1e-9);
    FUZZ_REQUIRE(tool.twist.finite());
    effects::EffectFrame frame;
    frame.tool = tool.pose, frame.twist = tool.twist, frame.dt_s = 1e-3;
    frame.time_s = runtime::seconds_between(*begin_ns, state.sample_time_ns);
    const effects::EffectForce push = effects.apply(frame);
    FUZZ_REQUIRE(push.wrench.finite() && push.stiffness.allFinite());
    FUZZ_REQUIRE(push.stiffness_bound_n_per_m >= 0.0 &&
                 std::isfinite(push.stiffness_bound_n_per_m));
  });
  return 0;
}
