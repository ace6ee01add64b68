// Coarse ratios of CPU time, in turns within one thread, with limits of about twice the values of a
// quiet machine. They detect a loop without its kernel or a frame that works twice, under any load.
// deploy/bench measures precisely.
#include <gtest/gtest.h>

#include <ctime>

#include <algorithm>
#include <cstdio>
#include <functional>

#include "core/contact/contact_renderer.hpp"
#include "tests/bench/bench_scene.hpp"
#include "tests/bench/read_floor.hpp"
#include "tests/support/heap_count/heap_count.hpp"

namespace voxtouch::bench::query_ratios {
namespace {

constexpr std::size_t kPoints = 100'000;

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Times {
  double read = 0.0, find = 0.0, render = 0.0;  ///< of a frame, medians [s]
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

Times times(const voxmap::Voxmap& map, Place place) {
  constexpr int kRounds = 11;
  contact::ContactRenderer renderer(map, tool(place, kPoints), contact::ContactModelKind::kAdapted,
                                    {1.0});
  contact::HitList hits;
  hits.reserve(kPoints);
  const ReadFloor floor(kPoints);
  const std::vector<Pose> poses = eight_poses(place);
  volatile float sink = 0.0F;
  std::vector<double> of[3];
  const std::function<void(const Pose&)> each[] = {
      [&](const Pose&) { sink = floor.read(); },
      [&](const Pose& pose) { renderer.query().find(pose, hits); },
      [&](const Pose& pose) { renderer.render(pose); }};
  for (int round = 0; round < kRounds; ++round)
    for (int what = 0; what < 3; ++what) {
      const double begin = thread_seconds();
      for (const Pose& pose : poses)
        each[what](pose);
      of[what].push_back((thread_seconds() - begin) / static_cast<double>(poses.size()));
    }
  const Times out{median(of[0]), median(of[1]), median(of[2])};
  std::printf("%s: reading %.1f us, find %.2f of it, render %.2f of find\n", name_of(place).c_str(),
              1e6 * out.read, out.find / out.read, out.render / out.find);
  return out;
}

TEST(QueryRatios, StayWithinTwiceTheMeasuredOnes) {
  if (!test::heap_is_counted())
    GTEST_SKIP() << "the sanitiser's own would be among them";
  if (!__builtin_cpu_supports("avx2"))
    GTEST_SKIP() << "of kernels for AVX2";
  const voxmap::Voxmap map = cup();
  const Times near = times(map, Place::kNear), light = times(map, Place::kLight),
              heavy = times(map, Place::kHeavy);
  EXPECT_LE(near.find, 0.15 * near.read);
  EXPECT_LE(light.find, 3.0 * light.read);
  EXPECT_LE(heavy.find, 32.0 * heavy.read);
  EXPECT_LE(light.render, 2.6 * light.find);
  EXPECT_LE(heavy.render, 3.2 * heavy.find);
}

}  // namespace
}  // namespace voxtouch::bench::query_ratios
