// Rendering allocates nothing: malloc itself is counted, since operator new alone would not see
// Eigen's own calls.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>

#include "core/contact/virtual_tool.hpp"
#include "core/pointshell/edge_points.hpp"
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
           ++n) {  // free, touching, gone through, wholly inside, and out again
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

TEST(VirtualTool, AllocatesNothingInAnyFrame) {
  if (!heap_is_counted())
    GTEST_SKIP() << "the sanitiser owns malloc";
  const double e = 0.001;
  const mesh::TriangleMesh mesh =
      box_mesh(Vec3(61, 61, 61) * e, {Vec3(30.5, 30.5, 30.5) * e, Quat::Identity()});
  const Ground ground(mesh, e);
  const contact::ContactQuery query(ground.voxmap, sphere_shell(10 * e, e));
  const std::size_t points = query.shell().size();
  const Ground ball(sphere_mesh(10 * e, 3), 0.5 * e);
  const contact::ContactQuery edges(
      ball.voxmap,
      pointshell::edge_points(voxmap::ClosedMesh(mesh, ground.field.grid()), ground.field.grid()));
  contact::VirtualTool tool({.points = points,
                             .edge_points = 2 * edges.shell().size(),
                             .objects = 2,
                             .reach_m = query.reach_m(),
                             .edge_m = e});
  std::array<contact::ToolGround, 2> grounds{
      contact::ToolGround{&query, &ground.field, Vec3::Zero(), &edges, &ball.field},
      contact::ToolGround{&query, &ground.field, Vec3(0, 0, 90 * e), &edges, &ball.field}};
  std::uint32_t most_rows = 0;
  int frames_in_contact = 0;
  const long asked = heap_count_of([&] {
    for (int n = 0; n < 4000; ++n) {  // free, touching, pressed deep, pinched by the other one, a
                                      // start inside, poses that are none
      const double depth = n < 2000 ? 0.02 * n : 0.02 * (4000 - n);
      Pose pose{
          e * Vec3(n % 1000 < 500 ? 30.1 : 61.0, 29.7, 75.0 - depth),  // over the face or the edge
          Quat(Eigen::AngleAxisd(0.001 * n, Vec3::UnitX()))};
      grounds[1].displacement.z() = (90 - 0.01 * (n % 1000)) * e;
      if (n % 100 == 99)
        pose.position.x() = std::numeric_limits<double>::quiet_NaN();
      if (n % 700 == 699)
        tool.reset();
      if (n % 900 == 899)
        tool.place({e * Vec3(30, 30, 75), Quat::Identity()}, grounds);
      const contact::VirtualToolFrame frame =
          tool.frame({pose, 1e-3, n % 2 == 0 ? 0.0 : 0.4}, grounds);
      most_rows = std::max(most_rows, frame.rows);
      frames_in_contact += frame.constrained;
    }
  });
  EXPECT_EQ(asked, 0);
  EXPECT_GT(most_rows, 3U);
  EXPECT_GT(frames_in_contact, 500);
}

}  // namespace
}  // namespace voxtouch::test
