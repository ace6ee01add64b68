// Frames of a box that tumbles at 3 m/s in and out of the cup (`virtual_tool_runs tumble`).
// callgrind counts the frames in contact with much work. The same motion runs twice: first to find
// these frames, then to count them. Prints `{"frames": counted, "work": of them}`.
#include <fmt/format.h>
#include <valgrind/callgrind.h>

#include <functional>
#include <vector>

#include "tests/experiments/virtual_tool/runs.hpp"

extern "C" __attribute__((noipa)) void counted_frame(const std::function<void()>& frame) {
  frame();
}

namespace {

constexpr std::uint64_t kMuchWork = 3000;  ///< in units of exact::Work
constexpr int kFrames = 1600;

/// Calls `run(n, next)` for each frame n; `next` renders it into `frame`.
void tumble(const std::function<void(int, const std::function<void()>&)>& run,
            voxtouch::exact::VirtualToolFrame& frame) {
  using namespace voxtouch;
  virtual_tool::Rig rig(virtual_tool::scene_mesh("cup"), 0.002, virtual_tool::tumbling_box());
  virtual_tool::TumblingHand hand(3.0, 90.0, 1);
  rig.place(hand.pose());
  for (int n = 0; n < kFrames; ++n) {
    hand.next();
    run(n, [&] { frame = rig.frame(hand.pose()); });
  }
}

}  // namespace

int main() {
  voxtouch::exact::VirtualToolFrame frame;
  std::vector<bool> counts(kFrames);
  tumble(
      [&](int n, const std::function<void()>& next) {
        next();
        counts[static_cast<std::size_t>(n)] = frame.constrained && frame.work > kMuchWork;
      },
      frame);
  int frames = 0;
  std::uint64_t work = 0;
  CALLGRIND_START_INSTRUMENTATION;
  tumble(
      [&](int n, const std::function<void()>& next) {
        if (!counts[static_cast<std::size_t>(n)])
          return next();
        counted_frame(next);
        ++frames, work += frame.work;
      },
      frame);
  fmt::print("{{\"frames\": {}, \"work\": {}}}\n", frames, work);
}
