/// `voxtouch probe` on scene files against the vectors' pose files: counts, sets, forces and
/// torques through the whole program, from the mesh file to the printed digits.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "tests/golden/golden.hpp"

namespace voxtouch::test {
namespace probe_verb_test {

constexpr double kTolerance = 1e-7;  // of the vectors, for double code

struct Case {
  std::string name, model;
  std::filesystem::path scene() const { return kData / "scenes" / (name + ".yaml"); }
  std::filesystem::path poses() const { return kVectors / "poses" / (name + ".csv"); }
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name << ", " << c.model; }

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const auto& pose_file : vector_index().at("poses")) {
    const std::string name =
        std::filesystem::path(pose_file.at("file").get<std::string>()).stem().string();
    for (const char* model : {"original", "adapted"})
      all.push_back({name, model});
  }
  return all;
}

class ProbeVerb : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(PoseFiles, ProbeVerb, testing::ValuesIn(cases()), [](const auto& test) {
  return test.param.name + "__" + test.param.model;
});

TEST_P(ProbeVerb, PrintsTheVectorsCountsSetsForcesAndTorques) {
  const Case& c = GetParam();
  const Finished run = voxtouch(
      {"probe", c.scene().string(), "--poses", c.poses().string(), "--model", c.model, "--points"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Table ours = Table::parse(run.out), theirs = Table::read(c.poses());
  EXPECT_EQ(ours.header(),
            (std::vector<std::string>{"nS", "nI", "coh", "fx", "fy", "fz", "tx", "ty", "tz", "S"}));
  ASSERT_EQ(ours.size(), theirs.size());
  const std::string prefix = c.model.substr(0, 1);
  double largest = 0.0;
  std::size_t touching = 0;
  for (std::size_t row = 0; row < ours.size(); ++row) {
    SCOPED_TRACE("row " + std::to_string(row));
    for (const char* column : {"nS", "nI", "S"})
      EXPECT_EQ(ours.text(row, column), theirs.text(row, column)) << column;
    EXPECT_EQ(fmt::format("{:.5f}", ours.number(row, "coh")), theirs.text(row, "coh"));
    touching += ours.text(row, "nS") != "0";
    for (const char axis : {'x', 'y', 'z'})
      for (const auto& [mine, vectors] : {std::pair{'f', 'F'}, std::pair{'t', 'T'}}) {
        const double off =
            ours.number(row, {mine, axis}) - theirs.number(row, prefix + vectors + axis);
        EXPECT_LE(std::abs(off), kTolerance) << mine << axis;
        largest = std::max(largest, std::abs(off));
      }
  }
  EXPECT_GT(touching, ours.size() / 2);
  std::printf("%s, %s: %zu poses, %zu with contact, largest difference %.1e\n", c.name.c_str(),
              c.model.c_str(), ours.size(), touching, largest);
}

const Case kOne{"sphere__cylinder__exact", "adapted"};

TEST(Probe, UsesTheScenesModelAndPrintsPointsOnRequest) {
  const std::vector<std::string> call{"probe", kOne.scene().string(), "--poses",
                                      kOne.poses().string()};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), call.begin(), call.end());
    return voxtouch(more).out;
  };
  const std::string plain = with({});
  EXPECT_EQ(plain, with({"--model", "adapted"}));
  EXPECT_NE(plain, with({"--model", "original"}));
  EXPECT_EQ(plain.substr(0, plain.find('\n')), "nS,nI,coh,fx,fy,fz,tx,ty,tz");
}

TEST(Probe, ReadsPosesFromStandardInput) {
  const std::string call = fmt::format("\"$VOXTOUCH\" probe '{}' --poses ", kOne.scene().string());
  const Finished piped = shell(fmt::format("{} - < '{}'", call, kOne.poses().string()));
  ASSERT_EQ(piped.status, 0) << piped.err;
  EXPECT_EQ(piped.out, shell(fmt::format("{} '{}'", call, kOne.poses().string())).out);
}

TEST(Probe, PrintsTheSameBytesOnEveryRunAndInEveryLocale) {
  const std::string call = fmt::format("\"$VOXTOUCH\" probe '{}' --points --poses '{}'",
                                       kOne.scene().string(), kOne.poses().string());
  const std::string once = shell(call).out;
  EXPECT_EQ(once, shell(call).out);
  EXPECT_EQ(once, shell("LC_ALL=de_DE.UTF-8 " + call).out);
}

TEST(Probe, ReferencePrintsTheGapToDeclaredPrimitives) {
  const std::filesystem::path scene = std::filesystem::path(VOXTOUCH_DEPLOY) / "scenes/plane.yaml";
  const Finished run = shell(fmt::format(
      "printf 'tx,ty,tz,qw,qx,qy,qz\\n0,0,0.05,1,0,0,0\\n0.01,-0.02,0.0085,2,0,0,0\\n' | "
      "\"$VOXTOUCH\" probe '{}' --model reference --poses -",
      scene.string()));
  ASSERT_EQ(run.status, 0) << run.err;
  const Table gaps = Table::parse(run.out);
  ASSERT_EQ(gaps.size(), 2U);
  EXPECT_NEAR(gaps.number(0, "gap_m"), 0.04, 1e-12);
  EXPECT_NEAR(gaps.number(1, "gap_m"), -0.0015, 1e-12);
  EXPECT_NEAR(gaps.number(1, "dz"), 1.0, 1e-12);
  EXPECT_EQ(gaps.text(1, "self_check"), "1");
}

}  // namespace probe_verb_test
}  // namespace voxtouch::test
