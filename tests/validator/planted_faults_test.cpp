/// The rendering as shipped, judged by the reference on the shipped scenes: without a fault no disagreement and enough
/// decided; each planted fault is caught.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/validator/shipped_scenes.hpp"
#include "tests/validator/walks.hpp"

namespace voxtouch::test {
namespace {

class RealRendering : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(ShippedScenes, RealRendering, testing::ValuesIn(shipped_scene_names()), [](const auto& test) { return test.param; });

TEST_P(RealRendering, WithoutAFaultIsNeverDisagreedWithAndAFifthIsDecided) {
  const Ground ground(shipped_scene(GetParam()));
  for (const Walk& walk : ground.walks()) {
    const Outcome outcome = ground.judged(walk);
    const JudgeCounts& c = outcome.counts;
    EXPECT_EQ(c.disagree, 0U) << outcome.first;
    EXPECT_EQ(c.checked, walk.gaps.size());
    EXPECT_EQ(c.checked, c.agree + c.in_band);
    if (walk.name.find(',') == std::string::npos) {
      EXPECT_GE(c.decided_share(), kMinDecidedShare) << walk.name;
    }
    std::printf("%-12s %-18s %4zu checked, %4zu in contact, %3.0f %% decided, %zu disagree\n", GetParam().c_str(), walk.name.c_str(),
                walk.gaps.size(), walk.contacts(), 100 * c.decided_share(), static_cast<std::size_t>(c.disagree));
  }
}

}  // namespace
}  // namespace voxtouch::test
