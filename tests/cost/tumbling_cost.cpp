// Frames of a box that tumbles at 3 m/s in and out of the cup, e = 2 mm (`virtual_tool_runs
// tumble`), for callgrind to count those in contact that use all their queries and test many
// points: the longest there are. Prints `{"frames": counted, "queries": of them}`.
#include <functional>

#include <fmt/format.h>
#include <valgrind/callgrind.h>

#include "tests/experiments/virtual_tool/runs.hpp"

extern "C" __attribute__((noipa)) void counted_frame(const std::function<void()>& frame) {
  frame();
}

constexpr std::uint32_t kManyPairs = 400;  ///< of features, in the query with the most

int main() {
  using namespace voxtouch;
  virtual_tool::Rig rig(virtual_tool::scene_mesh("cup"), 0.002, virtual_tool::tumbling_box());
  virtual_tool::TumblingHand hand(3.0, 90.0, 1);
  if (!rig.place(hand.pose()))
    return 2;
  int frames = 0, queries = 0;
  exact::VirtualToolFrame frame;
  CALLGRIND_START_INSTRUMENTATION;
  for (int n = 0; n < 1600; ++n) {
    hand.next();
    if (frame.constrained && frame.pairs_seen > kManyPairs) {
      counted_frame([&] { frame = rig.frame(hand.pose()); });
      ++frames, queries += frame.queries;
    } else {
      frame = rig.frame(hand.pose());
    }
  }
  fmt::print("{{\"frames\": {}, \"queries\": {}}}\n", frames, queries);
}
