/// End to end without rendering code: the reference evaluates reports of closed-form geometry on
/// the mesh files. Correct ones raise no alarm, also over edges and corners; each planted fault is
/// detected.
#include <gtest/gtest.h>

#include <random>

#include "core/reference/reference_scene.hpp"
#include "tests/support/decided_ratio.hpp"
#include "tests/unit/reference/test_scenes.hpp"
#include "tests/validator/synthetic_contact.hpp"

namespace voxtouch::made_up_contact {
namespace {

using namespace test_scenes;
using synthetic::Fault;
using synthetic::Rendering;
using test_scenes::mesh, test_scenes::scene;  // before the namespaces of these names

/// A path towards the static object, along it while pressed, and back. `up` points out of it.
std::vector<Vec3> press_and_slide(const Vec3& touch, const Vec3& up, const Vec3& along,
                                  double deepest_in_edges) {
  std::vector<Vec3> path;
  const auto add = [&](double gap_in_edges, double slid_in_edges) {
    path.push_back(touch + kEdge * (gap_in_edges * up + slid_in_edges * along));
  };
  for (double g = 5; g > -deepest_in_edges; g -= 0.0631)
    add(g, 0.1 * (5 - g));
  for (double s = 0; s < 4; s += 0.0713)
    add(-0.6 - 0.05 * std::sin(s), s);
  for (double g = -0.6; g < 5; g += 0.0631)
    add(g, 4);
  return path;
}

struct Ground {
  reference::ReferenceScene reference;
  Rendering rendering;
  std::vector<Vec3> path;
  Vec3 up;

  reference::ValidatorSettings settings() const {
    return {kEdge, reference.chord_error_m(), rendering.shell_gap(), 0.0};
  }
};

Ground tilted_plane() {
  const scene::Scene world = scene(mesh("slab_tilted.obj"));
  reference::ReferenceScene reference(world);
  const Vec3 low(-0.9384765625, -1.0849609375, -0.0673828125),
      x(1.035888671875, -0.932373046875, -0.3466796875);
  const Vec3 y(-0.95654296875, 0.720703125, 0.792724609375);
  const Vec3 up = (x - low).cross(y - low).normalized();
  const Vec3 touch = 0.5 * (x + y) + (kSphereRadius + up.dot(low - 0.5 * (x + y))) * up;
  Rendering rendering(synthetic::half_space(up, up.dot(low)), kEdge, Vec3(-1.4, -1.4, -1.1),
                      kSphereRadius);
  return {std::move(reference), std::move(rendering),
          press_and_slide(touch, up, up.unitOrthogonal(), 4.0), up};
}

Ground cylinder() {
  scene::MeshSpec spec = mesh("cylinder.obj");
  spec.primitives = {cylinder_primitive()};
  reference::ReferenceScene reference(scene(spec));
  const Vec3 up = Vec3(0.6, 0.0, 0.8);
  const Vec3 touch = kCylinderCentre + (0.5 + kSphereRadius) * up;
  Rendering rendering(synthetic::cylinder_along_y(kCylinderCentre.x(), kCylinderCentre.z(), 0.5),
                      kEdge, Vec3(-0.72, -1.01, -0.87), kSphereRadius);
  return {std::move(reference), std::move(rendering),
          press_and_slide(touch, up, Vec3(-0.4, 0.86, 0.3).normalized(), 4.0), up};
}

/// Evaluates the whole path; `tamper` may change a report, given its place in the path.
template <class Tamper>
reference::ContactValidator judged(const Ground& ground, const Fault& fault, Tamper tamper,
                                   std::string* first_sentence = nullptr) {
  reference::ContactValidator validator(ground.settings());
  for (std::size_t i = 0; i < ground.path.size(); ++i) {
    reference::ReportedContact report = ground.rendering.at(ground.path[i], fault);
    tamper(i, report);
    report.pose_WT = at(ground.path[i]);
    const reference::GapResult gap = ground.reference.gap(report.pose_WT);
    const reference::Validation found = validator.validate(gap, report);
    if (found.verdict == reference::Verdict::kDisagree && first_sentence != nullptr &&
        first_sentence->empty())
      *first_sentence =
          found.explanation + " at a gap of " + std::to_string(gap.gap_m / kEdge) + " e";
  }
  return validator;
}

reference::ContactValidator judged(const Ground& ground, const Fault& fault = {},
                                   std::string* first_sentence = nullptr) {
  return judged(
      ground, fault, [](std::size_t, reference::ReportedContact&) {}, first_sentence);
}

void expect_caught(const reference::ContactValidator& validator, const std::string& what) {
  EXPECT_GT(validator.counts().disagree, 0U) << what;
  EXPECT_EQ(validator.counts().reference, 0U) << what << ": the fault is the rendering's";
}

class PlantedFaults : public testing::TestWithParam<Ground (*)()> {};
INSTANTIATE_TEST_SUITE_P(Surfaces, PlantedFaults, testing::Values(&tilted_plane, &cylinder));

TEST_P(PlantedFaults, AbsentRaiseNoAlarmAndAFifthIsDecided) {
  std::string sentence;
  const reference::ContactValidator validator = judged(GetParam()(), {}, &sentence);
  EXPECT_EQ(validator.counts().disagree, 0U) << sentence;
  EXPECT_GT(test::decided_ratio(validator.counts()), test::kMinDecidedRatio);
  EXPECT_EQ(validator.counts().checked, validator.counts().agree + validator.counts().in_band);
}

TEST_P(PlantedFaults, ShiftedGridIsDetected) {
  const Ground ground = GetParam()();
  expect_caught(judged(ground, {2 * kEdge * ground.up, false}), "closer");
  expect_caught(judged(ground, {-2 * kEdge * ground.up, false}), "away");
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-2.0, 2.0}) {
      const Vec3 shift = sign * kEdge * Vec3::Unit(axis);
      if (std::abs(shift.dot(ground.up)) > 1.5 * kEdge)
        expect_caught(judged(ground, {shift, false}), "axis " + std::to_string(axis));
    }
}

TEST_P(PlantedFaults, FlippedNormalsAreDetected) {
  expect_caught(judged(GetParam()(), {Vec3::Zero(), true}), "flipped");
}

TEST_P(PlantedFaults, WrongForceSignIsDetected) {
  expect_caught(judged(GetParam()(), {},
                       [](std::size_t, reference::ReportedContact& r) { r.wrench.force *= -1.0; }),
                "pull");
}

TEST_P(PlantedFaults, FrozenForceIsDetected) {
  const Ground ground = GetParam()();
  for (const double stuck_at_gap : {0.5, -0.2, -1.0}) {
    const auto stuck = static_cast<std::size_t>((5 - stuck_at_gap) / 0.0631);
    const reference::ReportedContact frozen = ground.rendering.at(ground.path[stuck]);
    ASSERT_FALSE(frozen.wrench.zero());
    // The whole message is frozen until the hand is back in free space.
    expect_caught(judged(ground, {},
                         [&](std::size_t i, reference::ReportedContact& r) {
                           if (i >= stuck)
                             r = frozen;
                         }),
                  "to the end");
    // Only the force is frozen, and only while the tool moves in by one edge: the rule for free
    // space never applies.
    expect_caught(judged(ground, {},
                         [&](std::size_t i, reference::ReportedContact& r) {
                           if (i >= stuck && i < stuck + 16)
                             r.wrench = frozen.wrench;
                         }),
                  "in contact");
  }
}

TEST_P(PlantedFaults, MissingContactAndForceAreDetected) {
  const Ground ground = GetParam()();
  expect_caught(judged(ground, {}, [](std::size_t, reference::ReportedContact& r) { r = {}; }),
                "never a hit");
  expect_caught(
      judged(ground, {}, [](std::size_t, reference::ReportedContact& r) { r.wrench = {}; }),
      "never a force");
}

TEST(FaultlessReports, RaiseNoAlarmOverFacesEdgesAndCornersOfABox) {
  scene::MeshSpec spec = mesh("aligned_box.obj");
  std::mt19937 random(20240607);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const bool declared : {true, false}) {
    spec.primitives =
        declared ? std::vector<scene::Primitive>{box_primitive()} : std::vector<scene::Primitive>{};
    const reference::ReferenceScene reference(scene(spec));
    const Rendering rendering(synthetic::box(Vec3(-0.375, -0.25, -0.25), Vec3(0.375, 0.25, 0.25)),
                              kEdge, Vec3(-0.611, -0.523, -0.507), kSphereRadius);
    reference::ContactValidator validator(
        {kEdge, reference.chord_error_m(), rendering.shell_gap(), 0.0});
    for (int i = 0; i < 1500; ++i) {
      const Vec3 surface = Vec3(0.375, 0.25, 0.25)
                               .cwiseProduct(Vec3(unit(random), unit(random), unit(random)) * 1.5);
      const Vec3 out = Vec3(unit(random), unit(random), unit(random)).normalized();
      const Vec3 centre = surface + (kSphereRadius + kEdge * 2 * unit(random)) * out;
      const reference::Validation found =
          validator.validate(reference.gap(at(centre)), rendering.at(centre));
      EXPECT_NE(found.verdict, reference::Verdict::kDisagree)
          << found.explanation << " at " << centre.transpose();
    }
  }
}

}  // namespace
}  // namespace voxtouch::made_up_contact
