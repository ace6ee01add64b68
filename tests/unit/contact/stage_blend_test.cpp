// The blend between mean and own normals, on hits made by hand and on contacts from poses.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/contact/limits.hpp"
#include "core/types/smoothstep.hpp"
#include "fixtures.hpp"

namespace voxtouch::test {
namespace stage_blend_test {

constexpr double kEdge = 0.001;
const voxmap::Grid kGrid{Vec3::Zero(), kEdge};

struct Laws {
  std::unique_ptr<contact::ContactModel> original =
      contact::make_contact_model(contact::ContactModelKind::kOriginal, {1.0});
  std::unique_ptr<contact::ContactModel> adapted =
      contact::make_contact_model(contact::ContactModelKind::kAdapted, {1.0});
  contact::ContactStage stage{{64, 0.01, kEdge, 1.0, contact::ContactModelKind::kAdapted}};

  contact::ContactResult plain(const contact::HitList& hits,
                               const contact::ContactModel& model) const {
    contact::ContactResult result;
    model.evaluate(hits, result);
    return result;
  }
  contact::StageResult staged(const contact::HitList& hits) {
    return stage.apply(hits, plain(hits, *adapted));
  }
};

contact::HitList hits_of(const std::vector<Vec3>& normals) {
  std::vector<contact::Hit> made;
  for (std::uint32_t p = 0; p < normals.size(); ++p)
    made.push_back({.point = p,
                    .normal = normals[p].normalized(),
                    .to_centre = kEdge * Vec3(0.11 + 0.02 * p, -0.07, 0.31 - 0.01 * p)});
  contact::HitList hits;
  hits.surface = made_hits(made, kEdge);
  return hits;
}

/// Two normals that open by `angle` on either side of z: coherence = cos(angle).
contact::HitList wedge(double angle) {
  return hits_of(
      {Vec3(std::sin(angle), 0, std::cos(angle)), Vec3(-std::sin(angle), 0, std::cos(angle))});
}

TEST(Blend, EqualsAdaptedForAgreeingNormals) {
  Laws laws;
  for (const double angle : {0.0, 0.3, 1.0, 1.047}) {
    const contact::HitList hits = wedge(angle);
    EXPECT_TRUE(same_bits(laws.staged(hits).contact.wrench, laws.plain(hits, *laws.adapted).wrench))
        << angle;
  }
}

TEST(Blend, EqualsOriginalForOpposedNormals) {
  Laws laws;
  for (const double angle : {1.3695, 1.5, std::numbers::pi / 2}) {
    const contact::HitList hits = wedge(angle);
    EXPECT_TRUE(
        same_bits(laws.staged(hits).contact.wrench, laws.plain(hits, *laws.original).wrench))
        << angle;
  }
}

TEST(Blend, HasNoStepAtTheMemorylessSwitch) {
  Laws laws;
  const double step = 1e-4;
  Wrench last = laws.staged(wedge(0.8)).contact.wrench;
  Wrench last_plain = laws.plain(wedge(0.8), *laws.adapted).wrench;
  double worst = 0.0, worst_plain = 0.0;
  for (double angle = 0.8 + step; angle < 1.57; angle += step) {
    const Wrench now = laws.staged(wedge(angle)).contact.wrench;
    const Wrench plain = laws.plain(wedge(angle), *laws.adapted).wrench;
    worst = std::max(worst, (now.force - last.force).norm());
    worst_plain = std::max(worst_plain, (plain.force - last_plain.force).norm());
    last = now, last_plain = plain;
  }
  EXPECT_LE(worst, 20.0 * kEdge * step);  // Lipschitz in the angle
  EXPECT_GE(worst_plain, 0.1 * kEdge);    // the switch at 0.3 that it replaces
}

TEST(Blend, IsFiniteAndContinuousForCancellingNormals) {
  // Four hits that set the mean and one that rotates through its exact opposite, for coherences
  // around 0.35 (s = 1/2).
  Laws laws;
  const double step = 1e-4;
  const double half = std::acos(
      0.6875);  // (4 cos(open) - 1) / 5 = 0.35: here the blended direction vanishes at angle 0
  for (const double open : {0.7, half - 1e-2, half - 1e-3, half - 1e-6, half, half + 1e-6,
                            half + 1e-3, half + 1e-2, 0.9}) {
    Wrench last;
    for (int n = -500; n <= 500; ++n) {
      const double turn = n * step;
      const contact::StageResult r = laws.staged(hits_of(
          {Vec3(0, std::sin(open), std::cos(open)), Vec3(0, -std::sin(open), std::cos(open)),
           Vec3(0, std::sin(open), std::cos(open)), Vec3(0, -std::sin(open), std::cos(open)),
           Vec3(std::sin(turn), 0, -std::cos(turn))}));
      ASSERT_TRUE(r.contact.wrench.finite());
      if (n > -500) {
        EXPECT_LE((r.contact.wrench.force - last.force).norm(), 10.0 * kEdge * step)
            << open << " " << turn;
      }
      last = r.contact.wrench;
      if (n == 0 && open == half) {
        EXPECT_NEAR(
            smoothstep(contact::limits::kBlendFrom, contact::limits::kBlendTo, r.contact.coherence),
            0.5, 1e-9);
      }
    }
  }
}

TEST(Blend, NeverTouchesTheModelOriginal) {
  contact::ContactStage stage({64, 0.01, kEdge, 1.0, contact::ContactModelKind::kOriginal});
  Laws laws;
  for (const double angle : {0.0, 1.2, 1.5}) {
    const contact::HitList hits = wedge(angle);
    const contact::ContactResult plain = laws.plain(hits, *laws.original);
    EXPECT_TRUE(same_bits(stage.apply(hits, plain).contact.wrench, plain.wrench));
  }
}

TEST(Blend, IsBitIdenticalInPlainContact) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {60, 60, 30});
  const pointshell::Pointshell shell = sphere_shell(10 * kEdge, kEdge);
  std::mt19937_64 random(21);
  for (const auto kind :
       {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted}) {
    contact::ContactRenderer renderer(voxmap, shell, kind, {100.0});
    int contacts = 0;
    for (int n = 0; n < 300; ++n) {
      const Pose pose{kEdge * Vec3(uniform(random, 20, 40), uniform(random, 20, 40),
                                   uniform(random, 40.0, 41.3)),
                      random_rotation(random)};
      const contact::ContactResult plain = renderer.probe(pose);
      if (plain.interior_hits > 0)
        continue;
      const contact::StageResult r = renderer.render(pose);
      contacts += plain.surface_hits > 0;
      EXPECT_TRUE(same_bits(r.contact.wrench, plain.wrench));
      EXPECT_FALSE(r.latched);
    }
    EXPECT_GT(contacts, 100);
  }
}

TEST(Blend, KeepsTheStiffnessBoundBetweenItsEnds) {
  Laws laws;
  const contact::HitList hits = wedge(1.2);  // coherence 0.36
  const contact::StageResult r = laws.staged(hits);
  EXPECT_GT(r.contact.stiffness_bound_n_per_m, 0.0);
  EXPECT_LE(r.contact.stiffness_bound_n_per_m, 2.0);
  const double step = 1e-9;
  Mat3 stiffness;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<contact::Hit> made;
    for (contact::Hit hit : hits.surface) {
      hit.to_centre[axis] -= step;
      made.push_back(hit);
    }
    contact::HitList moved;
    moved.surface = made_hits(made, kEdge);
    stiffness.col(axis) = (r.contact.wrench.force - laws.staged(moved).contact.wrench.force) / step;
  }
  EXPECT_LE(stiffness.jacobiSvd().singularValues()[0],
            r.contact.stiffness_bound_n_per_m * (1 + 1e-5));
}

}  // namespace stage_blend_test
}  // namespace voxtouch::test
