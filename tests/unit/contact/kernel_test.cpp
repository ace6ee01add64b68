// Sums of the kernels: bit-identical results on every kind of processor, and equal to plain loops
// over the hits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/contact/instructions.hpp"
#include "core/contact/limits.hpp"
#include "core/contact/penalty_sums.hpp"
#include "field_scenes.hpp"
#include "fixtures.hpp"
#include "tests/support/seed.hpp"

namespace voxtouch::test {
namespace kernel_test {

constexpr double kEdge = 0.001;
constexpr std::array kModels = {contact::ContactModelKind::kOriginal,
                                contact::ContactModelKind::kAdapted,
                                contact::ContactModelKind::kField};

/// Kinds that this processor supports, the plain ones first.
std::vector<contact::Instructions> kinds() {
  std::vector<contact::Instructions> out;
  for (const auto kind :
       {contact::Instructions::kAny, contact::Instructions::kAvx2, contact::Instructions::kAvx512})
    if (kind <= contact::widest_instructions())
      out.push_back(kind);
  return out;
}

class KernelTest : public ::testing::Test {
 protected:
  ~KernelTest() override { contact::use_instructions(contact::widest_instructions()); }
};

template <class Matrix>
bool same_numbers(const Matrix& a, const Matrix& b) {
  return std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

::testing::AssertionResult same(const contact::StageResult& a, const contact::StageResult& b) {
  const contact::ContactResult &p = a.contact, &q = b.contact;
  if (!same_bits(p.wrench, q.wrench))
    return ::testing::AssertionFailure()
           << "wrench: " << (p.wrench.force - q.wrench.force).transpose();
  if (!same_numbers(p.stiffness, q.stiffness))
    return ::testing::AssertionFailure() << "stiffness";
  if (p.stiffness_bound_n_per_m != q.stiffness_bound_n_per_m)
    return ::testing::AssertionFailure() << "stiffness bound";
  if (!same_numbers(p.mean_normal, q.mean_normal) || p.coherence != q.coherence)
    return ::testing::AssertionFailure() << "mean normal";
  if (p.deepest_depth_m != q.deepest_depth_m || !same_numbers(p.deepest_point, q.deepest_point))
    return ::testing::AssertionFailure() << "deepest point";
  if (p.surface_hits != q.surface_hits || p.interior_hits != q.interior_hits ||
      p.points_tested != q.points_tested)
    return ::testing::AssertionFailure() << "counts";
  return p.saturated == q.saturated && a.latched == b.latched
             ? ::testing::AssertionSuccess()
             : ::testing::AssertionFailure() << "flags";
}

/// A box with a slot: a ball in it touches a floor and two opposite walls, and passes through all
/// of them.
mesh::TriangleMesh slotted() {
  return joined(
      joined(box_mesh(Vec3(0.04, 0.06, 0.05), {Vec3(-0.0302, 0.0011, 0.0253), Quat::Identity()}),
             box_mesh(Vec3(0.04, 0.06, 0.05), {Vec3(0.0303, 0.0012, 0.0252), Quat::Identity()})),
      box_mesh(Vec3(0.02, 0.06, 0.02), {Vec3(0.0001, 0.0013, 0.0101), Quat::Identity()}));
}

TEST_F(KernelTest, IsBitIdenticalOnEveryProcessor) {
  const std::uint64_t seed = testing::seed(20261124);
  SCOPED_TRACE(testing::seed_trace(seed));
  const Ground ground(slotted(), kEdge);
  pointshell::Pointshell shell = sphere_shell(10.7 * kEdge, 0.6 * kEdge);
  std::mt19937_64 random(seed);
  for (double& area : shell.area_m2)
    area = uniform(random, 0.0, 1e-6);
  for (const contact::ContactModelKind model : kModels)
    for (const auto weights : {contact::PointWeights::kArea, contact::PointWeights::kOne}) {
      if (weights == contact::PointWeights::kOne && !contact::remembers(model))
        continue;
      std::vector<contact::ContactRenderer> renderers;
      for (std::size_t n = 0; n < kinds().size(); ++n)
        renderers.emplace_back(ground.voxmap, shell, model,
                               contact::ContactParameters{100.0, weights}, &ground.field);
      int blended = 0, mean = 0, own = 0, gone_through = 0;
      Pose pose{Vec3(0, 0, 0.05), random_rotation(random)};
      for (int n = 0; n < 1500; ++n) {
        // Wanders about in the slot and through its walls, slowly, and now and then with a jump.
        const double far = n % 300 == 299 ? 0.01 : 0.0004;
        pose.position +=
            far * Vec3(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
        pose.position =
            pose.position.cwiseMax(Vec3(-0.004, -0.02, 0.022)).cwiseMin(Vec3(0.004, 0.02, 0.045));
        pose.orientation = Quat(Eigen::AngleAxisd(0.02 * uniform(random, -1, 1), Vec3::UnitZ())) *
                           pose.orientation;
        std::vector<contact::StageResult> results;
        for (std::size_t k = 0; k < renderers.size(); ++k) {
          contact::use_instructions(kinds()[k]);
          results.push_back(renderers[k].render(pose));
          ASSERT_TRUE(same(results.front(), results.back()))
              << contact::name_of(model) << ", frame " << n << ", kind " << k;
        }
        const contact::ContactResult& r = results.front().contact;
        const double fraction =
            r.surface_hits > 0 ? contact::mean_weight(model, r.coherence) : -1.0;
        blended += fraction > 0.0 && fraction < 1.0, mean += fraction >= 1.0,
            own += fraction == 0.0;
        gone_through += r.interior_hits > 0;
      }
      SCOPED_TRACE(contact::name_of(model));
      EXPECT_GT(gone_through, 50);
      if (model == contact::ContactModelKind::kAdapted) {
        EXPECT_GT(std::min({blended, mean, own}), 5) << blended << ", " << mean << ", " << own;
      }
    }
}

/// The sums once more, one hit after the other.
struct Plain {
  Wrench wrench;
  contact::StiffnessSum stiffness;
  double weights = 0.0, deepest = 0.0;
  Vec3 deepest_point = Vec3::Zero();
};

Plain plain_sums(const contact::HitList& hits, const contact::ForceDirection& direction) {
  Plain out;
  for (const contact::Hit& hit : hits.surface) {
    Vec3 u = hit.normal;
    if (direction.mean_weight > 0.0) {
      u = direction.mean_weight * direction.mean + (1.0 - direction.mean_weight) * hit.normal;
      u /= std::max(u.norm(), contact::limits::kShortestDirection);
    }
    const double depth = u.dot(hit.to_centre);
    if (!(depth > 0.0))
      continue;
    const Vec3 force = hit.weight * depth * u;
    out.wrench.force += force, out.wrench.torque += hit.arm.cross(force);
    out.stiffness.add(hit.arm, u, hit.weight);
    out.weights += hit.weight;
    if (depth > out.deepest)
      out.deepest = depth, out.deepest_point = hits.pose_WT.position + hit.arm;
  }
  return out;
}

void expect_near(const contact::ContactResult& result, const Mat6& stiffness, const Plain& plain,
                 double k) {
  Mat6 expected = Mat6::Zero();
  plain.stiffness.add_to(k, expected);
  EXPECT_LE((result.wrench.force - k * plain.wrench.force).norm(),
            1e-12 * k * plain.deepest * plain.weights);
  EXPECT_LE((result.wrench.torque - k * plain.wrench.torque).norm(),
            1e-12 * k * plain.deepest * plain.weights * 0.02);
  EXPECT_LE((stiffness - expected).norm(), 1e-12 * expected.norm());
  EXPECT_NEAR(result.stiffness_bound_n_per_m, k * plain.weights, 1e-12 * k * plain.weights);
  EXPECT_NEAR(result.deepest_depth_m, plain.deepest, 1e-15);
  EXPECT_LE((result.deepest_point - plain.deepest_point).norm(), 1e-15);
}

TEST_F(KernelTest, SumEqualsAPlainLoop) {
  constexpr double kStiffness = 3.0;
  std::mt19937_64 random(5);
  const voxmap::Voxmap voxmap = block({Vec3(-0.7, 0.31, 0.123), kEdge}, {0, 0, 0}, {60, 60, 30});
  // From one hit to a few blocks of them, full ones too.
  for (const std::size_t most : {1U, 7U, 8U, 63U, 64U, 65U, 500U}) {
    pointshell::Pointshell shell = sphere_shell(9.3 * kEdge, 0.7 * kEdge);
    std::vector<std::uint32_t> some;
    for (std::size_t n = 0; n < most && n < shell.size(); ++n)
      some.push_back(static_cast<std::uint32_t>(random() % shell.size()));
    std::sort(some.begin(), some.end());
    some.erase(std::unique(some.begin(), some.end()), some.end());
    shell = reordered(shell, some);
    for (double& area : shell.area_m2)
      area = uniform(random, 0.0, 1e-6);
    for (const auto weights : {contact::PointWeights::kArea, contact::PointWeights::kOne}) {
      const contact::ContactQuery query(voxmap, shell, weights);
      contact::HitList hits;
      hits.reserve(shell.size());
      for (int n = 0; n < 40; ++n) {
        query.find({voxmap.grid().origin + kEdge * Vec3(30.2, 29.7, uniform(random, 24.0, 40.0)),
                    random_rotation(random)},
                   hits);
        const Vec3 m = random_rotation(random) * Vec3::UnitX();
        for (const double fraction : {0.0, 0.3, 0.7}) {
          contact::ContactResult result;
          contact::StiffnessSum sum;
          contact::add_forces_along_directions(hits.surface, {m, fraction}, kStiffness,
                                               hits.pose_WT.position, result, sum);
          Mat6 stiffness = Mat6::Zero();
          sum.add_to(kStiffness, stiffness);
          ASSERT_NO_FATAL_FAILURE(
              expect_near(result, stiffness, plain_sums(hits, {m, fraction}), kStiffness));
        }
        contact::ContactResult result;
        contact::add_forces_along_mean(hits.surface, m, kStiffness, hits.pose_WT.position, result);
        ASSERT_NO_FATAL_FAILURE(
            expect_near(result, result.stiffness, plain_sums(hits, {m, 1.0}), kStiffness));
        if (HasFailure())
          return;
      }
    }
  }
}

/// The same hits with single precision uncertain everywhere: doubles decide for all of them.
contact::Hits all_in_doubles(const contact::Hits& hits) {
  contact::Hits out = hits;
  contact::HitSource source = hits.source();
  source.rough.certain = -1.0F;
  out.keep(hits.size(), source);
  return out;
}

TEST_F(KernelTest, SkipNoPushingHit) {
  const std::uint64_t seed = testing::seed(20261125);
  SCOPED_TRACE(testing::seed_trace(seed));
  std::mt19937_64 random(seed);
  int pushed = 0, skipped = 0;
  for (const Vec3& origin : {Vec3(-0.7, 0.31, 0.123), Vec3(1e6, -1e6, 1e6)}) {
    const voxmap::Voxmap voxmap = block({origin, kEdge}, {0, 0, 0}, {60, 60, 30});
    for (const double lone : {0.0, 1.5}) {  // of no unit length: such normals are not packed
      pointshell::Pointshell shell = sphere_shell(19.3 * kEdge, 0.4 * kEdge);
      for (double& area : shell.area_m2)
        area = uniform(random, 0.0, 1e-6);
      if (lone > 0.0)
        shell.nx.front() = lone;
      const contact::ContactQuery query(voxmap, shell, contact::PointWeights::kArea);
      contact::HitList hits;
      hits.reserve(shell.size());
      for (int n = 0; n < 100; ++n) {
        query.find({origin + kEdge * Vec3(30.2, 29.7, uniform(random, 40.0, 51.0)),
                    random_rotation(random)},
                   hits);
        const contact::Hits all = all_in_doubles(hits.surface);
        const Vec3 m = random_rotation(random) * Vec3::UnitX();
        for (const contact::Instructions kind : kinds())
          for (const double fraction : {0.0, 0.4, 1.0}) {
            contact::use_instructions(kind);
            contact::StageResult some, every;
            contact::StiffnessSum of_some, of_every;
            const auto sum = [&](const contact::Hits& list, contact::StageResult& result,
                                 contact::StiffnessSum& stiffness) {
              if (fraction == 1.0)
                contact::add_forces_along_mean(list, m, 3.0, hits.pose_WT.position, result.contact);
              else
                contact::add_forces_along_directions(
                    list, {m, fraction}, 3.0, hits.pose_WT.position, result.contact, stiffness);
            };
            sum(hits.surface, some, of_some), sum(all, every, of_every);
            ASSERT_TRUE(same(some, every))
                << n << ", share " << fraction << ", kind " << static_cast<int>(kind);
            ASSERT_EQ(of_some.entries(), of_every.entries());
          }
        for (const contact::Hit& hit : all) {
          const bool pushes = hit.normal.dot(hit.to_centre) > 0.0;
          pushed += pushes, skipped += !pushes;
        }
      }
    }
  }
  EXPECT_GT(pushed, 10'000);
  EXPECT_GT(skipped, 10'000);
}

TEST_F(KernelTest, ReturnsTheFirstOfEquallyDeepPoints) {
  const voxmap::Voxmap voxmap = block({Vec3::Zero(), 0.125}, {0, 0, 0}, {15, 15, 7});
  std::vector<std::pair<Vec3, Vec3>> points;
  for (int n = 0; n < 100; ++n)
    points.emplace_back(Vec3(0.125 / 128 * n, 0, n < 21 ? 0.015625 : 0.0), Vec3::UnitZ());
  const pointshell::Pointshell shell = shell_of(points, 0.125);
  for (const contact::Instructions kind : kinds())
    for (const auto model :
         {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted}) {
      contact::use_instructions(kind);
      contact::ContactRenderer renderer(voxmap, shell, model, {1.0});
      const Vec3 at(1.0, 1.0, 7 * 0.125 + 0.03125);
      EXPECT_EQ(renderer.probe({at, Quat::Identity()}).deepest_point, at + points[21].first);
    }
}

}  // namespace kernel_test
}  // namespace voxtouch::test
