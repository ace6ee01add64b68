// `voxtouch up --device-file`: the ring is designed for the file, the check at start compares the
// device with it, and a file of another device is refused.
#include <gtest/gtest.h>

#include <fstream>

#include <fmt/format.h>

#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

struct Figures {
  double mass_kg = 10.0, delay_s = 0.002, step_m = 1e-6, rate_hz = 1000.0;
  std::string name = "fine arm";
};

/// An arm with a fine encoder and little friction: each figure of the check is measured on it.
std::string write_file(const TemporaryFolder& folder, const std::string& name, const Figures& f) {
  const std::string path = (folder / (name + ".yaml")).string();
  std::ofstream(path) << fmt::format(
      "device: {}\nrate_hz: {}\nmax_force_n: 100\nmax_torque_nm: 0\nmax_stiffness_n_per_m: 3000\n"
      "mass_kg: [{}, {}]\ndamping_ns_per_m: 2\ncoulomb_friction_n: 0.2\n"
      "position_resolution_m: {}\ndelay_s: {}\njitter: 0.05\nconsecutive_losses: 1\ngrip: arm\n"
      "measured: {{date: 2026-11-29, command: a test}}\n",
      f.name, f.rate_hz, f.mass_kg, f.mass_kg, f.step_m, f.delay_s);
  return path;
}

RingResult run_with(const TemporaryFolder& folder, const Figures& file) {
  return run_ring(shipped_scene("cup"),
                  {"--device", "sim:" + write_file(folder, "device", {}), "--device-file",
                   write_file(folder, "file", file), "--motion", "free", "--lockstep",
                   "--one-process", "--no-record", "--duration", "2"});
}

double critical_stiffness(const RingResult& run) {
  return run.summary["coupling"]["critical_stiffness_n_per_m"];
}

TEST(DeviceFileRing, TheRightFilePassesAndDesignsTheRing) {
  const TemporaryFolder folder;
  const RingResult right = run_with(folder, {});
  EXPECT_EQ(right.process.status, 0) << right.process.out << right.process.err;
  EXPECT_EQ(right.summary["limits"]["start_check_differences"]["value"], 0);
  const std::string notes = right.summary["notes"].dump();
  EXPECT_TRUE(notes.contains("mass agrees")) << notes;
  EXPECT_TRUE(notes.contains("delay agrees")) << notes;
  EXPECT_TRUE(notes.contains("encoder step agrees")) << notes;
  EXPECT_TRUE(right.process.err.contains("measured on 2026-11-29 by: a test"));
  EXPECT_GT(critical_stiffness(right), critical_stiffness(run_with(folder, {.delay_s = 0.006})));
}

struct Wrong {
  Figures file;
  const char* what;
};

TEST(DeviceFileRing, AFileThatTheDeviceContradictsFails) {
  for (const Wrong& wrong :
       {Wrong{{.mass_kg = 5.0}, "mass"}, Wrong{{.delay_s = 0.006}, "delay"},
        Wrong{{.delay_s = 0.002 / 3.0}, "delay"}, Wrong{{.step_m = 4e-6}, "encoder step"},
        Wrong{{.step_m = 0.25e-6}, "encoder step"}}) {
    SCOPED_TRACE(wrong.what);
    const TemporaryFolder folder;
    const RingResult run = run_with(folder, wrong.file);
    EXPECT_EQ(run.process.status, 1);
    EXPECT_EQ(run.summary["limits"]["start_check_differences"]["value"], 1);
    const std::string problems = run.summary["problems"].dump();
    EXPECT_TRUE(problems.contains(std::string("(") + wrong.what)) << problems;
    EXPECT_TRUE(run.process.err.contains("differs from its file")) << run.process.err;
  }
}

TEST(DeviceFileRing, AFileOfAnotherDeviceIsRefusedBeforeAnyForce) {
  for (const auto& [file, fact] :
       {std::pair<Figures, const char*>{{.name = "other arm"}, "other arm"},
        {{.rate_hz = 2000.0}, "2000 Hz"}}) {
    const TemporaryFolder folder;
    const RingResult run = run_with(folder, file);
    EXPECT_NE(run.process.status, 0);
    EXPECT_TRUE(run.process.err.contains("is not the file of this device")) << run.process.err;
    EXPECT_TRUE(run.process.err.contains(fact)) << run.process.err;
  }
}

}  // namespace
}  // namespace voxtouch::test
