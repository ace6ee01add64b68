#include "tests/cost/cost.hpp"

#include <map>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "tests/support/process/process.hpp"

namespace voxtouch::test {
namespace {

constexpr int kFrames = 300;

/// Output of the program, and instructions of `counted_frame` by callgrind.
struct Counted {
  nlohmann::json printed;
  double instructions = 0.0;
};
Counted counted(const std::string& arguments, std::map<std::string, std::string> environment,
                const std::string& what) {
  const Finished run = Process({"/bin/sh", "-c",
                                "exec valgrind --tool=callgrind --callgrind-out-file=/dev/null "
                                "--instr-atstart=no --toggle-collect=counted_frame "
                                "\"$PROGRAM\" " +
                                    arguments},
                               std::move(environment))
                           .wait(std::chrono::seconds(100));
  const std::string key = "Collected : ";
  const std::size_t place = run.err.find(key);
  if (run.status != 0 || place == std::string::npos)
    throw std::runtime_error("valgrind (deploy/packages.txt names it) did not count " + what +
                             ": " + run.err);
  return {nlohmann::json::parse(run.out), std::stod(run.err.substr(place + key.size()))};
}

}  // namespace

FrameCost cost_of(const std::filesystem::path& scene, const std::string& motion,
                  const std::string& mode) {
  const Counted run = counted("\"$SCENE\" \"$MOTION\" \"$FRAMES\" \"$WAY\"",
                              {{"PROGRAM", VOXTOUCH_FRAME_COST},
                               {"SCENE", scene.string()},
                               {"MOTION", motion},
                               {"FRAMES", std::to_string(kFrames)},
                               {"WAY", mode}},
                              scene.string());
  const nlohmann::json& j = run.printed;
  FrameCost out;
  out.instructions = run.instructions / kFrames;
  out.live_bytes = j["live"], out.peak_bytes = j["peak"], out.plan_bytes = j["plan"],
  out.force = j["sum"];
  return out;
}

TumblingCost tumbling_cost() {
  const Counted run = counted("", {{"PROGRAM", VOXTOUCH_TUMBLING_COST}}, "the tumbling box");
  TumblingCost out{.frames = run.printed["frames"], .work = run.printed["work"]};
  out.instructions = run.instructions / out.frames;
  return out;
}

}  // namespace voxtouch::test
