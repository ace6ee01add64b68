/// `voxtouch accuracy` on users' parts with defaults: every setting, within a minute of one core.
#include <gtest/gtest.h>

#include <cstdio>

#include <sys/resource.h>

#include "tests/golden/golden.hpp"
#include "tests/support/parts.hpp"

namespace voxtouch::test {
namespace {

/// CPU time of all children that have ended [s].
double children_s() {
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

void expect_measured(const Part& part, const Part& tool, const std::string& name) {
  const TemporaryFolder folder;
  write_obj(part, folder / "part.obj"), write_obj(tool, folder / "tool.obj");
  const Finished made =
      voxtouch({"new", (folder / "part.obj").string(), (folder / "tool.obj").string(), "--unit",
                "m", "--tool-unit", "m", "--out", (folder / "part.yaml").string()});
  ASSERT_EQ(made.status, 0) << made.err;
  const double before = children_s();
  const Finished run = voxtouch({"accuracy", (folder / "part.yaml").string(), "--json", "--csv",
                                 (folder / "part.csv").string()});
  const double took = children_s() - before;
  ASSERT_EQ(run.status, 0) << run.err;
  std::printf("%s: %.1f s of CPU\n", name.c_str(), took);
  EXPECT_LE(took, 60.0) << name;
  int fraction = -1, reported_s = 0;  // the first line, before anything is measured
  const std::size_t first = run.err.find("accuracy: ");
  ASSERT_NE(first, std::string::npos) << run.err;
  ASSERT_EQ(std::sscanf(run.err.c_str() + first, "accuracy: %d %%, about %d s remain: ", &fraction,
                        &reported_s),
            2)
      << run.err;
  EXPECT_EQ(fraction, 0);
  EXPECT_GT(reported_s, took / 5.0);
  EXPECT_LT(reported_s, took * 5.0);
  const nlohmann::json rows = nlohmann::json::parse(run.out)["rows"];
  ASSERT_EQ(rows.size(), 16u);
  for (std::size_t n = 0; n < 15; ++n) {
    EXPECT_TRUE(rows[n]["refused"].is_null()) << rows[n]["refused"];
    EXPECT_GT(rows[n]["contacts"].get<int>() + rows[n]["missed"].get<int>(), 100);
    EXPECT_EQ(rows[n]["depths"].size(), 5u);
    EXPECT_EQ(rows[n]["phases"]["phases"], 4);
  }
  EXPECT_TRUE(rows[15]["refused"].is_null()) << rows[15]["refused"];
  EXPECT_LT(rows[15]["direction_p95_deg"], 0.1) << rows[15];
  EXPECT_NEAR(rows[15]["force_ratio"].get<double>(), 1.0, 0.003) << rows[15];
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    EXPECT_NE(entry.path().extension(), ".part") << entry.path();
}

TEST(AccuracyOfParts, TakesAMinuteAtMostForABracketAndAPeg) {
  expect_measured(bracket(), peg(), "bracket and peg");
}

}  // namespace
}  // namespace voxtouch::test
