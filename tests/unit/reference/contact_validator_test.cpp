/// Each rule of the ContactValidator, on both sides of its limit.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/reference/contact_validator.hpp"

namespace voxtouch::reference {
namespace {

constexpr double kE = 0.002;
const ValidatorSettings kSettings{kE, 0.1 * kE, 1.2 * kE, 0.0};
constexpr double kFree = (1.7320508075688772 + 0.1) * kE;
constexpr double kMust = (0.8660254037844386 + 1.2 + 0.1) * kE;

/// A sphere of ten edges over a level plane.
GapResult gap_of(double gap_m) {
  GapResult gap;
  gap.gap_m = gap_m;
  gap.inside_depth_m = std::max(0.0, -gap_m);
  gap.direction = Vec3::UnitZ();
  gap.sphere_radius_m = 10 * kE;
  gap.unique_face = gap.depth_exact = gap.self_check = true;
  gap.method = GapMethod::kClosedForm;
  gap.self_error_m = 0;
  return gap;
}

Vec3 tilted(double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  return {std::sin(angle), 0, std::cos(angle)};
}

/// A contact as it should be at that depth; `seed` makes its bits its own.
ReportedContact contact(double depth_m, double seed = 0.0, double degrees_off = 0.0) {
  ReportedContact report;
  report.surface_hits = 20;
  report.coherence = 0.95;
  report.deepest_depth_m = depth_m;
  report.mean_normal = tilted(degrees_off);
  report.wrench.force = (1.0 + seed) * tilted(degrees_off);
  return report;
}

Validation once(const GapResult& gap, const ReportedContact& report) {
  return ContactValidator(kSettings).validate(gap, report);
}
Verdict verdict(const GapResult& gap, const ReportedContact& report) {
  return once(gap, report).verdict;
}

TEST(ContactValidator, ReportsNoCollisionBeyondTheVoxelDiagonal) {
  const Validation free = once(gap_of(kFree + 1e-9), {});
  EXPECT_EQ(free.verdict, Verdict::kAgree);
  EXPECT_TRUE(free.decided);
  EXPECT_TRUE(free.explanation.empty());
  ReportedContact one_hit;
  one_hit.surface_hits = 1;
  const Validation hit = once(gap_of(kFree + 1e-9), one_hit);
  EXPECT_EQ(hit.verdict, Verdict::kDisagree);
  EXPECT_EQ(hit.cause, Cause::kRendering);
  EXPECT_TRUE(hit.decided);
  EXPECT_EQ(verdict(gap_of(kFree - 1e-9), one_hit), Verdict::kInBand);
}

TEST(ContactValidator, RequiresZeroForceInFreeSpace) {
  ReportedContact pushed;
  pushed.latched = true;
  pushed.wrench.torque.x() = 1e-12;
  EXPECT_EQ(once(gap_of(kFree + 1e-9), pushed).verdict, Verdict::kDisagree);
}

TEST(ContactValidator, DecidesThatADeepOverlapCollides) {
  GapResult bound = gap_of(-kMust - 1e-9);
  bound.depth_exact = false;  // as for meshes: how deep exactly is not known, and need not be
  const Validation missed = once(bound, {});
  EXPECT_EQ(missed.verdict, Verdict::kDisagree);
  EXPECT_TRUE(missed.decided);
  ReportedContact through;
  through.interior_hits = 5;
  EXPECT_EQ(verdict(gap_of(-kMust - 1e-9), through), Verdict::kAgree);
  EXPECT_FALSE(once(gap_of(-kMust + 1e-9), through).decided);
}

TEST(ContactValidator, RequiresNoHitOnAThinPlate) {
  GapResult thin = gap_of(-3 * kE);
  thin.inside_depth_m = 0;
  thin.depth_exact = false;
  EXPECT_EQ(verdict(thin, {}), Verdict::kInBand);
}

TEST(ContactValidator, RequiresAHitOnceAWholeCapIsInside) {
  GapResult shallow = gap_of(-0.8 * kE);
  shallow.cap_inside_depth_m = 0.36 * kE;
  EXPECT_EQ(verdict(shallow, {}), Verdict::kDisagree);
  shallow.cap_inside_depth_m = 0.34 * kE;
  EXPECT_EQ(verdict(shallow, {}), Verdict::kInBand);
  ValidatorSettings coarse = kSettings;
  coarse.shell_gap_m = 1.8 * kE;
  shallow.cap_inside_depth_m = 0.7 * kE;
  EXPECT_EQ(ContactValidator(coarse).validate(shallow, {}).verdict, Verdict::kInBand)
      << "a coarse shell may miss the cap";
}

TEST(ContactValidator, AllowsInteriorHitsOnlyInside) {
  ReportedContact through = contact(0.2 * kE);
  through.interior_hits = 1;
  EXPECT_EQ(verdict(gap_of(0.05 * kE), through), Verdict::kInBand);
  EXPECT_EQ(verdict(gap_of(0.15 * kE), through), Verdict::kDisagree);
  GapResult open = gap_of(0.15 * kE);
  open.inside_known = false;
  EXPECT_EQ(verdict(open, through), Verdict::kInBand);
}

TEST(ContactValidator, RequiresForceAndHitsTogether) {
  ReportedContact ghost;
  ghost.wrench.force.z() = 0.1;
  EXPECT_EQ(verdict(gap_of(0), ghost), Verdict::kDisagree);
  ReportedContact limp = contact(0.3 * kE);
  limp.wrench = {};
  EXPECT_EQ(verdict(gap_of(-0.3 * kE), limp), Verdict::kDisagree);
  limp.deepest_depth_m = 0.2 * kE;
  EXPECT_EQ(verdict(gap_of(-0.3 * kE), limp), Verdict::kInBand);
}

TEST(ContactValidator, ComparesDepthOnlyUntilPointsPassThrough) {
  EXPECT_EQ(verdict(gap_of(-1.5 * kE), contact(0.45 * kE)), Verdict::kInBand);
  const Validation shallow = once(gap_of(-1.5 * kE), contact(0.35 * kE));
  EXPECT_EQ(shallow.verdict, Verdict::kDisagree);
  EXPECT_NEAR(shallow.depth_error_m, -1.15 * kE, 1e-12);
  ReportedContact through = contact(0.35 * kE);
  through.interior_hits = 3;
  const Validation saturated = once(gap_of(-1.5 * kE), through);
  EXPECT_EQ(saturated.verdict, Verdict::kInBand);
  EXPECT_TRUE(std::isnan(saturated.depth_error_m));
}

TEST(ContactValidator, ComparesDepthFromAboveAlways) {
  EXPECT_EQ(verdict(gap_of(-0.5 * kE), contact(1.55 * kE)), Verdict::kInBand);
  EXPECT_EQ(verdict(gap_of(-0.5 * kE), contact(1.65 * kE)), Verdict::kDisagree);
  ReportedContact through = contact(1.65 * kE);
  through.interior_hits = 3;
  EXPECT_EQ(verdict(gap_of(-0.5 * kE), through), Verdict::kDisagree);
  through.latched = true;
  EXPECT_EQ(verdict(gap_of(-0.5 * kE), through), Verdict::kInBand)
      << "an old depth is not compared";
}

TEST(ContactValidator, ComparesMeaningfulDirectionsTo20Degrees) {
  EXPECT_EQ(verdict(gap_of(-0.5 * kE), contact(0.5 * kE, 0, 19)), Verdict::kInBand);
  const Validation off = once(gap_of(-0.5 * kE), contact(0.5 * kE, 0, 21));
  EXPECT_EQ(off.verdict, Verdict::kDisagree);
  EXPECT_NEAR(off.direction_error_rad, 21 * std::numbers::pi / 180, 1e-12);
  GapResult edge = gap_of(-0.5 * kE);
  edge.unique_face = false;
  EXPECT_EQ(verdict(edge, contact(0.5 * kE, 0, 60)), Verdict::kInBand);
  ReportedContact fallback = contact(0.5 * kE, 0, 60);
  fallback.fallback = true;
  EXPECT_EQ(verdict(gap_of(-0.5 * kE), fallback), Verdict::kInBand);
}

TEST(ContactValidator, DetectsAWrongForceOrNormalAlone) {
  ReportedContact force = contact(0.5 * kE);
  force.wrench.force = tilted(25);
  EXPECT_EQ(verdict(gap_of(-0.5 * kE), force), Verdict::kDisagree);
  ReportedContact normal = contact(0.2 * kE);
  normal.wrench = {}, normal.mean_normal = tilted(25);
  EXPECT_EQ(verdict(gap_of(-0.5 * kE), normal), Verdict::kDisagree);
}

TEST(ContactValidator, ChecksOnlyTheSignOfUncertainFrames) {
  EXPECT_EQ(verdict(gap_of(0.3 * kE), contact(0.1 * kE, 0, 40)), Verdict::kInBand);
  EXPECT_EQ(verdict(gap_of(0.3 * kE), contact(0.1 * kE, 0, 100)), Verdict::kDisagree);
  ReportedContact latched = contact(0.5 * kE, 0, 60);
  latched.latched = true, latched.interior_hits = 9;
  EXPECT_EQ(verdict(gap_of(-kE), latched), Verdict::kInBand);
  latched.interior_hits = 0;
  EXPECT_EQ(verdict(gap_of(-kE), latched), Verdict::kInBand);
  latched.wrench.force *= -1;
  EXPECT_EQ(verdict(gap_of(-kE), latched), Verdict::kDisagree);
}

TEST(ContactValidator, DetectsAFrozenForceByTheMovingGap) {
  ContactValidator validator(kSettings);
  const ReportedContact frozen = contact(0.5 * kE);
  EXPECT_EQ(validator.validate(gap_of(-0.3 * kE), frozen).verdict, Verdict::kInBand);
  EXPECT_EQ(validator.validate(gap_of(-0.6 * kE), frozen).verdict, Verdict::kInBand)
      << "two samples are not enough";
  EXPECT_EQ(validator.validate(gap_of(-0.6 * kE), frozen).verdict, Verdict::kDisagree);
  EXPECT_EQ(validator.validate(gap_of(-0.6 * kE), contact(0.5 * kE, 1e-15)).verdict,
            Verdict::kInBand)
      << "other bits";
}

TEST(ContactValidator, AcceptsAConstantForceAtAConstantGap) {
  ContactValidator validator(kSettings);
  for (int i = 0; i < 100; ++i)
    EXPECT_EQ(
        validator.validate(gap_of(-0.5 * kE + 0.001 * kE * (i % 7)), contact(0.5 * kE)).verdict,
        Verdict::kInBand);
}

TEST(ContactValidator, AcceptsAFlaggedLatchedForceInContact) {
  ContactValidator validator(kSettings);
  ReportedContact latched = contact(0.5 * kE);
  latched.latched = true, latched.interior_hits = 4;
  for (int i = 0; i < 20; ++i)
    EXPECT_NE(validator.validate(gap_of(-0.1 * kE * i), latched).verdict, Verdict::kDisagree);
}

TEST(ContactValidator, BlamesItselfIfItsCrossCheckFails) {
  GapResult doubtful = gap_of(kFree + kE);
  doubtful.self_check = false;
  doubtful.self_error_m = 0.5 * kE;
  ContactValidator validator(kSettings);
  const Validation fault = validator.validate(doubtful, contact(0.5 * kE));
  EXPECT_EQ(fault.verdict, Verdict::kDisagree);
  EXPECT_EQ(fault.cause, Cause::kReference);
  EXPECT_FALSE(fault.decided);
  const Validation quiet = validator.validate(doubtful, {});
  EXPECT_EQ(quiet.verdict, Verdict::kInBand);
  EXPECT_FALSE(quiet.explanation.empty());
  EXPECT_EQ(validator.counts().reference, 1U);
  EXPECT_EQ(validator.counts().rendering, 0U);
}

TEST(ContactValidator, AcceptsNoNonFiniteValue) {
  ReportedContact report = contact(0.5 * kE);
  report.wrench.torque.y() = NAN;
  EXPECT_EQ(verdict(gap_of(-0.5 * kE), report), Verdict::kDisagree);
  const Validation nothing = once(GapResult{}, {});
  EXPECT_EQ(nothing.verdict, Verdict::kInBand);
  EXPECT_EQ(nothing.cause, Cause::kReference);
}

TEST(ContactValidator, CountsItsVerdicts) {
  ContactValidator validator(kSettings);
  validator.validate(gap_of(2 * kFree), {});
  validator.validate(gap_of(2 * kFree), contact(0.5 * kE));
  validator.validate(gap_of(-0.5 * kE), contact(0.5 * kE));
  validator.validate(gap_of(-0.5 * kE), contact(0.5 * kE, 0.1, 50));
  const ValidationCounts& counts = validator.counts();
  EXPECT_EQ(counts.checked, 4U);
  EXPECT_EQ(counts.decided, 2U);
  EXPECT_EQ(counts.agree, 1U);
  EXPECT_EQ(counts.in_band, 1U);
  EXPECT_EQ(counts.disagree, 2U);
  EXPECT_EQ(counts.rendering, 2U);
}

TEST(ContactValidator, WidensItsLimitsForShellsOffTheSurface) {
  ValidatorSettings naive = kSettings;
  naive.shell_offset_m = 0.866 * kE;
  ReportedContact hit;
  hit.surface_hits = 1;
  EXPECT_EQ(ContactValidator(naive).validate(gap_of(kFree + 0.8 * kE), hit).verdict,
            Verdict::kInBand);
  EXPECT_EQ(ContactValidator(naive).validate(gap_of(-kMust - 0.8 * kE), {}).decided, false);
  // Voxel centres with individual normals give oblique forces if few are below the surface.
  EXPECT_EQ(ContactValidator(naive).validate(gap_of(-1.1 * kE), contact(1.1 * kE, 0, 30)).verdict,
            Verdict::kInBand);
  EXPECT_EQ(ContactValidator(naive).validate(gap_of(-1.12 * kE), contact(1.12 * kE, 0, 30)).verdict,
            Verdict::kDisagree);
}

TEST(ContactValidator, RefusesInvalidSettings) {
  for (const ValidatorSettings& bad :
       {ValidatorSettings{}, ValidatorSettings{kE, -1, 0, 0}, ValidatorSettings{kE, 0, NAN, 0},
        ValidatorSettings{kE, 0, 0, INFINITY}})
    EXPECT_THROW(ContactValidator{bad}, std::invalid_argument);
}

TEST(ContactValidator, ChecksEveryNthSampleBySequence) {
  EXPECT_TRUE(is_checked(0, 50));
  EXPECT_TRUE(is_checked(150, 50));
  EXPECT_FALSE(is_checked(151, 50));
  EXPECT_FALSE(is_checked(0, 0));
}

/// The sphere of gap_of on a handle of 40 edges along x, pressed down on the plane by e/2.
GapResult on_handle() {
  GapResult gap = gap_of(-0.5 * kE);
  gap.nearest_dynamic = Vec3(40 * kE, 0, -10 * kE);
  return gap;
}

TEST(ContactValidator, HoldsTheForcesLineOfActionToTheToolsSphere) {
  ReportedContact report = contact(0.5 * kE);
  const Vec3 force = report.wrench.force;
  const double radius = (10 + 0.1) * kE;
  const auto torque_for = [&](double off) { return Vec3(40 * kE + off, 0, 0).cross(force); };
  for (const double off : {0.0, 0.99 * radius, -0.99 * radius}) {
    report.wrench.torque = torque_for(off);
    EXPECT_EQ(verdict(on_handle(), report), Verdict::kInBand) << off;
  }
  for (const double off : {1.01 * radius, -1.01 * radius}) {
    report.wrench.torque = torque_for(off);
    EXPECT_EQ(verdict(on_handle(), report), Verdict::kDisagree) << off;
  }
  report.wrench.torque = -torque_for(0.0);
  const Validation wrong = once(on_handle(), report);
  EXPECT_EQ(wrong.cause, Cause::kRendering);
  EXPECT_NE(wrong.explanation.find("160 mm"), std::string::npos) << wrong.explanation;
}

TEST(ContactValidator, SkipsTheTorqueOfDivergentForces) {
  ReportedContact wrong = contact(0.5 * kE);
  wrong.wrench.torque = -Vec3(40 * kE, 0, 0).cross(wrong.wrench.force);
  ASSERT_EQ(verdict(on_handle(), wrong), Verdict::kDisagree);
  const auto with = [&](auto change) {
    ReportedContact report = wrong;
    change(report);
    return verdict(on_handle(), report);
  };
  EXPECT_EQ(with([](ReportedContact& r) { r.latched = true; }), Verdict::kInBand);
  EXPECT_EQ(with([](ReportedContact& r) { r.fallback = true; }), Verdict::kInBand);
  EXPECT_EQ(with([](ReportedContact& r) { r.interior_hits = 1; }), Verdict::kInBand);
  EXPECT_EQ(with([](ReportedContact& r) { r.coherence = 0.49; }), Verdict::kInBand);
  GapResult mesh = on_handle();
  mesh.sphere_radius_m = 0;  // a dynamic mesh of any shape
  EXPECT_EQ(verdict(mesh, wrong), Verdict::kInBand);
}

}  // namespace
}  // namespace voxtouch::reference
