#pragma once
/// Instructions and heap of frames, counted by callgrind: the same number on any machine, however
/// busy it is.
#include <filesystem>
#include <string>

namespace voxtouch::test {

struct FrameCost {
  double instructions = 0.0;  ///< a frame
  double live_bytes = 0.0, peak_bytes = 0.0, plan_bytes = 0.0;
  double force = 0.0;  ///< sum over the frames: zero where nothing was touched
};

/// `mode`: see frame_cost.cpp. Throws with what valgrind said where it did not run.
FrameCost cost_of(const std::filesystem::path& scene, const std::string& motion,
                  const std::string& mode);

struct TumblingCost {
  double instructions = 0.0;  ///< a frame
  int frames = 0;             ///< counted
  double work = 0.0;          ///< of these, in units of exact::Work
};
/// Of the frames that tumbling_cost.cpp says. Throws likewise.
TumblingCost tumbling_cost();

}  // namespace voxtouch::test
