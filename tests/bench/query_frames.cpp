// Frames of the contact query for callgrind to count: `query_frames PLACE POINTS FRAMES find|render`. Counted is `counted_frame` alone.
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "core/contact/contact_renderer.hpp"
#include "tests/bench/bench_scene.hpp"

extern "C" __attribute__((noinline)) void counted_frame(const std::function<void()>& frame) { frame(); }

int main(int argc, char** argv) {
  using namespace voxtouch;
  if (argc != 5) return 2;
  bench::Place place = bench::Place::kFar;
  for (const auto each : {bench::Place::kNear, bench::Place::kLight, bench::Place::kHeavy})
    if (bench::name_of(each) == argv[1]) place = each;
  const auto points = static_cast<std::size_t>(std::atol(argv[2]));
  const voxmap::Voxmap map = bench::cup();
  contact::ContactRenderer renderer(map, bench::tool(place, points), contact::ContactModelKind::kAdapted, {1.0});
  contact::HitList hits;
  hits.reserve(points);
  const std::vector<Pose> poses = bench::path(place);
  const bool find = std::string(argv[4]) == "find";
  double tested = 0.0;
  const int frames = std::atoi(argv[3]);
  for (int n = 0; n < frames; ++n)
    counted_frame([&] {
      const Pose& pose = poses[static_cast<std::size_t>(n) % poses.size()];
      if (find)
        renderer.query().find(pose, hits), tested += hits.tested;
      else
        tested += renderer.render(pose).contact.points_tested;
    });
  std::printf("%.0f\n", tested / frames);
  return 0;
}
