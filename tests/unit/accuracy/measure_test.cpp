#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <random>

#include "core/accuracy/accuracy.hpp"
#include "core/accuracy/contact_errors.hpp"
#include "core/accuracy/contact_places.hpp"
#include "core/accuracy/measured_progress.hpp"
#include "core/reference/reference_scene.hpp"
#include "core/rendering/build.hpp"
#include "core/scene/scene_file.hpp"

namespace voxtouch::accuracy {
namespace {

scene::Scene shipped(const std::string& name) {
  return scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/" + name + ".yaml");
}

AccuracySetting setting(contact::ContactModelKind model, double edge,
                        contact::PointWeights weights = contact::PointWeights::kOne) {
  return {model, weights, edge, edge};
}

WrenchPair pair(const Vec3& given, const Vec3& truth, const Vec3& torque = Vec3::Zero()) {
  return {{given, torque}, {truth, Vec3::Zero()}};
}

TEST(ContactErrors, AreZeroForAModelRightUpToAScale) {
  AccuracyRow row;
  judge_wrenches(
      {pair({2, 0, 0}, {1, 0, 0}), pair({0, 6, 0}, {0, 3, 0}), pair({0, 0, -8}, {0, 0, -4})}, row);
  EXPECT_EQ(row.contacts, 3u);
  EXPECT_EQ(row.missed, 0u);
  EXPECT_EQ(row.direction_median_deg, 0.0);
  EXPECT_EQ(row.direction_p95_deg, 0.0);
  EXPECT_NEAR(row.magnitude_noise, 0.0, 1e-15);
  EXPECT_EQ(row.torque_error_m, 0.0);
}

TEST(ContactErrors, AreThoseOfRotatedScaledAndShiftedForces) {
  AccuracyRow row;
  const double c = std::cos(0.1), s = std::sin(0.1);
  judge_wrenches({pair({c, s, 0}, {1, 0, 0}, {0, 0, 0.002}),
                  pair({3 * c, 0, 3 * s}, {1, 0, 0}, {0, 0.006, 0})},
                 row);
  EXPECT_NEAR(row.direction_median_deg, 0.1 * 180 / M_PI, 1e-12);
  EXPECT_NEAR(row.magnitude_noise, 0.5, 1e-12) << "ratios 1 and 3";
  EXPECT_NEAR(row.torque_error_m, 0.002, 1e-15);
  judge_onsets({0.001, -0.002, 0.0005}, row);
  EXPECT_EQ(row.onset_error_m, 0.0005);
  EXPECT_EQ(row.onset_worst_m, -0.002);
}

TEST(ContactErrors, CountMissedButNotImperceptibleContacts) {
  AccuracyRow row;
  judge_wrenches(
      {pair({0, 0, 0}, {1, 0, 0}), pair({1, 0, 0}, {0, 0, 0}), pair({1, 0, 0}, {1, 0, 0})}, row);
  EXPECT_EQ(row.contacts, 1u);
  EXPECT_EQ(row.missed, 1u);
  EXPECT_EQ(row.missed_ratio(), 0.5);
  EXPECT_EQ(row.force_ratio, 0.5);
  EXPECT_EQ(row.magnitude_noise, 1.0);
  EXPECT_EQ(row.direction_mean_deg, 90.0);
  EXPECT_TRUE(std::isinf(row.torque_error_m));
  EXPECT_EQ(angle_deg(Vec3::Zero(), Vec3(1, 0, 0)), 180.0);
  EXPECT_EQ(median_of({}), 0.0);
  EXPECT_EQ(p95_of({5, 1, 2}), 5.0);
}

/// However accurate the displayed half is: a setting without force in the other half ranks behind
/// one that acts outward everywhere.
TEST(ContactErrors, RankAHalfMissedContactBehindABadAngle) {
  std::vector<WrenchPair> half, all;
  for (int n = 0; n < 20; ++n) {
    half.push_back(pair(n % 2 == 0 ? Vec3(1, 0, 0) : Vec3(0, 0, 0), {1, 0, 0}));
    all.push_back(pair({0.1, 1, 0}, {1, 0, 0}));
  }
  AccuracyRow feels_half, feels_all;
  judge_wrenches(half, feels_half), judge_wrenches(all, feels_all);
  EXPECT_LT(feels_all.direction_mean_deg, feels_half.direction_mean_deg);
  EXPECT_GT(feels_half.direction_p95_deg, 179.0);
}

/// The table of the binomial distribution: ranks of the ends for n = 5 to 100 (Conover 1999, table
/// A3).
TEST(MedianInterval, EndsAtTheBinomialRanks) {
  const auto ranks = [](int n) {
    std::vector<double> values;
    for (int k = n; k >= 1; --k)
      values.push_back(k);
    const Interval both = median_interval(values);
    return std::pair(both.low, both.high);
  };
  EXPECT_TRUE(std::isnan(ranks(5).first)) << "five values leave 6 % beyond both";
  EXPECT_EQ(ranks(6), std::pair(1.0, 6.0));
  EXPECT_EQ(ranks(9), std::pair(2.0, 8.0));
  EXPECT_EQ(ranks(20), std::pair(6.0, 15.0));
  EXPECT_EQ(ranks(100), std::pair(40.0, 61.0));
  EXPECT_EQ(ranks(1000), std::pair(469.0, 532.0));
  EXPECT_NEAR(ranks(2000).first, 956, 1.0);
  EXPECT_NEAR(ranks(2000).second, 2001 - 956, 1.0);
}

/// 400 draws of 31 values each: the median lies in at least 93 % of the intervals.
TEST(MedianInterval, CoversTheMedianIn95PercentOfDraws) {
  std::mt19937_64 random(11);
  std::exponential_distribution<double> draw(1.0);
  int holds = 0;
  for (int n = 0; n < 400; ++n) {
    std::vector<double> values;
    for (int k = 0; k < 31; ++k)
      values.push_back(draw(random));
    const Interval both = median_interval(values);
    holds += both.low <= std::log(2.0) && std::log(2.0) <= both.high;
  }
  EXPECT_GE(holds, 372);
  EXPECT_LE(holds, 398);
}

TEST(ContactPlaces, TouchAndAreTheSameForTheSameSeed) {
  scene::Scene scene = shipped("cup");
  const std::vector<ContactPlace> places = contact_places(scene, 10, 7),
                                  again = contact_places(scene, 10, 7),
                                  others = contact_places(scene, 10, 8);
  ASSERT_EQ(places.size(), 10u);
  scene.dynamic_mesh.primitives.clear();
  const reference::ReferenceScene reference(scene);
  for (std::size_t n = 0; n < places.size(); ++n) {
    EXPECT_NEAR(reference.gap(places[n].touch).gap_m, 0.0, 1e-8);
    EXPECT_GT(reference.gap(places[n].at(-0.0005)).gap_m, 0.0);
    EXPECT_NEAR(places[n].into.norm(), 1.0, 1e-12);
    EXPECT_EQ(places[n].touch.position, again[n].touch.position);
    EXPECT_NE(places[n].touch.position, others[n].touch.position);
  }
}

/// A separate clock: one kind of step takes ten times its estimate, another a fifth.
TEST(MeasuredProgress, EstimatesTheRestFromEqualSteps) {
  double now = 0.0, reported_left = 0.0, last = 0.0;
  MeasuredProgress progress([&] { return now; },
                            [&](const std::string&, double fraction, double left_s) {
                              EXPECT_GE(fraction, last);
                              last = fraction, reported_left = left_s;
                            });
  constexpr int kSteps = 4;
  double left = 0.0;
  for (int n = 0; n < kSteps; ++n)
    progress.plan(Step::kTruth, 1.0), progress.plan(Step::kPhase, 5.0), left += 10.0 + 1.0;
  const auto run = [&](Step kind, double guess, double takes) {
    progress.begin(kind, "a step", guess);
    for (int part = 1; part <= 10; ++part)
      now += 0.1 * takes, progress.at(0.1 * part);
    left -= takes;
  };
  run(Step::kTruth, 1.0, 10.0), run(Step::kPhase, 5.0, 1.0);
  EXPECT_NEAR(reported_left, left, 0.05 * left) << "one of each kind is enough";
  for (int n = 1; n < kSteps; ++n) {
    run(Step::kTruth, 1.0, 10.0);
    EXPECT_NEAR(reported_left, left, 0.05 * left);
    run(Step::kPhase, 5.0, 1.0);
    EXPECT_NEAR(reported_left, left, 0.05 * left + 1e-9);
  }
  EXPECT_EQ(last, 1.0);
}

TEST(MeasuredProgress, UsesEstimatesWithoutAClock) {
  double last = 0.0, left = 0.0;
  MeasuredProgress progress({}, [&](const std::string&, double fraction, double left_s) {
    last = fraction, left = left_s;
  });
  progress.plan(Step::kPlaces, 1.0), progress.plan(Step::kTruth, 3.0);
  progress.begin(Step::kPlaces, "places", 1.0);
  EXPECT_NEAR(left, 4.0, 1e-12) << "reported before anything is measured";
  progress.at(0.5);
  EXPECT_NEAR(last, 0.125, 1e-12);
  progress.begin(Step::kTruth, "truth", 3.0);
  EXPECT_NEAR(last, 0.25, 1e-12);
  progress.at(1.0);
  EXPECT_EQ(last, 1.0);
}

/// Used for the grid's positions: a field that ends below the contacts gives bit-identical results,
/// from fewer nodes.
TEST(Accuracy, TruncatedFieldIsBitIdenticalInContact) {
  const scene::Scene scene = shipped("cylinder");
  constexpr double kDepthEdges = 1.5;
  const auto build = [&](std::optional<double> depth) {
    return rendering::build_scene(scene, serial_for(),
                                  {.model = contact::ContactModelKind::kField,
                                   .weights = contact::PointWeights::kArea,
                                   .field_depth_voxels = depth});
  };
  const auto whole = build(std::nullopt), shallow = build(kDepthEdges + 2.0);
  EXPECT_LT(shallow->field()->stored_nodes(), whole->field()->stored_nodes());
  for (const ContactPlace& place : contact_places(scene, 20, 3)) {
    const Pose pose = place.at(kDepthEdges * scene.voxel_size_m);
    const Wrench a = whole->renderer().probe(pose).wrench,
                 b = shallow->renderer().probe(pose).wrench;
    EXPECT_GT(a.force.norm(), 0.0);
    EXPECT_EQ(a.force, b.force);
    EXPECT_EQ(a.torque, b.torque);
  }
}

TEST(Accuracy, ModelsComeInTheirOrderAndErrorsFallWithTheVoxel) {
  AccuracyOptions options;
  options.contacts = 40;
  const std::vector<AccuracyRow> rows = measure_accuracy(
      shipped("cylinder"),
      {setting(contact::ContactModelKind::kOriginal, 0.002),
       setting(contact::ContactModelKind::kAdapted, 0.004),
       setting(contact::ContactModelKind::kAdapted, 0.002),
       setting(contact::ContactModelKind::kAdapted, 0.001),
       setting(contact::ContactModelKind::kField, 0.002, contact::PointWeights::kArea)},
      options, serial_for());
  ASSERT_EQ(rows.size(), 5u);
  for (const AccuracyRow& row : rows) {
    ASSERT_EQ(row.refused, "");
    EXPECT_GE(row.contacts + row.missed, 30u);
    EXPECT_EQ(row.median_us, 0.0) << "no clock was given";
    EXPECT_GT(row.bytes, 0u);
  }
  const AccuracyRow &original = rows[0], &adapted = rows[2], &field = rows[4];
  EXPECT_LT(adapted.direction_median_deg, original.direction_median_deg);
  EXPECT_LT(field.direction_median_deg, 0.5 * adapted.direction_median_deg);
  EXPECT_LT(field.magnitude_noise, adapted.magnitude_noise);
  EXPECT_LT(std::abs(field.onset_error_m), std::abs(adapted.onset_error_m));
  EXPECT_GT(rows[1].direction_median_deg, rows[3].direction_median_deg);
  EXPECT_LT(rows[1].shell_points, rows[3].shell_points);
}

/// `field` has depth everywhere; `adapted` in one layer of voxels only, so its force is smaller
/// deep inside; both detect the tool from outside.
TEST(Accuracy, MeasuresTheSpreadOverDepthAndGridPlace) {
  AccuracyOptions options;
  options.contacts = 24, options.spread_contacts = 16;
  const std::vector<AccuracyRow> rows = measure_accuracy(
      shipped("plane"),
      {setting(contact::ContactModelKind::kAdapted, 0.002),
       setting(contact::ContactModelKind::kAdapted, 0.002, contact::PointWeights::kArea),
       setting(contact::ContactModelKind::kField, 0.002, contact::PointWeights::kArea)},
      options, serial_for());
  for (const AccuracyRow& row : rows) {
    ASSERT_EQ(row.refused, "");
    ASSERT_EQ(row.depths.size(), 5u);
    EXPECT_EQ(row.depths[0].edges, 0.25);
    EXPECT_EQ(row.depths[4].edges, 4.0);
    for (const DepthFigures& at : row.depths)
      EXPECT_GE(at.contacts + at.missed, 12u);
    EXPECT_EQ(row.phases.phases, 4u);
    EXPECT_GE(row.phases.contacts, 12u);
    EXPECT_LE(row.phases.direction_mean_deg.low, row.phases.direction_mean_deg.high);
    EXPECT_LE(row.phases.force_ratio.low, row.phases.force_ratio.high);
    EXPECT_LE(row.direction_median_95.low, row.direction_median_deg);
    EXPECT_GE(row.direction_median_95.high, row.direction_median_deg);
  }
  const AccuracyRow &one = rows[0], &adapted = rows[1], &field = rows[2];
  for (const DepthFigures& at : field.depths) {
    EXPECT_EQ(at.missed, 0u) << at.edges;
    EXPECT_NEAR(at.force_ratio, 1.0, 0.1) << at.edges;
  }
  EXPECT_NEAR(one.force_ratio, adapted.force_ratio, 0.15)
      << "the law of points that weigh one is that of their mean area";
  EXPECT_LT(adapted.depths[4].force_ratio, 0.6) << "depth is known for one layer";
  EXPECT_LT(field.phases.direction_mean_deg.high, adapted.phases.direction_mean_deg.high);
}

TEST(Accuracy, IsReproducibleAndTimedIfThereIsAClock) {
  AccuracyOptions options;
  options.contacts = 8;
  const std::vector<AccuracySetting> settings = {
      setting(contact::ContactModelKind::kAdapted, 0.002)};
  const AccuracyRow a =
      measure_accuracy(shipped("tilted_plane"), settings, options, serial_for()).front();
  double time = 0.0, last = -1.0;
  options.cpu_time_s = [&] { return time += 1e-6; };
  options.progress = [&](const std::string& what, double fraction, double left_s) {
    EXPECT_GE(left_s, 0.0);
    EXPECT_FALSE(what.empty());
    EXPECT_GE(fraction, last);
    EXPECT_LE(fraction, 1.0);
    last = fraction;
  };
  const AccuracyRow b =
      measure_accuracy(shipped("tilted_plane"), settings, options, serial_for()).front();
  EXPECT_EQ(a.direction_median_deg, b.direction_median_deg);
  EXPECT_EQ(a.magnitude_noise, b.magnitude_noise);
  EXPECT_EQ(a.torque_error_m, b.torque_error_m);
  EXPECT_EQ(a.onset_error_m, b.onset_error_m);
  EXPECT_NEAR(b.median_us, 0.0, 1e-9) << "a frame takes as many ticks as the clock itself";
  EXPECT_GT(b.build_s, 0.0);
}

TEST(Accuracy, ReportsAnInfeasibleSettingWithItsReason) {
  AccuracyOptions options;
  options.contacts = 3;
  const std::vector<AccuracyRow> rows = measure_accuracy(
      shipped("plane"),
      {setting(contact::ContactModelKind::kField, 0.002, contact::PointWeights::kOne),
       setting(contact::ContactModelKind::kAdapted, 1e-7),
       setting(contact::ContactModelKind::kAdapted, 0.004)},
      options, serial_for());
  EXPECT_GT(rows[0].refused.size(), 20u);
  EXPECT_GT(rows[1].refused.size(), 20u);
  EXPECT_EQ(rows[0].contacts, 0u);
  EXPECT_EQ(rows[2].refused, "");
  EXPECT_GT(rows[2].contacts, 0u);
}

TEST(ToolRow, ComparesTheVirtualToolWithTheExactBall) {
  for (const char* name : {"plane", "cylinder", "cup"}) {
    AccuracyOptions options;
    options.contacts = 40;
    AccuracySetting tool =
        setting(contact::ContactModelKind::kField, 0.002, contact::PointWeights::kArea);
    tool.virtual_tool = true;
    const AccuracyRow row = measure_accuracy(shipped(name), {tool}, options, serial_for()).front();
    ASSERT_EQ(row.refused, "") << name;
    std::printf("%s: direction %.3f, 95 %% %.2f deg, noise %.4f, missed %u of %u\n", name,
                row.direction_median_deg, row.direction_p95_deg, row.magnitude_noise, row.missed,
                row.contacts + row.missed);
    std::printf("%s: %.2f queries a frame that slides\n", name, row.queries_per_frame);
    EXPECT_EQ(row.missed, 0u) << name;
    EXPECT_LT(row.direction_median_deg, 2.5) << name;
    EXPECT_GE(row.queries_per_frame, 0.5)
        << name << ": a frame that keeps the rows of the one before is no measure of time";
    EXPECT_LT(row.magnitude_noise, 0.05) << name;
  }
}

AccuracyRow tool_row(const scene::Scene& scene) {
  AccuracyOptions options;
  options.contacts = 8, options.spread_contacts = 4, options.phases = 1;
  AccuracySetting tool =
      setting(contact::ContactModelKind::kField, 0.002, contact::PointWeights::kArea);
  tool.virtual_tool = true;
  return measure_accuracy(scene, {tool}, options, serial_for()).front();
}

TEST(ToolRow, ComparesATurnedBlockWithAGodObject) {
  scene::Scene scene = shipped("plane");
  scene.dynamic_mesh = shipped("block").dynamic_mesh;
  scene.dynamic_mesh.scale = 0.5;
  const AccuracyRow row = tool_row(scene);
  ASSERT_EQ(row.refused, "");
  EXPECT_EQ(row.tool_truth, ToolTruth::kGodObject);
  EXPECT_EQ(row.without_truth, 0u);
  EXPECT_GE(row.contacts, 6u);
  EXPECT_EQ(row.missed, 0u);
  EXPECT_LT(row.direction_median_deg, 1.0);
  EXPECT_NEAR(row.force_ratio, 1.0, 0.1);
  EXPECT_TRUE(std::isfinite(row.torque_error_m));
}

TEST(ToolRow, ComparesADeclaredSphereWithTheExactBall) {
  EXPECT_EQ(tool_row(shipped("plane")).tool_truth, ToolTruth::kBall);
}

TEST(ToolRow, RefusesAnOpenToolWithASentence) {
  scene::Scene scene = shipped("plane");
  const std::string path = testing::TempDir() + "voxtouch_open_tool.obj";
  std::ofstream(path) << "v 0 0 0\nv 0.02 0 0\nv 0 0.02 0\nv 0 0 0.02\nf 1 2 3\nf 1 4 2\n";
  scene.dynamic_mesh.path = path;
  scene.dynamic_mesh.scale = 1.0;
  scene.dynamic_mesh.primitives.clear();
  const AccuracyRow row = tool_row(scene);
  EXPECT_NE(row.refused.find("open"), std::string::npos) << row.refused;
  EXPECT_NE(row.refused.find("Close the mesh"), std::string::npos) << row.refused;
}

}  // namespace
}  // namespace voxtouch::accuracy
