/// The short form: broken files of tests/data/hostile, and a sample of the collection if it is
/// installed.
#include "tests/experiments/hostile_meshes/attempt.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <map>
#include <set>

#include "tests/support/seed.hpp"

namespace voxtouch::hostile {
namespace {

Limits limits() {
  Limits l;
  l.seed = testing::seed(1);
  l.poses = 50;
  return l;
}

std::filesystem::path made(const std::string& name) {
  return std::filesystem::path(VOXTOUCH_TEST_DATA "/hostile") / name;
}

TEST(HostileMeshes, AreRenderedOrRefusedForTheRightReason) {
  const std::map<std::string, std::string> refused{{"far.obj", "single precision"},
                                                   {"one_place.obj", "two equal corners"},
                                                   {"no_faces.obj", "no triangles"},
                                                   {"wrong_index.obj", "index"},
                                                   {"nan.obj", "not finite"},
                                                   {"overflow.obj", "not finite"},
                                                   {"truncated.stl", "1000 triangles"},
                                                   {"no_end.stl", "endsolid"},
                                                   {"absurd_count.ply", "4000000000"},
                                                   {"negative_index.ply", "invalid vertex indices"},
                                                   {"ring.gltf", "recursive"},
                                                   {"deep.gltf", "cannot be read"},
                                                   {"no_text.dae", "No document element"},
                                                   {"open_tag.dae", "tags mismatch"},
                                                   {"nothing.obj", "is empty"},
                                                   {"cut.glb", "4096 bytes"}};
  const std::set<std::string> touched{"inside_out.obj", "one_face_turned.obj", "hole.obj",
                                      "litter.obj",     "shared_edge.obj",     "fin.obj",
                                      "plate.obj",      "needle.obj",          "moebius.obj",
                                      "two_places.obj", "large_numbers.obj",   "tiny_numbers.obj"};
  const Limits l = limits();
  std::size_t met = 0;
  for (const std::filesystem::path& file : files_below(made(""))) {
    const Verdict v = attempt(file, l);
    const std::string name = file.filename().string();
    std::printf("%-22s %-8s %.2f s  %s\n", name.c_str(), name_of(v.outcome).c_str(), v.cpu_s,
                v.sentence.c_str());
    EXPECT_TRUE(v.good()) << name << ": " << name_of(v.outcome) << ": " << v.sentence;
    EXPECT_TRUE(touched.contains(name) || refused.contains(name)) << name << " has no expectation";
    if (touched.contains(name)) {
      EXPECT_EQ(v.outcome, Outcome::kTouched) << name << ": " << v.sentence;
      ++met;
    }
    if (const auto found = refused.find(name); found != refused.end()) {
      EXPECT_EQ(v.outcome, Outcome::kRefused) << name << ": " << v.sentence;
      EXPECT_NE(v.sentence.find(found->second), std::string::npos) << name << ": " << v.sentence;
      ++met;
    }
  }
  EXPECT_EQ(met, touched.size() + refused.size());
}

/// Every eighth file that the importer can be pointed at.
TEST(HostileMeshes, OfTheCollectionAreTouchedOrRefused) {
  std::vector<std::filesystem::path> known;
  for (const std::filesystem::path& file : files_below("/usr/share/assimp/models")) {
    const std::string e = file.extension().string();
    if (e == ".obj" || e == ".stl" || e == ".ply" || e == ".gltf" || e == ".glb" || e == ".dae")
      known.push_back(file);
  }
  if (known.empty())
    GTEST_SKIP() << "the package assimp-testmodels is not installed";
  Limits l = limits();
  for (std::size_t n = 0; n < known.size(); n += 8) {
    const Verdict v = attempt(known[n], l);
    EXPECT_TRUE(v.good()) << known[n] << ": " << name_of(v.outcome) << ": " << v.sentence;
  }
}

TEST(HostileMeshes, TrialSurvivesItsProcess) {
  Limits short_of_time = limits();
  short_of_time.cpu_s = 1, short_of_time.poses = 10'000'000;
  const Verdict slow = attempt(made("inside_out.obj"), short_of_time);
  EXPECT_EQ(slow.outcome, Outcome::kOutOfTime) << slow.sentence;
  EXPECT_LT(slow.cpu_s, 3.0);
  const std::vector<Verdict> verdicts{slow, attempt(made("nothing.obj"), limits())};
  const std::string table = as_markdown(verdicts);
  EXPECT_NE(table.find("| obj | 2 | 0 | 1 | 0 | 0 | 0 | 1 | 0 |"), std::string::npos) << table;
  EXPECT_NE(table.find("**out of time**"), std::string::npos) << table;
  EXPECT_NE(as_csv(verdicts).find("nothing.obj\",obj,refused,"), std::string::npos)
      << as_csv(verdicts);
}

}  // namespace
}  // namespace voxtouch::hostile
