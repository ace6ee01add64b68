#include "tests/cost/cost.hpp"

#include <stdexcept>

#include <nlohmann/json.hpp>

#include "tests/support/process/process.hpp"

namespace voxtouch::test {
namespace {

constexpr int kFrames = 300;

}  // namespace

FrameCost cost_of(const std::filesystem::path& scene, const std::string& motion, const std::string& way) {
  const Finished run =
      Process({"/bin/sh", "-c",
               "exec valgrind --tool=callgrind --callgrind-out-file=/dev/null --instr-atstart=no --toggle-collect=counted_frame "
               "\"$PROGRAM\" \"$SCENE\" \"$MOTION\" \"$FRAMES\" \"$WAY\""},
              {{"PROGRAM", VOXTOUCH_FRAME_COST},
               {"SCENE", scene.string()},
               {"MOTION", motion},
               {"FRAMES", std::to_string(kFrames)},
               {"WAY", way}})
          .wait(std::chrono::seconds(100));
  const std::string key = "Collected : ";
  const std::size_t place = run.err.find(key);
  if (run.status != 0 || place == std::string::npos)
    throw std::runtime_error("valgrind (deploy/packages.txt names it) did not count " + scene.string() + ": " +
                             run.err);
  const nlohmann::json j = nlohmann::json::parse(run.out);
  FrameCost out;
  out.instructions = std::stod(run.err.substr(place + key.size())) / kFrames;
  out.live_bytes = j["live"], out.peak_bytes = j["peak"], out.plan_bytes = j["plan"], out.force = j["sum"];
  return out;
}

}  // namespace voxtouch::test
