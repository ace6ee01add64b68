// `voxtouch up` that is given too little, or numbers and names that are none: a sentence, no signal, nothing left behind.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

const std::vector<std::string> kShort = {"--motion", "free", "--duration", "0.05", "--lockstep", "--no-record"};

Finished run_with_descriptors(int most) {
  std::vector<std::string> arguments = {"/bin/sh", "-c", "ulimit -n " + std::to_string(most) + "; exec \"$@\"", "sh"};
  const std::vector<std::string> up = up_arguments(shipped_scene("plane"), kShort);
  arguments.insert(arguments.end(), up.begin(), up.end());
  return Process(arguments).wait(std::chrono::seconds(60));
}

TEST(Descriptors, TooFewAreSaidAndNoProcessDiesOfThem) {
  for (int most = 3; most <= 64; ++most) {
    const Finished end = run_with_descriptors(most);
    EXPECT_NE(end.status, 0) << most;
    EXPECT_LT(end.status, 128) << most << " ended by a signal: " << end.err;
    if (most >= 10) {  // with fewer, the loader finds no libraries, or the scene's mesh cannot be opened
      EXPECT_NE(end.err.find("DDS needs 64"), std::string::npos) << most << ": " << end.err;
    }
  }
  const Finished enough = run_with_descriptors(80);
  EXPECT_EQ(enough.status, 0) << enough.err;
}

TEST(Options, ThatAreNoneAreRefusedAtOnce) {
  const std::string huge(1 << 17, '9');  // the longest argument that the kernel takes is a little longer
  const std::vector<std::pair<const char*, std::vector<std::string>>> bad = {
      {"--cpu", {"99999", "-1", "", "0x10", huge.substr(0, 100'000)}},
      {"--seed", {"99999999999999999999999", "-1", "nan", ""}},
      {"--validate-every", {"0", "99999999999999999999999", "nan", "0.5"}},
      {"--duration", {"nan", "-1", "inf", "1e-300", "1e9", ""}},
      {"--rig", {"a/b", "../x", std::string(100'000, 'x')}},
      {"--interface", {"<x>", "a b", std::string(100'000, 'x')}},
      {"--topic", {"a b", "a\x1b[2J", std::string(100'000, 'x')}},
      {"--let-go-at", {"nan", "-1"}},
      {"--grip-factor", {"nan", "-1", "1e308"}}};
  for (const auto& [option, values] : bad)
    for (const std::string& value : values) {
      std::vector<std::string> more = {"--lockstep", "--no-record", option, value};
      if (option != std::string("--duration")) more.insert(more.end(), {"--duration", "0.05"});
      const Finished end = run_ring(shipped_scene("plane"), more).process;
      EXPECT_NE(end.status, 0) << option << " " << value.substr(0, 80);
      EXPECT_LT(end.status, 128) << option << " " << value.substr(0, 80);
      EXPECT_NE(end.err, "") << option << " " << value.substr(0, 80);
      EXPECT_LT(end.err.size(), 20'000U) << option;
      EXPECT_EQ(end.err.find('\x1b'), std::string::npos) << option;
    }
}

/// plane.yaml, whose hand `hit`s at 8 m/s: up to some voxels a sample.
std::string struck_plane(const TemporaryFolder& folder) {
  std::stringstream text;
  text << std::ifstream(shipped_scene("plane")).rdbuf();
  std::string scene = text.str();
  for (const auto& [from, to] : {std::pair<std::string, std::string>{"../meshes", VOXTOUCH_DEPLOY "/meshes"},
                                 {"speed_m_per_s: 0.2, hold_s: 2.6", "speed_m_per_s: 8, hold_s: 0.2"}})
    for (std::size_t at = 0; (at = scene.find(from, at)) != std::string::npos; at += to.size()) scene.replace(at, from.size(), to);
  const auto file = folder / "struck_plane.yaml";
  std::ofstream(file) << scene;
  return file.string();
}

TEST(Missed, ARunInWhichAWallMayHaveBeenPassedUnseenIsNoGoodOne) {
  const TemporaryFolder folder;
  const RingResult run = run_ring(struck_plane(folder), {"--motion", "hit", "--duration", "2", "--lockstep", "--no-record"});
  EXPECT_EQ(run.process.status, 1);
  EXPECT_GT(run.summary["missed_samples"], 10);
  EXPECT_GT(run.summary["fast_samples"], run.summary["missed_samples"]) << "above the plane nothing can have been passed";
  bool told = false;
  for (const auto& problem : run.summary["problems"]) told |= problem.get<std::string>().find("passed something unseen") != std::string::npos;
  EXPECT_TRUE(told) << run.process.out;
}

}  // namespace
}  // namespace voxtouch::test
