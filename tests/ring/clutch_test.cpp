// The clutch through the whole ring: pressed in contact, the tool stays, the force fades out, and
// the contact fades in again afterwards.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

constexpr std::size_t kPress = 2000, kRelease = 2600,
                      kFadeOut = 101;  ///< samples of the motion below

/// plane.yaml with a clutch, and a hand that presses it while the tool is in contact.
std::string scene_with_clutch(const std::filesystem::path& folder) {
  std::ifstream in(shipped_scene("plane"));
  std::string line, text;
  while (std::getline(in, line)) {
    if (const auto at = line.find("../meshes"); at != std::string::npos)
      line.replace(at, 9, std::string(VOXTOUCH_DEPLOY) + "/meshes");
    if (line.starts_with("device:"))
      line = "device: {position_scale: 1, force_scale: 1, clutch_button: 0}";
    if (line.starts_with("motions:"))
      line +=
          "\n  clutched: {path: [[0, 0, 0.03], [0, 0, 0.007]], speed_m_per_s: 0.1, hold_s: 0.2, "
          "press: [{button: 0, from_s: 2, to_s: 2.6}]}";
    text += line + "\n";
    // In the grid that clears the plane's faces the hand yields by its encoder's first step after
    // 39 ms, within the tested time.
    if (line.ends_with("plane.obj"))
      text += "    origin: [-0.122, -0.122, -0.022]\n";
  }
  const std::string file = (folder / "clutch.yaml").string();
  std::ofstream(file) << text;
  return file;
}

double force(const msg::ForceCommand& c) {
  return std::hypot(c.wrench.force.x, c.wrench.force.y, c.wrench.force.z);
}

TEST(Clutch, InContactHoldsTheToolAndFadesTheForce) {
  const TemporaryFolder folder;
  const RingResult r =
      run_ring(scene_with_clutch(folder / ""),
               {"--lockstep", "--one-process", "--device", "sim-phantom", "--motion", "clutched",
                "--duration", "4", "--record", (folder / "bag").string()});
  ASSERT_EQ(r.process.status, 0) << r.process.err << r.process.out;
  const auto contacts =
      read_ring_topic<msg::ContactState>(folder / "bag", "/haptic/rendering/contact");
  const auto commands =
      read_ring_topic<msg::ForceCommand>(folder / "bag", "/haptic/coupling/command");
  ASSERT_EQ(contacts.size(), 4000U);
  ASSERT_EQ(commands.size(), 4000U);
  EXPECT_GT(force(commands[kPress - 1]), 0.05) << "in contact";
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const bool clutched = (contacts[i].flags & msg::contact_state::kFlagClutched) != 0;
    ASSERT_EQ(clutched, i >= kPress && i < kRelease) << i;
    if (!clutched)
      continue;
    if (i >= kPress + kFadeOut) {
      ASSERT_EQ(force(commands[i]), 0.0) << i;
    }
    ASSERT_LT(force(commands[i - 1]) - force(commands[i]), 0.02 * force(commands[kPress - 1])) << i;
    ASSERT_EQ(contacts[i].tool_pose.position.z, contacts[kPress].tool_pose.position.z) << i;
    ASSERT_GT(contacts[i].surface_hits, 0U)
        << "what is shown stays true: the tool stands in the plane";
  }
  // It fades in over 0.2 s. When the hand yields by a step of its encoder, the damping answers with
  // 0.05 N at most, for some samples.
  const double before = force(commands[kPress - 1]);
  EXPECT_TRUE(commands[kRelease].status & msg::force_command::kStatusRamping);
  std::size_t still = 20, looked_at = 0;
  for (std::size_t i = kRelease; i < kRelease + 50; ++i) {
    still =
        contacts[i].tool_pose.position.z == contacts[i - 1].tool_pose.position.z ? still + 1 : 0;
    looked_at += still >= 20;
    ASSERT_LT(std::abs(force(commands[i]) - force(commands[i - 1])),
              still >= 20 ? 0.02 * before : 0.05)
        << i;
  }
  EXPECT_GT(looked_at, 25U) << "or nothing is shown";
  EXPECT_GT(force(commands.back()), 0.02) << "displayed again";
}

}  // namespace
}  // namespace voxtouch::test
