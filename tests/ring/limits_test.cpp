// `voxtouch up` that is given too little, or numbers and names that are none: a sentence, no
// signal, nothing left behind.
#include <gtest/gtest.h>

#include <unistd.h>

#include <fstream>
#include <sstream>

#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

const std::vector<std::string> kShort = {"--motion", "free",       "--duration",
                                         "0.05",     "--lockstep", "--no-record"};

Finished run_with_descriptors(int most) {
  std::vector<std::string> arguments = {
      "/bin/sh", "-c", "ulimit -n " + std::to_string(most) + "; exec \"$@\"", "sh"};
  const std::vector<std::string> up = up_arguments(shipped_scene("plane"), kShort);
  arguments.insert(arguments.end(), up.begin(), up.end());
  return Process(arguments).wait(std::chrono::seconds(60));
}

TEST(Descriptors, TooFewAreReportedWithoutACrash) {
  for (int most = 3; most <= 64; ++most) {
    const Finished end = run_with_descriptors(most);
    EXPECT_NE(end.status, 0) << most;
    EXPECT_LT(end.status, 128) << most << " ended by a signal: " << end.err;
    if (most >=
        10) {  // with fewer, the loader finds no libraries, or the scene's mesh cannot be opened
      EXPECT_NE(end.err.find("DDS needs 64"), std::string::npos) << most << ": " << end.err;
    }
  }
  const Finished enough = run_with_descriptors(80);
  EXPECT_EQ(enough.status, 0) << enough.err;
}

/// Root has no such limit, so the processes run as a user that has no others.
TEST(Threads, TooFewAreReportedWithoutACrash) {
  if (geteuid() != 0)
    GTEST_SKIP() << "needs root: the limit counts all threads of a user";
  for (const int most : {1, 2, 3, 5, 8, 12, 16}) {
    const Finished end = Process({"/usr/bin/setpriv", "--reuid", "64123", "--clear-groups",
                                  "/usr/bin/prlimit", "--nproc=" + std::to_string(most),
                                  VOXTOUCH_BIN "/voxtouch", "status", "--domain", fresh_domain()})
                             .wait();
    EXPECT_LT(end.status, 128) << most << " ended by a signal: " << end.err;
    if (most <= 8) {
      EXPECT_TRUE(end.err.contains("the process limit")) << most << ": " << end.err;
    }
  }
}

TEST(Options, InvalidOnesAreRefusedAtOnce) {
  const std::string huge(1 << 17,
                         '9');  // the longest argument that the kernel takes is a little longer
  const std::vector<std::pair<const char*, std::vector<std::string>>> bad = {
      {"--cpu", {"99999", "-1", "", "0x10", huge.substr(0, 100'000)}},
      {"--seed", {"99999999999999999999999", "-1", "nan", ""}},
      {"--validate-every", {"0", "99999999999999999999999", "nan", "0.5"}},
      {"--duration", {"nan", "-1", "inf", "1e-300", "1e9", ""}},
      {"--rig", {"a/b", "../x", std::string(100'000, 'x')}},
      {"--interface", {"<x>", "a b", std::string(100'000, 'x')}},
      {"--topic", {"a b", "a\x1b[2J", std::string(100'000, 'x')}},
      {"--release-time", {"nan", "-1"}},
      {"--grip-factor", {"nan", "-1", "1e308"}}};
  for (const auto& [option, values] : bad)
    for (const std::string& value : values) {
      std::vector<std::string> more = {"--lockstep", "--no-record", option, value};
      if (option != std::string("--duration"))
        more.insert(more.end(), {"--duration", "0.05"});
      const Finished end = run_ring(shipped_scene("plane"), more).process;
      EXPECT_NE(end.status, 0) << option << " " << value.substr(0, 80);
      EXPECT_LT(end.status, 128) << option << " " << value.substr(0, 80);
      EXPECT_NE(end.err, "") << option << " " << value.substr(0, 80);
      EXPECT_LT(end.err.size(), 20'000U) << option;
      EXPECT_EQ(end.err.find('\x1b'), std::string::npos) << option;
    }
}

TEST(Missed, SuspectedTunnellingFailsTheRun) {
  const TemporaryFolder folder;
  // The hand `hit`s at 8 m/s: up to some voxels a sample.
  const std::string scene =
      changed_scene(folder, "plane",
                    {{"speed_m_per_s: 0.2,", "speed_m_per_s: 8,"}, {"hold_s: 2.6", "hold_s: 0.2"}});
  const RingResult run =
      run_ring(scene, {"--motion", "hit", "--duration", "2", "--lockstep", "--no-record"});
  EXPECT_EQ(run.process.status, 1);
  EXPECT_GT(run.summary["tunnelling_suspected_samples"], 10);
  EXPECT_GT(run.summary["fast_samples"], run.summary["tunnelling_suspected_samples"])
      << "above the plane nothing can have been passed";
  bool reported = false;
  for (const auto& problem : run.summary["problems"])
    reported |= problem.get<std::string>().find("suspected tunnelling") != std::string::npos;
  EXPECT_TRUE(reported) << run.process.out;
}

/// A ball of 10 mm on a plate of 2 mm, with a hand that moves through at 20 mm/s; on a voxel grid
/// of 2 mm.
std::string pressed_plate(const TemporaryFolder& folder, const std::string& contact) {
  std::ofstream plate(folder / "plate.obj");
  for (int k = 0; k < 8; ++k)
    plate << "v " << (k & 1 ? 0.06 : -0.06) << " " << (k & 2 ? 0.06 : -0.06) << " "
          << (k & 4 ? 0.0 : -0.002) << "\n";
  plate << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  plate.close();
  const std::string file = (folder / "pressed.yaml").string();
  std::ofstream(file)
      << "scene: pressed\nvoxel_size: 0.002\nstatic: [{mesh: plate.obj}]\ndynamic: {mesh: "
      << VOXTOUCH_DEPLOY
      << "/meshes/sphere.obj, scale: 0.01, parts: [{sphere: {radius: 0.01}}]}\ncontact: {"
      << contact << "}\ncoupling: {design: auto, kind: shaping_filter}\n"
      << "motions: {it: {path: [[0.003, 0.002, 0.013], [0.003, 0.002, -0.02]], speed_m_per_s: "
         "0.02, hold_s: 0.3}}\n";
  return file;
}

TEST(Memoryless, SlowPassThroughFailsTheRun) {
  for (const char* model : {"original", "adapted"}) {
    SCOPED_TRACE(model);
    const TemporaryFolder folder;
    const RingResult run = run_ring(
        pressed_plate(folder, std::string("model: ") + model +
                                  ", stiffness_n_per_m: 30, rendering: memoryless"),
        {"--motion", "it", "--duration", "3", "--lockstep", "--one-process", "--no-record"});
    EXPECT_EQ(run.process.status, 1);
    EXPECT_LE(run.summary["fast_samples"], 2)
        << "the tool behind the spring may snap through the plate";
    EXPECT_EQ(run.summary["latched_samples"], 0);
    EXPECT_GT(run.summary["passed_through_samples"], 10);
    EXPECT_EQ(run.summary["validator"]["disagree"], 0) << run.summary["problems"];
    EXPECT_FALSE(run.summary["limits"]["passed_through_samples"]["met"]);
  }
}

TEST(Memoryless, TouchIsPassed) {
  const TemporaryFolder folder;
  std::string scene =
      pressed_plate(folder, "model: adapted, stiffness_n_per_m: 30, rendering: memoryless");
  std::stringstream text;
  text << std::ifstream(scene).rdbuf();
  std::string touched = text.str();
  touched.replace(touched.find("-0.02]"), 5, "0.0095");
  std::ofstream(scene) << touched;
  const RingResult run = run_ring(
      scene, {"--motion", "it", "--duration", "2", "--lockstep", "--one-process", "--no-record"});
  EXPECT_EQ(run.process.status, 0) << run.process.out;
  EXPECT_GT(run.summary["contact_samples"], 500);
  EXPECT_EQ(run.summary["passed_through_samples"], 0);
}

}  // namespace
}  // namespace voxtouch::test
