/// The picture of `voxtouch accuracy`: XML that every reader takes, all that was measured on it, labels apart.
#include <gtest/gtest.h>

#include <limits>

#include "nodes/cli/label_layout.hpp"
#include "tests/unit/cli/accuracy_support.hpp"

namespace voxtouch::cli {
namespace {

using test::accuracy_report;
using test::count_elements;

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t found = 0;
  for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += word.size()) ++found;
  return found;
}

void expect_sound(const std::string& svg) {
  EXPECT_NO_THROW(EXPECT_GT(count_elements(svg), 20u)) << svg;
  EXPECT_TRUE(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\""));
  for (const char* word : {"nan", "inf,", "\"inf", "-inf"}) EXPECT_EQ(count(svg, word), 0u) << word;
}

TEST(AccuracyFigure, IsWellFormedAndNamesItsAxesWithUnits) {
  const std::string svg = to_svg(accuracy_figure(accuracy_report()));
  expect_sound(svg);
  EXPECT_EQ(count(svg, "CPU time of one frame, median [us]"), 2u);
  for (const char* word : {"direction error of the force, median [deg]", "noise, std / mean [%]", "What accuracy costs",
                           "Scene cup &amp; saucer", "40 contacts, 0.5 e deep", "not measured: 2", "voxel edge e [mm]",
                           "Some CPU, load 1.5", "Pareto front", "knee: field/area, 4 mm",
                           "original, every point weighs one", "field, points weigh their area"})
    EXPECT_EQ(count(svg, word), 1u) << word;
}

TEST(AccuracyFigure, ShowsEveryMeasuredSettingWithItsSizeAndNoOther) {
  const Figure figure = accuracy_figure(accuracy_report());
  ASSERT_EQ(figure.panels.size(), 2u);
  for (const Chart& panel : figure.panels) {
    std::size_t points = 0;
    for (const Series& s : panel.series) {
      if (s.mark == Mark::kRing) continue;
      points += s.x.size();
      for (std::size_t i = 0; i < s.x.size(); ++i) {
        EXPECT_GT(s.x[i], panel.x.low);
        EXPECT_LT(s.x[i], panel.x.high);
        EXPECT_GT(s.y[i], panel.y.low);
        EXPECT_LT(s.y[i], panel.y.high);
      }
    }
    EXPECT_EQ(points, 4u);
  }
  const std::string svg = to_svg(figure);
  EXPECT_EQ(count(svg, "class=\"size\""), 4u);
  EXPECT_EQ(count(svg, ">4</text>"), 2u);
}

TEST(AccuracyFigure, DrawsTheFrontAsStepsThroughItsRows) {
  const AccuracyReport report = accuracy_report();
  const Chart panel = accuracy_figure(report).panels[0];
  ASSERT_EQ(panel.curves.size(), 1u);
  const Curve& front = panel.curves[0];
  EXPECT_TRUE(front.steps);
  EXPECT_EQ(front.x, (std::vector<double>{5, 5, 10, 90, panel.x.high}));
  EXPECT_EQ(front.y, (std::vector<double>{panel.y.high, 8, 0.5, 0.05, 0.05}));
}

TEST(AccuracyFigure, DrawsTheWishAndWhetherItIsMet) {
  const std::string met = to_svg(accuracy_figure(accuracy_report({.direction_deg = 0.6})));
  expect_sound(met);
  EXPECT_EQ(count(met, "wanted: 0.6 deg"), 1u);
  EXPECT_EQ(count(met, "advised: field/area, 4 mm"), 1u);
  const std::string missed = to_svg(accuracy_figure(accuracy_report({.within_us = 0.5})));
  expect_sound(missed);
  EXPECT_EQ(count(missed, "wanted: within 0.5 us"), 1u);
  EXPECT_EQ(count(missed, "nearest: original/one, 4 mm"), 1u);
  expect_sound(to_svg(accuracy_figure(accuracy_report({.noise = 0.01}))));
}

TEST(AccuracyFigure, KeepsADenserShellInTheSameSeriesOfTheLegend) {
  AccuracyReport report = accuracy_report();
  report.rows.push_back(report.rows[2]);
  report.rows.back().setting.shell_voxel_m = 0.002;
  report.rows.back().median_us = 30;
  report.advice = advise(report.rows, {});
  const std::string svg = to_svg(accuracy_figure(report));
  expect_sound(svg);
  EXPECT_EQ(count(svg, "field, points weigh their area"), 1u);
  EXPECT_EQ(count(svg, ">4/2</text>"), 1u);
  EXPECT_EQ(count(svg, "voxel edge e / the shell's [mm]"), 1u);
}

TEST(AccuracyFigure, StaysSoundWithZerosOneRowOrNone) {
  AccuracyReport report = accuracy_report();
  report.rows[3].direction_median_deg = report.rows[3].magnitude_noise = 0.0;
  report.advice = advise(report.rows, {});
  const std::string zero = to_svg(accuracy_figure(report));
  expect_sound(zero);
  EXPECT_EQ(count(zero, "0.001 or less"), 1u);
  EXPECT_EQ(count(zero, "0.01 or less"), 1u);
  report.rows.resize(1);
  report.advice = advise(report.rows, {});
  expect_sound(to_svg(accuracy_figure(report)));
  report.rows[0].refused = "no";
  report.advice = advise(report.rows, {});
  expect_sound(to_svg(accuracy_figure(report)));
}

TEST(SvgChart, StepsKeepTheLevelUpToTheNextPoint) {
  Chart chart;
  chart.x = chart.y = {"", 0.0, 4.0, false};
  Curve stairs;
  stairs.x = {1, 2, 3}, stairs.y = {3, 2, 1}, stairs.steps = true;
  chart.curves = {stairs};
  // The plane is 712 x 420 px from (84, 66): a unit is 178 across and 105 down.
  EXPECT_EQ(count(to_svg(chart), "M262.0,171.0 L440.0,171.0 L440.0,276.0 L618.0,276.0 L618.0,381.0 "), 1u);
}

TEST(SvgChart, LeavesOutMarksThatCannotBeDrawn) {
  Chart chart;
  chart.x = chart.y = {"", 1.0, 100.0, true};
  Series s;
  s.x = {10, 0, -1, std::numeric_limits<double>::quiet_NaN(), 1000}, s.y = {10, 10, 10, 10, 10};
  s.labels = {"in", "a", "b", "c", "d"};
  chart.series = {s};
  const std::string svg = to_svg(chart);
  expect_sound(svg);
  EXPECT_EQ(count(svg, "<circle"), 1u);
  EXPECT_EQ(count(svg, "class=\"size\""), 1u);
}

TEST(LabelLayout, KeepsLabelsApartAndOffTheMarks) {
  const Box plane{0, 0, 300, 300};
  std::vector<Box> placed;
  LabelLayout layout(plane);
  for (int i = 0; i < 4; ++i) placed.push_back({145.0 + 4 * i, 145, 155.0 + 4 * i, 155}), layout.block(placed.back());
  for (int i = 0; i < 4; ++i) placed.push_back(layout.place(150 + 4 * i, 150, 24, 11, 8));
  for (std::size_t a = 4; a < placed.size(); ++a) {
    EXPECT_DOUBLE_EQ(overlap(placed[a], plane), 24 * 11) << "label " << a << " leaves the plane";
    for (std::size_t b = 0; b < a; ++b) EXPECT_EQ(overlap(placed[a], placed[b]), 0.0) << a << " on " << b;
  }
}

TEST(LabelLayout, StaysWithinThePlaneAtItsCorners) {
  const Box plane{0, 0, 100, 100};
  for (const double x : {0.0, 100.0})
    for (const double y : {0.0, 100.0})
      EXPECT_DOUBLE_EQ(overlap(LabelLayout(plane).place(x, y, 20, 10, 8), plane), 200.0);
}

TEST(LabelLayout, PlacesALabelEvenWhereNothingIsFree) {
  LabelLayout layout({0, 0, 10, 10});
  const Box box = layout.place(5, 5, 40, 40, 8);
  EXPECT_NEAR(box.width(), 40, 1e-9);
}

}  // namespace
}  // namespace voxtouch::cli
