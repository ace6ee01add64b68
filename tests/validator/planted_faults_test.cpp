/// The rendering as shipped, evaluated by the reference on the shipped scenes: no disagreement
/// without a fault, with enough decided samples; each planted fault is detected.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <utility>

#include "core/rendering/contact_parameters.hpp"
#include "core/voxmap/grid_mesh.hpp"
#include "tests/support/decided_ratio.hpp"
#include "tests/validator/shipped_scenes.hpp"
#include "tests/validator/walks.hpp"

namespace voxtouch::test {
namespace {

/// For tests of torque the sphere is on a handle along this direction: oblique to all faces of the
/// scenes.
const Vec3 kHandle(0.6, -0.5, 0.6245);

/// A shipped scene unchanged or with its sphere on a handle, and its walks. The reference's gaps
/// take the longest and depend on neither model nor shell: they are computed once for all cases of
/// this process.
struct Prepared {
  explicit Prepared(const scene::Scene& scene, const Vec3& tool_to_sphere)
      : ground(scene, tool_to_sphere),
        walks(ground.walks()) {
    for (const Walk& walk : walks)
      if (walk.name == "hit" || walk.name == "slide" || walk.name == "circle")
        own_motions.push_back(walk);
  }
  Ground ground;
  std::vector<Walk> walks;
  std::vector<Walk> own_motions;  ///< the planted faults are evaluated on the scene's motions only
};

Vec3 handle_of(const scene::Scene& scene) { return 15.0 * scene.voxel_size_m * kHandle; }

Prepared& prepared(const std::string& name, bool on_handle = false) {
  static std::map<std::pair<std::string, bool>, std::unique_ptr<Prepared>> all;
  std::unique_ptr<Prepared>& one = all[{name, on_handle}];
  if (!one) {
    const scene::Scene scene = shipped_scene(name);
    one = std::make_unique<Prepared>(scene, on_handle ? handle_of(scene) : Vec3(Vec3::Zero()));
    EXPECT_EQ(one->own_motions.size(), 3U) << "hit, slide and circle";
  }
  return *one;
}

class RealRendering : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(ShippedScenes, RealRendering, testing::ValuesIn(resting_scene_names()),
                         [](const auto& test) { return test.param; });

TEST_P(RealRendering, IsNeverRejectedAndAFifthIsDecided) {
  const Prepared& scene = prepared(GetParam());
  for (const Walk& walk : scene.walks) {
    const Outcome outcome = scene.ground.judged(walk);
    const reference::ValidationCounts& c = outcome.counts;
    EXPECT_EQ(c.disagree, 0U) << outcome.first;
    EXPECT_EQ(c.checked, walk.gaps.size());
    EXPECT_EQ(c.checked, c.agree + c.in_band);
    if (walk.name.find(',') == std::string::npos) {
      EXPECT_GE(test::decided_ratio(c), test::kMinDecidedRatio) << walk.name;
    }
    std::printf("%-12s %-18s %4zu checked, %4zu in contact, %3.0f %% decided, %zu disagree\n",
                GetParam().c_str(), walk.name.c_str(), walk.gaps.size(), walk.contacts(),
                100 * test::decided_ratio(c), static_cast<std::size_t>(c.disagree));
  }
}

/// Other choices of a scene file: the other model, with unit weights; the other shell; also with
/// the force on a lever.
TEST_P(RealRendering, OtherModelAndShellAreNeverRejected) {
  const bool weighs_points = shipped_scene(GetParam()).contact.stiffness_n_per_m > 0.0;
  for (const bool original : {false, true}) {
    if (original && !weighs_points)
      break;  // its model is fixed
    for (const scene::ShellKind shell : {scene::ShellKind::kExact, scene::ShellKind::kNaive})
      for (const bool on_handle : {false, true}) {
        scene::Scene scene = shipped_scene(GetParam());
        if (weighs_points)
          scene.contact.model = original ? "original" : "adapted";
        scene.shell = shell;
        const Ground ground(scene, on_handle ? handle_of(scene) : Vec3(Vec3::Zero()));
        const Outcome outcome = ground.judged(prepared(GetParam(), on_handle).walks, {});
        EXPECT_EQ(outcome.counts.disagree, 0U)
            << scene.contact.model
            << (shell == scene::ShellKind::kNaive ? ", naive: " : ", exact: ") << outcome.first;
      }
  }
}

void expect_caught(const std::string& scene, const std::string& fault, const Outcome& outcome) {
  std::printf("%-12s %-28s %4zu disagree: %s\n", scene.c_str(), fault.c_str(),
              static_cast<std::size_t>(outcome.counts.disagree), outcome.first.c_str());
  EXPECT_GT(outcome.counts.disagree, 0U) << fault;
  EXPECT_EQ(outcome.counts.reference, 0U) << fault << ": is the rendering's";
}

Fault tampered(const std::string& name, std::function<void(reference::ReportedContact&)> change) {
  return {.name = name, .tamper = [change] {
            return [change](std::size_t, reference::ReportedContact& report) { change(report); };
          }};
}

/// Axes along which a shift of the grid cannot be detected, and why. A shift counts by its
/// component along the normals of the touched faces. Below 1.5 e it may be within the rules'
/// tolerances (contact_validator.hpp); at 0 it has no effect.
const std::map<std::string, std::string> kBlindAxes = {
    {"cup", "z"},  // the motions touch the walls, which are the same all along z
    {"cup_field", "z"},
    {"cup_guide_line", "z"},
    {"cup_guide_plane", "z"},
    {"cup_guide_point", "z"},
    {"cup_magnet", "z"},
    {"cup_mm", "z"},
    {"cup_metre", "z"},
    {"cup_proximity", "z"},
    {"cylinder", "y"},       // its axis; the motions stay away from its ends
    {"plane", "xy"},         // it lies in x and y; the motions stay away from its borders
    {"tilted_plane", "xy"},  // its normal is (0.40, -0.34, 0.85): 0.8 e and 0.7 e of 2 e; some are
                             // caught all the same
};

TEST_P(RealRendering, ShiftedGridIsDetectedOnEveryVisibleAxis) {
  const Ground& ground = prepared(GetParam()).ground;
  const std::vector<Walk>& walks = prepared(GetParam()).own_motions;
  const double e = ground.scene().voxel_size_m;
  std::string blind;
  for (int axis = 0; axis < 3; ++axis) {
    const char letter = "xyz"[axis];
    double most = 0.0;  // largest part of the shift along a touched face's normal
    for (const Walk& walk : walks)
      for (const reference::GapResult& gap : walk.gaps)
        if (gap.gap_m < 0)
          most = std::max(most, 2 * e * std::abs(gap.direction[axis]));
    if (most < 1.5 * e)
      blind += letter;
    for (const double sign : {-1.0, 1.0}) {
      const std::string name = std::string("grid shifted along ") + (sign < 0 ? '-' : '+') + letter;
      const Fault shift{.name = name, .grid_shift = sign * 2 * e * Vec3::Unit(axis)};
      const Outcome outcome = ground.judged(walks, shift);
      if (most >= 1.5 * e) {
        expect_caught(GetParam(), name, outcome);
      } else {
        std::printf("%-12s %-28s %4zu disagree, at most %.2f e along a touched face's normal\n",
                    GetParam().c_str(), name.c_str(),
                    static_cast<std::size_t>(outcome.counts.disagree), most / e);
        if (most < 1e-3 * e) {
          EXPECT_EQ(outcome.counts.disagree, 0U) << name << ": nothing that is touched has changed";
        }
      }
    }
  }
  if (const auto known = kBlindAxes.find(GetParam()); known != kBlindAxes.end()) {
    EXPECT_EQ(blind, known->second);
  }
  EXPECT_LT(blind.size(), 3U) << "a scene whose motions reveal no shift";
}

TEST_P(RealRendering, FlippedNormalsAndPullAreDetected) {
  Ground& ground = prepared(GetParam()).ground;
  contact::ContactRenderer& right = ground.built().renderer();
  contact::ContactRenderer inverted(
      ground.built().voxmap(), flipped(right.query().shell()), right.model(),
      rendering::contact_parameters(ground.scene().contact, right.model(), right.query().shell()),
      ground.built().field());
  const Fault flip{.name = "flipped normals", .renderer = &inverted};
  const Fault pull =
      tampered("force's sign", [](reference::ReportedContact& r) { r.wrench.force *= -1.0; });
  const Fault both = tampered("force's and torque's sign", [](reference::ReportedContact& r) {
    r.wrench.force *= -1.0, r.wrench.torque *= -1.0;
  });
  for (const Walk& walk : prepared(GetParam()).own_motions)
    for (const Fault& fault : {flip, pull, both})
      expect_caught(GetParam(), fault.name + ", " + walk.name, ground.judged(walk, fault));
}

/// From the n-th frame with a force on the wrench, or the whole report, is frozen.
Fault stuck(std::size_t onset, bool whole_report) {
  return {.tamper = [=] {
    return [=, contacts = std::size_t{0}, kept = reference::ReportedContact{}](
               std::size_t, reference::ReportedContact& report) mutable {
      if (contacts < onset) {
        if (!report.wrench.zero())
          ++contacts, kept = report;
      } else if (whole_report) {
        const Pose tool = report.pose_WT;
        report = kept;
        report.pose_WT = tool;
      } else {
        report.wrench = kept.wrench;
      }
    };
  }};
}

TEST_P(RealRendering, ForceHeldFromSomeContactOnIsDetected) {
  const Ground& ground = prepared(GetParam()).ground;
  for (const Walk& walk : prepared(GetParam()).own_motions)
    for (const std::size_t onset : {1U, 100U, 1000U}) {
      const std::string name = "from contact " + std::to_string(onset) + ", " + walk.name;
      expect_caught(GetParam(), "held " + name, ground.judged(walk, stuck(onset, false)));
      expect_caught(GetParam(), "frozen " + name, ground.judged(walk, stuck(onset, true)));
    }
}

/// For a sphere about the tool's origin the torque is only the noise of its shell, with either
/// sign: no reference can evaluate it. The same scenes are therefore walked with the sphere on a
/// handle of 15 edges, where the force has a lever.
TEST_P(RealRendering, WrongTorqueIsDetectedIfItHasALever) {
  const Fault sign =
      tampered("torque's sign", [](reference::ReportedContact& r) { r.wrench.torque *= -1.0; });
  const Fault about_world = tampered("torque about W's origin", [](reference::ReportedContact& r) {
    r.wrench.torque += r.pose_WT.position.cross(r.wrench.force);
  });
  const Fault missing =
      tampered("no torque", [](reference::ReportedContact& r) { r.wrench.torque.setZero(); });
  const Prepared &centred = prepared(GetParam()), &handle = prepared(GetParam(), true);
  EXPECT_EQ(centred.ground.judged(centred.own_motions, sign).counts.disagree, 0U);
  for (const Walk& walk : handle.walks) {
    const Outcome clean = handle.ground.judged(walk);
    EXPECT_EQ(clean.counts.disagree, 0U) << clean.first;
  }
  for (const Fault& fault : {sign, about_world, missing})
    expect_caught(GetParam(), fault.name, handle.ground.judged(handle.own_motions, fault));
}

/// A file in millimetres read as metres, or the reverse, on either side.
TEST_P(RealRendering, WrongMeshScaleIsDetected) {
  const Ground& ground = prepared(GetParam()).ground;
  const std::vector<Walk>& walks = prepared(GetParam()).own_motions;
  for (const bool dynamic : {false, true})
    for (const double factor : {1e-3, 1e3}) {
      scene::Scene wrong = ground.scene();
      (dynamic ? wrong.dynamic_mesh : wrong.static_meshes.front()).scale *= factor;
      const std::string size = factor > 1 ? "large" : "small";
      const std::string name = (dynamic ? "tool 1000 times too " : "world 1000 times too ") + size;
      std::unique_ptr<rendering::BuiltScene> built;
      try {
        built = rendering::build_scene(wrong, serial_for());
      } catch (const voxmap::VoxelBudgetError& refusal) {
        std::printf("%-12s %-28s refused: %s\n", GetParam().c_str(), name.c_str(), refusal.what());
        EXPECT_GT(factor, 1.0);
        continue;
      } catch (
          const std::invalid_argument& refusal) {  // `field`: nothing is inside a world that small
        std::printf("%-12s %-28s refused: %s\n", GetParam().c_str(), name.c_str(), refusal.what());
        EXPECT_EQ(ground.scene().contact.model, "field");
        EXPECT_TRUE(!dynamic && factor < 1.0);
        continue;
      }
      expect_caught(GetParam(), name,
                    ground.judged(walks, {.name = name, .renderer = &built->renderer()}));
    }
}

}  // namespace
}  // namespace voxtouch::test
