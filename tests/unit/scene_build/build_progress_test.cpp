// How far a build is, in words.
#include <gtest/gtest.h>

#include "nodes/runtime/parallel_for.hpp"
#include "nodes/scene_build/build_progress.hpp"

namespace voxtouch::test::build_progress {
namespace {

using scene_build::in_words;

TEST(BuildProgress, PrintsTheRatioAndTheRemainingTime) {
  EXPECT_EQ(
      in_words({.name = "field", .for_s = 9.0, .loop = 2, .loop_s = 4.0, .done = 40, .count = 100}),
      "field, loop 2: 40 %, about 6 s more");
  EXPECT_EQ(
      in_words(
          {.name = "field", .for_s = 9.0, .loop = 1, .loop_s = 4.0, .done = 999, .count = 1000}),
      "field, loop 1: 99 %, about 1 s more");
  EXPECT_EQ(
      in_words(
          {.name = "voxmap", .for_s = 9.0, .loop = 1, .loop_s = 8.0, .done = 1000, .count = 1000}),
      "voxmap: 9 s so far")
      << "what follows the loop has no fraction";
  EXPECT_EQ(in_words({.name = "meshes", .for_s = 3.1}), "meshes: 3 s so far");
  EXPECT_EQ(
      in_words({.name = "voxmap", .for_s = 2.0, .loop = 1, .loop_s = 1.0, .done = 0, .count = 10}),
      "voxmap: 2 s so far");
}

TEST(BuildProgress, CountsTheBodiesOfEachLoopOnAnyNumberOfThreads) {
  scene_build::BuildProgress progress("test");
  progress.begin_step("voxmap");
  const ParallelFor loop = progress.counted(runtime::threaded_for(3));
  std::atomic<std::size_t> called{0};
  loop(100, [&](std::size_t) { ++called; });
  EXPECT_EQ(called, 100U);
  EXPECT_EQ(progress.so_far().loop, 1U);
  EXPECT_EQ(progress.so_far().done, 100U);
  EXPECT_EQ(progress.so_far().count, 100U);
  loop(7, [](std::size_t) {});
  EXPECT_EQ(progress.so_far().loop, 2U);
  EXPECT_EQ(progress.so_far().done, 7U);
  EXPECT_THROW(loop(5,
                    [](std::size_t i) {
                      if (i == 2)
                        throw std::runtime_error("stopped");
                    }),
               std::runtime_error);
  progress.begin_step("pointshell");
  EXPECT_EQ(progress.so_far().name, "pointshell");
  EXPECT_EQ(progress.so_far().loop, 0U);
}

}  // namespace
}  // namespace voxtouch::test::build_progress
