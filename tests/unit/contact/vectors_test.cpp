// The two laws against the exact reference vectors: each pose file, each pose, forces, torques,
// counts and colliding sets.
#include <gtest/gtest.h>

#include <cstdio>
#include <numeric>

#include "fixtures.hpp"

namespace voxtouch::test {
namespace {

struct Case {
  std::string dynamic, fixed, shell;
  std::string file() const { return dynamic + "__" + fixed + "__" + shell + ".csv"; }
};

constexpr double kTolerance = 1e-7;  // FORMAT.md, double code

class Vectors : public ::testing::TestWithParam<Case> {};

double worst(const Wrench& a, const Wrench& b) {
  return std::max((a.force - b.force).cwiseAbs().maxCoeff(),
                  (a.torque - b.torque).cwiseAbs().maxCoeff());
}

std::string five_digits(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.5f", value);
  return text.data();
}

TEST_P(Vectors, GiveTheSameForcesTorquesCountsAndSets) {
  const VectorMesh dynamic = load_vector_mesh(GetParam().dynamic),
                   fixed = load_vector_mesh(GetParam().fixed);
  const pointshell::Pointshell& shell = GetParam().shell == "exact" ? dynamic.exact : dynamic.naive;
  contact::ContactRenderer original(fixed.voxmap, shell, contact::ContactModelKind::kOriginal,
                                    {1.0});
  contact::ContactRenderer adapted(fixed.voxmap, shell, contact::ContactModelKind::kAdapted, {1.0});
  double largest = 0.0;
  std::size_t row = 1;
  std::uint32_t fallbacks = 0;
  std::vector<std::uint32_t> ids;
  const auto poses = load_vector_poses(GetParam().file());
  ASSERT_FALSE(poses.empty());
  for (const VectorPose& p : poses) {
    SCOPED_TRACE(GetParam().file() + " row " + std::to_string(++row));
    const contact::ContactResult o = original.probe(p.pose);
    const contact::ContactResult a = adapted.probe(p.pose, ids);
    EXPECT_EQ(a.surface_hits, p.surface);
    EXPECT_EQ(a.interior_hits, p.interior);
    EXPECT_EQ(five_digits(a.coherence), p.coherence);
    EXPECT_EQ(ids, p.ids);
    EXPECT_EQ(a.fallback, p.surface > 0 && a.coherence <= 0.3);
    EXPECT_FALSE(o.fallback);
    EXPECT_LE(worst(o.wrench, p.original), kTolerance);
    EXPECT_LE(worst(a.wrench, p.adapted), kTolerance);
    largest = std::max({largest, worst(o.wrench, p.original), worst(a.wrench, p.adapted)});
    fallbacks += a.fallback;
  }
  std::printf("%s: %zu poses, largest difference %.1e, fallbacks %u\n", GetParam().file().c_str(),
              poses.size(), largest, fallbacks);
}

TEST_P(Vectors, GiveTheSameHitsAndForcesWhenTheShellIsPermuted) {
  const VectorMesh dynamic = load_vector_mesh(GetParam().dynamic),
                   fixed = load_vector_mesh(GetParam().fixed);
  const pointshell::Pointshell& shell = GetParam().shell == "exact" ? dynamic.exact : dynamic.naive;
  std::vector<std::uint32_t> order(shell.size());
  std::iota(order.begin(), order.end(), 0U);
  std::mt19937_64 random(7);
  for (std::size_t n = order.size(); n > 1; --n)
    std::swap(order[n - 1], order[random() % n]);
  for (const auto model :
       {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted}) {
    contact::ContactRenderer one(fixed.voxmap, shell, model, {1.0});
    contact::ContactRenderer other(fixed.voxmap, reordered(shell, order), model, {1.0});
    std::vector<std::uint32_t> ids, other_ids;
    for (const VectorPose& p : load_vector_poses(GetParam().file())) {
      const contact::ContactResult a = one.probe(p.pose, ids), b = other.probe(p.pose, other_ids);
      EXPECT_EQ(ids, other_ids);
      EXPECT_LE(worst(a.wrench, b.wrench), 1e-12);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(PoseFiles, Vectors,
                         ::testing::Values(Case{"aligned_box", "aligned_box", "exact"},
                                           Case{"degenerate_tris", "lshape", "exact"},
                                           Case{"sphere", "cylinder", "exact"},
                                           Case{"sphere", "slab_tilted", "exact"},
                                           Case{"sphere", "slab_tilted", "naive"}),
                         [](const auto& test) {
                           return test.param.dynamic + "_on_" + test.param.fixed + "_" +
                                  test.param.shell;
                         });

}  // namespace
}  // namespace voxtouch::test
