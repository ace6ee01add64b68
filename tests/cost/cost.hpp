#pragma once
/// Instructions and heap of frames, counted by callgrind: the same number on any machine, however
/// busy it is.
#include <filesystem>
#include <string>

namespace voxtouch::test {

struct FrameCost {
  double instructions = 0.0;  ///< a frame
  double live_bytes = 0.0, peak_bytes = 0.0, plan_bytes = 0.0;
  double force = 0.0;  ///< sum over the frames: zero without contact
};

/// `mode`: see frame_cost.cpp. Throws with valgrind's output if it fails.
FrameCost cost_of(const std::filesystem::path& scene, const std::string& motion,
                  const std::string& mode);

struct TumblingCost {
  double instructions = 0.0;  ///< a frame
  int frames = 0;             ///< counted
  double work = 0.0;          ///< of these, in units of exact::Work
};
/// Cost of the frames of tumbling_cost.cpp. Throws as cost_of.
TumblingCost tumbling_cost();

}  // namespace voxtouch::test
