#include "devices/registry.hpp"

#include <gtest/gtest.h>

namespace voxtouch {
namespace {

std::string refusal(std::string_view name, const DeviceOptions& options = {}) {
  try {
    open_device(name, options);
  } catch (const DeviceOpenError& error) {
    return error.what();
  }
  return "";
}

TEST(Registry, OpensTheSimulatedDevicesByName) {
  for (const char* name : {"sim-phantom", "sim-lwr"}) {
    const std::unique_ptr<Driver> device = open_device(name);
    EXPECT_EQ(device->description().model, name);
    EXPECT_EQ(describe_device(name).model, name);
    EXPECT_TRUE(device->simulated());
    EXPECT_TRUE(device->read(std::chrono::microseconds(0))->pose.position.isZero(0.0));
  }
}

TEST(Registry, SaysWhatWasTriedAndWhatToDoWhereTheHardwareIsNotThere) {
  const std::string phantom = refusal("phantom");
  EXPECT_NE(phantom.find("libHD.so.3.4"), std::string::npos) << phantom;
  EXPECT_NE(phantom.find("Install OpenHaptics"), std::string::npos) << phantom;
  EXPECT_NE(phantom.find("wire-phantom"), std::string::npos) << phantom;
  const std::string lwr = refusal("lwr");
  EXPECT_NE(lwr.find("49938"), std::string::npos) << lwr;
  EXPECT_NE(lwr.find("friOpen"), std::string::npos) << lwr;
  EXPECT_NE(lwr.find("wire-lwr"), std::string::npos) << lwr;
}

TEST(Registry, ListsTheKnownNamesForAnUnknownOne) {
  EXPECT_EQ(refusal("omni"),
            "device 'omni' is unknown; known are sim-phantom, sim-lwr, wire-phantom, wire-lwr, phantom, lwr");
  EXPECT_EQ(device_names().size(), 6U);
}

TEST(Registry, PassesHandMotionAndSeedOn) {
  DeviceOptions options;
  options.hand = usual_hand("sim-lwr");
  EXPECT_EQ(options.hand->mass_kg, 1.3);
  options.hand->tremor_n = 10.0;  // well over the friction
  options.motion.emplace().path = {Vec3(0.1, 0.2, 0.3)};
  const auto after = [&](std::uint64_t seed) {
    options.seed = seed;
    const auto device = open_device("sim-lwr", options);
    for (int i = 0; i < 300; ++i) device->write({});
    return device->read(std::chrono::microseconds(0))->pose.position;
  };
  EXPECT_NEAR(after(1).z(), 0.3, 0.05);
  EXPECT_EQ(after(1), after(1));
  EXPECT_NE(after(1), after(2));
}

TEST(Registry, TurnsBadOptionsIntoOneSentence) {
  DeviceOptions options;
  options.motion.emplace();
  EXPECT_EQ(refusal("sim-lwr", options),
            "device 'sim-lwr' cannot be opened: simulated device: the motion has no way point; give it at least one");
}

}  // namespace
}  // namespace voxtouch
