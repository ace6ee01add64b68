// Programs that find what others built: the same bits, one building for all, and a sentence where a
// file is not right.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <memory>

#include "tests/ring/ring_run.hpp"
#include "tests/support/bag_hash.hpp"

namespace voxtouch::test {
namespace {

class CachedRing : public testing::Test {
 protected:
  CachedRing() {
    ::unsetenv("VOXTOUCH_NO_CACHE");
    ::setenv("XDG_CACHE_HOME", (folder_ / "cache").c_str(), 1);
  }
  std::vector<std::filesystem::path> kept() const {
    std::vector<std::filesystem::path> files;
    std::error_code none;
    for (const auto& entry :
         std::filesystem::directory_iterator(folder_ / "cache/voxtouch/scenes", none))
      files.push_back(entry.path());
    return files;
  }
  /// Contacts and commands of a run, as bits; what was said to `said`.
  std::vector<bag::TopicHash> run(const std::string& name, const std::vector<std::string>& more,
                                  std::string* said = nullptr) const {
    std::vector<std::string> words{"--lockstep",
                                   "--motion",
                                   "slide",
                                   "--duration",
                                   "1",
                                   "--record",
                                   (folder_ / name).string()};
    words.insert(words.end(), more.begin(), more.end());
    const RingResult ring = run_ring(shipped_scene("cup_field"), words);
    EXPECT_EQ(ring.process.status, 0) << ring.process.err << ring.process.out;
    if (said)
      *said = ring.process.err;
    const auto bag = bag::WholeBag::open(folder_ / name);
    std::vector<bag::TopicHash> hashes;
    for (const char* topic : {"/haptic/rendering/contact", "/haptic/coupling/command"}) {
      hashes.push_back(bag::hash_topic(*bag, topic, bag::ring_sequence_number).value());
      EXPECT_EQ(hashes.back().messages, 1000U) << topic;
    }
    return hashes;
  }

  TemporaryFolder folder_;
};

TEST_F(CachedRing, GivesTheSameBitsWhetherItsSceneWasBuiltOrFound) {
  const auto without = run("without", {"--no-cache"});
  EXPECT_TRUE(kept().empty());
  EXPECT_TRUE(run("built", {}) == without);
  ASSERT_EQ(kept().size(), 1U);
  std::string said;
  EXPECT_TRUE(run("found", {}, &said) == without);
  EXPECT_EQ(said.find("built anew"), std::string::npos) << said;

  std::filesystem::resize_file(kept().front(), std::filesystem::file_size(kept().front()) / 2);
  EXPECT_TRUE(run("cut", {}, &said) == without);
  EXPECT_NE(said.find(kept().front().string()), std::string::npos) << said;
  EXPECT_EQ(said.find("rendering: the scene"), std::string::npos)
      << "it was mended by the first that met it: " << said;
}

TEST_F(CachedRing, LetsProgramsStartTogether) {
  std::vector<std::unique_ptr<Process>> programs;
  for (int n = 0; n < 4; ++n)
    programs.push_back(std::make_unique<Process>(std::vector<std::string>{
        VOXTOUCH_BIN "/voxtouch", "plan", shipped_scene("cup_field"), "--no-measure"}));
  std::vector<std::string> plans;
  for (const auto& program : programs) {
    const Finished end = program->wait();
    EXPECT_EQ(end.status, 0) << end.err;
    EXPECT_EQ(end.err.find("kept in"), std::string::npos) << end.err;
    plans.push_back(end.out);
  }
  for (const std::string& plan : plans)
    EXPECT_EQ(plan, plans.front());
  ASSERT_EQ(kept().size(), 1U) << "and nothing half written beside it";
  Process again({VOXTOUCH_BIN "/voxtouch", "plan", shipped_scene("cup_field"), "--no-measure"});
  EXPECT_EQ(again.wait().out, plans.front());
}

TEST_F(CachedRing, GoesOnWhereNothingCanBeKept) {
  std::ofstream(folder_ / "cache") << "in the way";
  Process program({VOXTOUCH_BIN "/voxtouch", "plan", shipped_scene("plane"), "--no-measure"});
  const Finished end = program.wait();
  EXPECT_EQ(end.status, 0) << end.err;
  EXPECT_NE(end.err.find("--no-cache"), std::string::npos) << end.err;
}

}  // namespace
}  // namespace voxtouch::test
