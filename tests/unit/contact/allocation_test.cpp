// Rendering allocates nothing: malloc itself is counted, since operator new would miss Eigen's
// calls.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>

#include "field_scenes.hpp"
#include "fixtures.hpp"
#include "tests/support/heap_count/heap_count.hpp"

namespace voxtouch::test {
namespace {

TEST(ContactRenderer, AllocatesNothingInAnyFrame) {
  if (!heap_is_counted())
    GTEST_SKIP() << "the sanitiser owns malloc";
  const double e = 0.001;
  const voxmap::Voxmap voxmap = block({Vec3::Zero(), e}, {0, 0, 0}, {60, 60, 60});
  const Ground ground(
      box_mesh(Vec3(61, 61, 61) * e, {Vec3(30.5, 30.5, 30.5) * e, Quat::Identity()}), e);
  for (const auto kind : {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted,
                          contact::ContactModelKind::kField}) {
    const bool field = kind == contact::ContactModelKind::kField;
    contact::ContactRenderer renderer(
        field ? ground.voxmap : voxmap, sphere_shell(10 * e, e), kind,
        {100.0, field ? contact::PointWeights::kArea : contact::PointWeights::kOne}, &ground.field);
    std::uint32_t most_inside = 0;
    const long asked = heap_count_of([&] {
      for (int n = 0; n < 2000;
           ++n) {  // free, touching, passed through, fully inside, and out again
        const double depth = n < 1000 ? 0.04 * n : 0.04 * (2000 - n);
        Pose pose{e * Vec3(30.1, 29.7, 72.0 - depth),
                  Quat(Eigen::AngleAxisd(0.001 * n, Vec3::UnitX()))};
        if (n % 100 == 99)
          pose.position.x() = std::numeric_limits<double>::quiet_NaN();
        most_inside = std::max(most_inside, renderer.render(pose).contact.interior_hits);
        renderer.probe(pose);
      }
      renderer.reset();
    });
    EXPECT_EQ(asked, 0);
    EXPECT_EQ(most_inside,
              renderer.query().shell().size());  // the longest list of hits there can be
  }
}

}  // namespace
}  // namespace voxtouch::test
