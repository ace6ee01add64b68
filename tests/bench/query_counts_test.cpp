// Counts behind the query's speed: points tested, bytes, allocations, instructions. With a slack of
// a quarter or more.
#include <gtest/gtest.h>

#include <cstdio>

#include "core/contact/contact_renderer.hpp"
#include "tests/bench/bench_scene.hpp"
#include "tests/bench/flat_query.hpp"
#include "tests/support/heap_count/heap_count.hpp"
#include "tests/support/process/process.hpp"

namespace voxtouch::bench {
namespace {

const voxmap::Voxmap& ground() {
  static const voxmap::Voxmap map = cup();
  return map;
}

struct Counts {
  double tested = 0.0, not_free = 0.0;  ///< fractions of all points
};

Counts counts(Place place, std::size_t points) {
  const contact::ContactQuery query(ground(), tool(place, points));
  contact::HitList hits;
  hits.reserve(points);
  Counts out;
  const std::vector<Pose> poses = path(place);
  for (const Pose& pose : poses) {
    query.find(pose, hits);
    out.tested += hits.tested,
        out.not_free += static_cast<double>(hits.surface.size() + hits.interior.size());
  }
  const double all = static_cast<double>(points * poses.size());
  out.tested /= all, out.not_free /= all;
  std::printf("%s, %zu points: %.2f %% tested, %.2f %% not free\n", name_of(place).c_str(), points,
              100.0 * out.tested, 100.0 * out.not_free);
  return out;
}

/// The baseline of the tree has equal hits.
TEST(QueryCounts, FlatLoopsFindTheSamePoints) {
  for (const Place place : {Place::kFar, Place::kNear, Place::kLight, Place::kHeavy}) {
    const pointshell::Pointshell shell = tool(place, 20'000);
    const contact::ContactQuery query(ground(), shell);
    const FlatQuery flat(ground(), shell);
    contact::HitList hits;
    std::vector<std::uint32_t> found;
    for (const Pose& pose : path(place)) {
      query.find(pose, hits);
      ASSERT_EQ(flat.find(pose, found), hits.surface.size() + hits.interior.size())
          << name_of(place);
    }
  }
}

TEST(QueryCounts, FewPointsAreTestedWithoutContact) {
  EXPECT_EQ(counts(Place::kFar, 10'000).tested, 0.0);
  EXPECT_LE(counts(Place::kNear, 1'000).tested, 0.05);
  EXPECT_LE(counts(Place::kNear, 10'000).tested, 0.01);
  EXPECT_LE(counts(Place::kNear, 100'000).tested, 0.001);
}

TEST(QueryCounts, TestedPointsAreProportionalToTouchingOnes) {
  for (const auto& [points, most] :
       {std::pair{10'000U, 15.0}, {100'000U, 8.0}, {1'000'000U, 5.0}}) {
    const Counts light = counts(Place::kLight, points);
    EXPECT_NEAR(light.not_free, 0.015, 0.01);
    EXPECT_LE(light.tested, most * light.not_free) << points;
  }
  const Counts heavy = counts(Place::kHeavy, 100'000);
  EXPECT_NEAR(heavy.not_free, 0.2, 0.05);
  EXPECT_LE(heavy.tested, 3.5 * heavy.not_free);
}

TEST(QueryCounts, BytesScaleWithSurfaceAndLookupTable) {
  const double voxels = static_cast<double>(ground().surface_count());
  std::printf("voxmap: %.2f bytes a surface voxel; tree and single precision: %.1f bytes a point\n",
              static_cast<double>(ground().bytes()) / voxels,
              static_cast<double>(contact::ContactQuery::lookup_bytes(100'000)) / 1e5);
  EXPECT_LE(static_cast<double>(ground().bytes()), 5.0 * voxels);
  EXPECT_LE(contact::ContactQuery::lookup_bytes(100'000), 23U * 100'000U);
}

TEST(QueryCounts, NoFrameAllocates) {
  if (!test::heap_is_counted())
    GTEST_SKIP() << "the sanitiser owns malloc";
  for (const Place place : {Place::kFar, Place::kNear, Place::kLight, Place::kHeavy}) {
    contact::ContactRenderer renderer(ground(), tool(place, 20'000),
                                      contact::ContactModelKind::kAdapted, {1.0});
    const std::vector<Pose> poses = path(place);
    EXPECT_EQ(test::heap_count_of([&] {
                for (const Pose& pose : poses)
                  renderer.render(pose);
              }),
              0)
        << name_of(place);
  }
}

/// Of a frame, as callgrind counts them: it shows programs a processor with AVX2 at most.
double instructions(const std::string& place, int points, const std::string& what) {
  constexpr int kFrames = 20;
  const test::Finished run =
      test::Process({"/bin/sh", "-c",
                     "exec valgrind --tool=callgrind --callgrind-out-file=/dev/null "
                     "--toggle-collect=counted_frame "
                     "\"$PROGRAM\" \"$PLACE\" \"$POINTS\" \"$FRAMES\" \"$WHAT\""},
                    {{"PROGRAM", VOXTOUCH_QUERY_FRAMES},
                     {"PLACE", place},
                     {"POINTS", std::to_string(points)},
                     {"FRAMES", std::to_string(kFrames)},
                     {"WHAT", what}})
          .wait(std::chrono::seconds(100));
  const std::string key = "Collected : ";
  const std::size_t at = run.err.find(key);
  if (run.status != 0 || at == std::string::npos)
    throw std::runtime_error("valgrind (deploy/packages.txt names it) did not count: " + run.err);
  const double out = std::stod(run.err.substr(at + key.size())) / kFrames;
  std::printf("%s, %d points, %s: %.0f instructions, %.2f a point\n", place.c_str(), points,
              what.c_str(), out, out / points);
  return out;
}

TEST(QueryCounts, InstructionsWithAvx2StayWithinTheirLimit) {
  if (!test::heap_is_counted())
    GTEST_SKIP() << "the sanitiser's own would be among them";
  if (!__builtin_cpu_supports("avx2"))
    GTEST_SKIP() << "counted for a processor with AVX2";
  EXPECT_LE(instructions("near", 10'000, "find"), 2'300.0);
  EXPECT_LE(instructions("light", 10'000, "find"), 31'000.0);
  EXPECT_LE(instructions("heavy", 10'000, "find"), 222'000.0);
  EXPECT_LE(instructions("light", 10'000, "adapted"), 48'500.0);
  EXPECT_LE(instructions("heavy", 10'000, "adapted"), 339'000.0);
  EXPECT_LE(instructions("light", 10'000, "field"), 78'000.0);
}

}  // namespace
}  // namespace voxtouch::bench
