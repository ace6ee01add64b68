// The paper's experiments in a short form that still decides them.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/experiments/paper/experiments.hpp"

namespace voxtouch::paper {
namespace {

const Merit& named(const std::vector<Merit>& merits, const std::string& what) {
  for (const Merit& m : merits)
    if (m.what.find(what) != std::string::npos)
      return m;
  throw std::runtime_error("no merit " + what);
}

TEST(PaperExperiments, AdaptedDistractionRatiosMatchThePaper) {
  const std::vector<Merit> merits = contact_merits(180);
  EXPECT_NEAR(named(merits, "tilted plane").ours, 0.62, 0.062);
  EXPECT_NEAR(named(merits, "cylinder: adapted").ours, 0.58, 0.058);
  EXPECT_NEAR(named(merits, "not turned").ours, 0.27, 0.054);
  EXPECT_NEAR(named(merits, "sphere turned").ours, 0.56, 0.15) << "lower at small depths";
  EXPECT_LE(named(merits, "about its mean").ours, 0.02)
      << "on a plane along the grid nothing but a constant is left";
  const Merit& aligned = named(merits, "plane along the grid: adapted");
  EXPECT_LE(aligned.least, 0.47);
  EXPECT_GE(aligned.most, 0.47) << "between, by how the sphere lies in its voxels";
}

TEST(PaperExperiments, FiveHertzFilterSmoothsTheRest) {
  const FilterExperiment e = filter_experiment();
  EXPECT_LT(e.of_filter.noise, 0.6 * e.of_raw.noise);
  EXPECT_LT(e.of_filter.largest_step, 0.1 * e.of_raw.largest_step);
  EXPECT_NEAR(e.rise_time_s, 3.890 / (2 * M_PI * 5), 0.002) << "of two equal poles, to 90 %";
  EXPECT_NEAR(e.of_raw.noise, 0.19, 0.05);
  EXPECT_NEAR(e.of_filter.noise, 0.076, 0.02);
}

TEST(PaperExperiments, MeanNormalFailsInSlotsAndFieldDoesNot) {
  const std::vector<CornerAndSlot> all = corner_and_slot(22);
  const auto of = [&](const std::string& name) {
    for (const CornerAndSlot& c : all)
      if (c.contact_model == name)
        return c;
    throw std::runtime_error("no contact model " + name);
  };
  EXPECT_GT(of("adapted").corner_over_walls, 1.3);
  for (const char* name : {"original", "field"}) {
    EXPECT_NEAR(of(name).corner_over_walls, 1.0, 0.1) << name;
    EXPECT_LT(of(name).slot_over_wall, 0.35) << name;
  }
  EXPECT_LT(of("field").slot_over_wall, 0.05);
}

}  // namespace
}  // namespace voxtouch::paper
