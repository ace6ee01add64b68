// Single precision and culling change nothing: the hits are those of doubles, point by point, bit
// by bit.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/contact/instructions.hpp"
#include "core/contact/query_kernel.hpp"
#include "fixtures.hpp"
#include "tests/support/reference_query.hpp"
#include "tests/support/seed.hpp"

namespace voxtouch::test {
namespace {

/// A floor, a wall, a block with an inside and a lone voxel in the far corner.
voxmap::Voxmap ground(const voxmap::Grid& grid) {
  voxmap::Voxmap voxmap(grid, {0, 0, 0}, {63, 63, 63});
  add_block(voxmap, {0, 0, 0}, {63, 63, 6});
  add_block(voxmap, {0, 0, 0}, {9, 63, 40});
  voxmap.set({63, 63, 63}, voxmap::VoxelKind::kSurface);
  voxmap.finish();
  return voxmap;
}

/// Points anywhere within `reach` of the tool's origin, in no order.
pointshell::Pointshell cloud(std::mt19937_64& random, std::size_t count, double reach) {
  std::vector<std::pair<Vec3, Vec3>> points;
  for (std::size_t n = 0; n < count; ++n) {
    const Vec3 at(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
    points.emplace_back(reach / std::sqrt(3.0) * at, (random_rotation(random) * Vec3::UnitX()));
  }
  pointshell::Pointshell shell = shell_of(points, 1.0);
  for (double& area : shell.area_m2)
    area = uniform(random, 0.0, 1e-5);
  return shell;
}

class Compared {
 public:
  Compared(const voxmap::Voxmap& voxmap, const pointshell::Pointshell& shell,
           contact::PointWeights weights = contact::PointWeights::kOne)
      : voxmap_(voxmap),
        shell_(shell),
        by_area_(weights == contact::PointWeights::kArea),
        query_(voxmap, shell, weights) {
    hits_.reserve(shell.size());
  }
  /// With the kernels of every kind of processor that this one can run.
  void at(const Pose& pose) {
    query_.find(pose, hits_);
    const ReferenceHits reference = reference_hits(voxmap_, shell_, hits_.pose_WT, by_area_);
    const Vec3 surface = normal_sum(reference.surface), interior = normal_sum(reference.interior);
    const std::uint32_t tested = hits_.tested;
    for (const auto kind : {contact::Instructions::kAny, contact::Instructions::kAvx2,
                            contact::Instructions::kAvx512}) {
      if (kind > contact::widest_instructions())
        break;
      contact::use_instructions(kind);
      query_.find(pose, hits_);
      ASSERT_EQ(hits_.pose_status, contact::PoseStatus::kUsable);
      ASSERT_TRUE(same(hits_.surface, reference.surface))
          << pose.position.transpose() << ", " << pose.orientation.coeffs().transpose() << ", kind "
          << static_cast<int>(kind);
      ASSERT_TRUE(same(hits_.interior, reference.interior))
          << pose.position.transpose() << ", kind " << static_cast<int>(kind);
      ASSERT_EQ(hits_.surface.normal_sum(), surface);
      ASSERT_EQ(hits_.interior.normal_sum(), interior);
      ASSERT_EQ(hits_.tested, tested);
    }
    decided += shell_.size();
    hit += reference.surface.size() + reference.interior.size();
  }
  std::size_t decided = 0, hit = 0;

 private:
  /// Eight sums in the tool's frame, one for each place in a leaf, added in halves and rotated:
  /// bit-identical to a query.
  Vec3 normal_sum(const std::vector<contact::Hit>& hits) const {
    Vec3 lanes[8] = {}, plain = Vec3::Zero();
    for (Vec3& lane : lanes)
      lane.setZero();
    for (const contact::Hit& one : hits) {
      lanes[one.point % 8] += one.weight * shell_.normal(one.point);
      plain += one.weight * one.normal;
    }
    const Vec3 sum = ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) +
                     ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
    const Vec3 turned = hits_.pose_WT.orientation.toRotationMatrix() * sum;
    EXPECT_LE((turned - plain).norm(), 1e-12 * static_cast<double>(hits.size() + 1));
    return turned;
  }

  const voxmap::Voxmap& voxmap_;
  const pointshell::Pointshell& shell_;
  bool by_area_;
  contact::ContactQuery query_;
  contact::HitList hits_;
};

TEST(QueryEquality, HoldsInRandomPoses) {
  const std::uint64_t seed = testing::seed(20260101);
  SCOPED_TRACE(testing::seed_trace(seed));
  std::mt19937_64 random(seed);
  std::size_t decided = 0, hit = 0;
  // The grid: about the origin, off it by no round number, 1e6 m away; the voxel no power of two.
  for (const Vec3& origin : {Vec3(0, 0, 0), Vec3(-0.7, 0.31, 0.123), Vec3(1e6, -1e6, 1e6)})
    for (const double e : {0.003, 0.25}) {
      const voxmap::Grid grid{origin, e};
      const voxmap::Voxmap voxmap = ground(grid);
      for (const double reach : {3.0, 20.0, 90.0}) {
        const pointshell::Pointshell shell = cloud(random, 1001, reach * e);
        Compared compared(
            voxmap, shell,
            random() % 2 == 0 ? contact::PointWeights::kOne : contact::PointWeights::kArea);
        for (int n = 0; n < 560; ++n) {
          const Vec3 u(uniform(random, -30, 90), uniform(random, -30, 90),
                       uniform(random, -30, 90));
          ASSERT_NO_FATAL_FAILURE(compared.at({origin + e * u, random_rotation(random)}));
        }
        decided += compared.decided, hit += compared.hit;
      }
    }
  RecordProperty("points", std::to_string(decided));
  EXPECT_GT(decided, 10'000'000U);
  EXPECT_GT(hit, decided / 50);
}

/// x, or a step of one unit in the last place next to it.
double near_border(std::mt19937_64& random, double x) {
  const double infinity = std::numeric_limits<double>::infinity();
  switch (random() % 3) {
    case 0:
      return std::nextafter(x, infinity);
    case 1:
      return std::nextafter(x, -infinity);
    default:
      return x;
  }
}

TEST(QueryEquality, HoldsAtAndNextToVoxelBorders) {
  std::mt19937_64 random(7);
  for (const double e : {0x1p-8, 0.003})
    for (const Vec3& origin :
         {Vec3(0, 0, 0), Vec3(-0.7, 0.31, 0.123), Vec3(1048576, -1048576, 1048576)}) {
      const voxmap::Voxmap voxmap = ground({origin, e});
      std::vector<std::pair<Vec3, Vec3>> points;
      for (int n = 0; n < 1000; ++n) {
        Vec3 at;
        for (int a = 0; a < 3; ++a)
          at[a] = near_border(random, e * (static_cast<double>(random() % 41) - 20.0));
        points.emplace_back(at, Vec3::UnitZ());
      }
      const pointshell::Pointshell shell = shell_of(points, e);
      Compared compared(voxmap, shell);
      for (int n = 0; n < 300; ++n) {
        Vec3 at;
        for (int a = 0; a < 3; ++a)
          at[a] = near_border(random, origin[a] + e * static_cast<double>(random() % 64));
        // Also along the axes: rotations by 90 degrees, whose matrix may or may not be exact.
        const Quat turn =
            n % 2 == 0
                ? Quat::Identity()
                : Quat(Eigen::AngleAxisd(std::numbers::pi / 2 * static_cast<double>(random() % 4),
                                         Vec3::Unit(static_cast<Eigen::Index>(random() % 3))));
        ASSERT_NO_FATAL_FAILURE(compared.at({at, turn}));
      }
      EXPECT_GT(compared.hit, compared.decided / 50);
    }
}

TEST(QueryEquality, HoldsForRotatedToolsCloseToFaces) {
  // Every point is 1e-9 to 1e-4 voxels from a face, where single precision is uncertain, and the
  // voxels on either side are random.
  std::mt19937_64 random(17);
  const double e = 0.003;
  voxmap::Voxmap voxmap({Vec3(-0.7, 0.31, 0.123), e}, {0, 0, 0}, {63, 63, 63});
  for (std::int32_t i = 0; i < 64; ++i)
    for (std::int32_t j = 0; j < 64; ++j)
      for (std::int32_t k = 0; k < 64; ++k)
        voxmap.set({i, j, k}, static_cast<voxmap::VoxelKind>(random() % 3));
  voxmap.finish();
  for (int n = 0; n < 200; ++n) {
    const Pose pose{
        voxmap.grid().origin +
            e * Vec3(uniform(random, 20, 44), uniform(random, 20, 44), uniform(random, 20, 44)),
        random_rotation(random)};
    std::vector<std::pair<Vec3, Vec3>> points;
    for (int m = 0; m < 1000; ++m) {
      Vec3 u(uniform(random, 0, 64), uniform(random, 0, 64), uniform(random, 0, 64));
      const auto axis = static_cast<Eigen::Index>(random() % 3);
      u[axis] = std::floor(u[axis]) +
                (random() % 2 == 0 ? 1.0 : -1.0) * std::pow(10.0, uniform(random, -9, -4));
      points.emplace_back(pose.inverse() * (voxmap.grid().origin + e * u), Vec3::UnitZ());
    }
    const pointshell::Pointshell shell = shell_of(points, e);
    Compared compared(voxmap, shell);
    ASSERT_NO_FATAL_FAILURE(compared.at(pose));
    EXPECT_GT(compared.hit, compared.decided / 2);
  }
}

TEST(QueryEquality, HoldsForQuaternionsOfAnyUsableNorm) {
  std::mt19937_64 random(11);
  const double e = 0.003;
  const voxmap::Voxmap voxmap = ground({Vec3::Zero(), e});
  const pointshell::Pointshell shell = sphere_shell(20 * e, e);
  Compared compared(voxmap, shell);
  for (const double norm : {1.001e-3, 0.1, 1.0 + 1e-15, 999.0})
    for (int n = 0; n < 50; ++n) {
      Quat q = random_rotation(random);
      if (n % 5 == 0)
        q = Quat(1.0, 1e-300, -1e-200, 1e-17);
      if (n % 5 == 1)
        q = Quat(-1e-9, 1.0, 1e-9, 0.0);
      q.coeffs() *= norm;
      ASSERT_NO_FATAL_FAILURE(compared.at(
          {e * Vec3(uniform(random, 0, 64), uniform(random, 0, 64), uniform(random, 0, 30)), q}));
    }
  EXPECT_GT(compared.hit, 0U);
}

TEST(QueryEquality, HoldsFarFromTheGridAndForToolsThatDwarfIt) {
  std::mt19937_64 random(13);
  const double e = 0.003;
  const voxmap::Voxmap voxmap = ground({Vec3(0.1, 0.2, 0.3), e});
  for (const double reach :
       {1e3, 1e5, 2e6, 1e8}) {  // [voxels]; from 2^20 on doubles decide everything
    const pointshell::Pointshell shell = cloud(random, 501, reach * e);
    Compared compared(voxmap, shell);
    for (int n = 0; n < 100; ++n) {
      // One of its points lies within the grid.
      const Quat turn = random_rotation(random);
      const auto point = static_cast<std::size_t>(random() % shell.size());
      const Vec3 at =
          voxmap.grid().origin +
          e * Vec3(uniform(random, 0, 64), uniform(random, 0, 64), uniform(random, 0, 6));
      ASSERT_NO_FATAL_FAILURE(compared.at({at - turn * shell.point(point), turn}));
    }
    EXPECT_GT(compared.hit, 0U) << reach;
  }
  const pointshell::Pointshell shell = sphere_shell(20 * e, e);
  Compared compared(voxmap, shell);
  for (const double away : {100.0, 1e4, 1e8, 2e9})
    ASSERT_NO_FATAL_FAILURE(
        compared.at({voxmap.grid().origin + Vec3(away * e, 0.02, 0.01), random_rotation(random)}));
  EXPECT_EQ(compared.hit, 0U);
}

TEST(QueryEquality, LeavesFewPointsToDoubles) {
  // The uncertain band is slow: one point in a thousand for a tool of 200 voxels.
  const voxmap::Voxmap voxmap = ground({Vec3::Zero(), 0.001});
  contact::HitSource source;
  source.edge = 0.001;
  for (int n = 0; n < 3; ++n)
    source.r[n][n] = 1.0;
  contact::QueryFrame frame;
  ASSERT_TRUE(contact::make_query_frame(voxmap, source, 0.1, frame));
  EXPECT_GT(frame.certain, 0.5 - 0.001 / 6.0);
}

}  // namespace
}  // namespace voxtouch::test
