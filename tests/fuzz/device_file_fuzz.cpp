// Device files for the coupling's designer: text to numbers that the design's checks accept, or a
// sentence.
#include "core/coupling/design/design_steps.hpp"
#include "core/coupling/design/loop_parts.hpp"
#include "core/device_fit/design_problem.hpp"
#include "core/scene/device_file.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace voxtouch;

void check(const coupling::design::AxisModel& axis) {
  FUZZ_REQUIRE(axis.inertia_min > 0.0 && axis.inertia_min <= axis.inertia_max &&
               std::isfinite(axis.inertia_max));
  FUZZ_REQUIRE(axis.damping >= 0.0 && std::isfinite(axis.damping));
  FUZZ_REQUIRE(axis.coulomb_friction >= 0.0 && std::isfinite(axis.coulomb_friction));
  FUZZ_REQUIRE(axis.resolution >= 0.0 && axis.resolution <= 0.1);
  FUZZ_REQUIRE(axis.max_effort > 0.0 && std::isfinite(axis.max_effort));
  FUZZ_REQUIRE(axis.max_stiffness > 0.0 && std::isfinite(axis.max_stiffness));
  FUZZ_REQUIRE(axis.effort_bandwidth_hz > 0.0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const std::filesystem::path file = "/fuzz/device.yaml";
  try {
    const coupling::design::DeviceModel device =
        coupling::design::model_of(scene::parse_device_file(text, file).description);
    check(device.translation);
    if (device.gives_torque)
      check(device.rotation);
    const coupling::design::LoopTiming& timing = device.timing;
    FUZZ_REQUIRE(timing.period_s >= 1e-5 && timing.period_s <= 1.0 && timing.delay_s >= 0.0 &&
                 timing.delay_s <= 1.0);
    FUZZ_REQUIRE(timing.jitter >= 0.0 && timing.jitter <= 10.0 && timing.consecutive_losses >= 0);
    scene::Scene scene;
    scene.voxel_size_m = 0.002;
    const coupling::design::DesignProblem problem =
        device_fit::design_problem(scene, device, {10.0, 1000.0}, {0.1, 1.0});
    try {
      coupling::design::refuse_impossible(problem);
    } catch (const std::invalid_argument&) {  // a sentence, too
    }
  } catch (const scene::SceneError& refused) {
    FUZZ_REQUIRE(std::string_view(refused.what()).starts_with(file.string()));
  }
  return 0;
}
