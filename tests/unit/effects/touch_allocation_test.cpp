// Effects at the touched point allocate nothing: malloc itself is counted, since operator new would
// miss Eigen's calls.
#include <algorithm>
#include <array>

#include "tests/support/heap_count/heap_count.hpp"
#include "tests/unit/effects/touch_support.hpp"

namespace voxtouch::test {
namespace {

TEST(TouchEffects, AllocateNothingInAnyFrame) {
  if (!heap_is_counted())
    GTEST_SKIP() << "the sanitiser owns malloc";
  effects::EffectChain chain(
      {effect("friction", {{"coulomb", {0.5}}, {"sticking", {1.5}}}),
       effect("surface_damping", {{"damping_ns_per_m", {3}}}),
       effect("texture", {{"pattern", {1}}, {"wavelength_m", {0.002}}, {"force_n", {0.3}}})});
  double pushed_n = 0.0;
  const long asked = heap_count_of([&] {
    for (int n = 0; n < 3000; ++n) {
      effects::EffectFrame frame;
      frame.tool = {Vec3(1e-5 * n, 0, 0.011 - 0.002 * std::sin(0.01 * n)),
                    Quat(Eigen::AngleAxisd(1e-4 * n, Vec3::UnitY()))};
      frame.twist.linear = Vec3(0.01, 0, 0), frame.dt_s = 0.001, frame.time_s = 0.001 * n;
      const contact::ContactResult contact =
          on_plane(frame.tool, BallTool{}, Vec3::UnitZ(), 0, 1000);
      std::array<effects::ObjectContact, 24> touched;  // more than there is room for
      for (std::uint32_t o = 0; o < touched.size(); ++o)
        touched[o] = {(o + static_cast<std::uint32_t>(n) / 100) % 40, &contact, {}};
      frame.contacts = touched;
      pushed_n = std::max(pushed_n, chain.apply(frame).wrench.force.norm());
      if (n % 500 == 499)
        chain.reset();
    }
  });
  EXPECT_EQ(asked, 0);
  EXPECT_GT(pushed_n, 1.0);
}

}  // namespace
}  // namespace voxtouch::test
