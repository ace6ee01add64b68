#include "devices/registry.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include "devices/arm/udp_socket.hpp"
#include "devices/settings.hpp"

namespace voxtouch::devices {
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

// Before any test that loads the simulated library: a process keeps the first one that it loaded.
TEST(Registry, ListsTriedPhantomLibrariesAndWhatToInstall) {
  for (const char* name : {"libHD.so", "libHD.so.3.4", "libHD.so.3.0"})
    if (dlopen(name, RTLD_LAZY) != nullptr)
      GTEST_SKIP() << "a test must not start a device that may be there";
  const auto begin = std::chrono::steady_clock::now();
  const std::string said = refusal("phantom");
  EXPECT_EQ(said.find("device 'phantom': "), 0U) << said;
  EXPECT_NE(said.find("libHD.so.3.4"), std::string::npos) << said;
  EXPECT_NE(said.find("Install OpenHaptics"), std::string::npos) << said;
  EXPECT_NE(said.find("--device emulated-phantom"), std::string::npos) << said;
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
}

TEST(Registry, ReportsTheAwaitedRobotPortAndWhatToSet) {
  DeviceOptions options;
  const std::string port = std::to_string(arm::UdpSocket("127.0.0.1", 0).local().port);
  options.settings = {{"address", "127.0.0.1"}, {"port", port}, {"connect_timeout_s", "0.2"}};
  const std::string said = refusal("lwr", options);
  EXPECT_NE(said.find("UDP 127.0.0.1:" + port), std::string::npos) << said;
  EXPECT_NE(said.find("friSetup"), std::string::npos) << said;
  EXPECT_NE(said.find("--device emulated-lwr"), std::string::npos) << said;
}

TEST(Registry, ReportsTheRequestedRobotAndWhatToDo) {
  DeviceOptions options;
  options.settings = {{"address", "127.0.0.1"}, {"port", "1"}};
  const std::string said = refusal("fr3", options);
  EXPECT_NE(said.find("TCP 127.0.0.1:1"), std::string::npos) << said;
  EXPECT_NE(said.find("FCI"), std::string::npos) << said;
  EXPECT_NE(said.find("--device emulated-fr3"), std::string::npos) << said;
}

TEST(Registry, OpensEmulatedDevicesAtTheHandsPose) {
  for (const char* name : {"emulated-phantom", "emulated-lwr", "emulated-fr3"}) {
    DeviceOptions options;
    options.lockstep = true;
    options.motion.emplace().path = {Vec3(-0.07, -0.03, 0.02)};
    const std::unique_ptr<Driver> device = open_device(name, options);
    EXPECT_TRUE(device->simulated()) << name;
    DeviceSample sample;
    for (int i = 0; i < 500; ++i) {
      const auto read = device->read(std::chrono::milliseconds(10));
      ASSERT_TRUE(read) << name << ": " << device->last_error();
      sample = *read;
      ASSERT_TRUE(device->write({})) << name << ": " << device->last_error();
    }
    EXPECT_EQ(sample.time_ns, 499'000'000);
    EXPECT_LT((sample.pose.position - options.motion->path[0]).norm(), 0.003)
        << name << sample.pose.position.transpose();
    EXPECT_LT(sample.pose.orientation.angularDistance(Quat::Identity()), 0.03) << name;
    EXPECT_EQ(device->last_error(), "") << name;
  }
}

TEST(Registry, DescribesEmulatorsAsTheyDoOnceOpen) {
  for (const char* name : {"emulated-phantom", "emulated-lwr", "emulated-fr3"}) {
    DeviceOptions options;
    options.lockstep = true;
    const DeviceDescription before = describe_device(name),
                            open = open_device(name, options)->description();
    EXPECT_EQ(before.model, open.model);
    EXPECT_NEAR(before.rate_hz, open.rate_hz, 1e-6);
    EXPECT_NEAR(before.max_force_n, open.max_force_n, 1e-9) << name;
    EXPECT_NEAR(before.max_stiffness_n_per_m, open.max_stiffness_n_per_m, 1e-9) << name;
    EXPECT_NEAR(before.delay_s, open.delay_s, 1e-9);
    EXPECT_EQ(before.mass_min_kg, open.mass_min_kg);
    EXPECT_EQ(before.output_dof, open.output_dof);
  }
}

TEST(Registry, PlacesTheDevicesRestAsConfigured) {
  for (const char* name : {"emulated-phantom", "emulated-lwr", "emulated-fr3"}) {
    DeviceOptions options;
    options.lockstep = true;
    options.settings = {{"rest", "1,2,-0.5"}};
    options.motion.emplace().path = {Vec3(1.0, 2.0, -0.5)};
    const auto device = open_device(name, options);
    const auto sample = device->read(std::chrono::milliseconds(10));
    ASSERT_TRUE(sample) << name;
    EXPECT_LT((sample->pose.position - Vec3(1.0, 2.0, -0.5)).norm(), 2e-3) << name;
  }
}

TEST(Registry, DescribesHardwareWithoutOpeningIt) {
  EXPECT_EQ(describe_device("lwr").model, "lwr");
  EXPECT_EQ(describe_device("lwr").rate_hz, 1000.0);
  EXPECT_EQ(describe_device("phantom").model, "Phantom");
  EXPECT_GT(describe_device("phantom").max_force_n, 1.0);
  EXPECT_FALSE(has_simulated_hand("phantom"));
  EXPECT_TRUE(has_simulated_hand("emulated-phantom"));
  EXPECT_THROW(usual_hand("lwr"), DeviceOpenError);
}

TEST(Registry, RefusesUnknownSettingsAndListsTheValid) {
  const auto with = [](const char* name, DeviceSettings settings) {
    DeviceOptions options;
    options.settings = std::move(settings);
    const std::string said = refusal(name, options);
    try {
      describe_device(name, options);
      ADD_FAILURE() << name << " describes itself with settings that it refuses";
    } catch (const DeviceOpenError&) {
    }
    return said;
  };
  const auto names = [](const std::string& said, std::initializer_list<const char*> all) {
    return std::ranges::all_of(all, [&](const char* name) { return said.contains(name); });
  };
  EXPECT_TRUE(names(with("sim-lwr", {{"port", "1"}}), {"'sim-lwr'", "'port'"}));
  EXPECT_TRUE(names(with("emulated-lwr", {{"prot", "1"}}),
                    {"'emulated-lwr'", "'prot'", "period_ms, rest, tool, capture, trace, fault"}));
  EXPECT_NE(with("lwr", {{"port", "0"}}).find("port is '0'"), std::string::npos);
  EXPECT_NE(with("lwr", {{"port", "1"}, {"port", "2"}}).find("port"), std::string::npos);
  EXPECT_NE(with("lwr", {{"rest", "1,2"}}).find("X,Y,Z"), std::string::npos);
  EXPECT_NE(with("lwr", {{"rest", "1,2,3,4"}}).find("X,Y,Z"), std::string::npos);
  EXPECT_NE(with("lwr", {{"rest", "1,nan,3"}}).find("X,Y,Z"), std::string::npos);
  EXPECT_NE(with("lwr", {{"connect_timeout_s", "x"}}).find("connect_timeout_s"), std::string::npos);
  EXPECT_NE(with("lwr", {{"connect_timeout_s", "nan"}}).find("[0, 3600]"), std::string::npos);
  EXPECT_NE(with("lwr", {{"controller", "krc"}}).find("IPv4"), std::string::npos);
  EXPECT_NE(with("emulated-lwr", {{"period_ms", "0"}}).find("[1, 100]"), std::string::npos);
  EXPECT_NE(with("fr3", {{"address", "robot"}}).find("IPv4"), std::string::npos);
  EXPECT_NE(
      with("emulated-fr3", {{"address", "127.0.0.1"}}).find("rest, tool, server_version, fault"),
      std::string::npos);
  EXPECT_NE(with("phantom", {{"encoder_reset", "perhaps"}}).find("if_needed"), std::string::npos);
  EXPECT_NE(with("phantom", {{"max_force_n", "-1"}}).find("max_force_n"), std::string::npos);
  EXPECT_NE(with("phantom", {{"rate_hz", "7"}}).find("[100, 10000]"), std::string::npos);
  EXPECT_NE(with("phantom", {{"rest", "0,11,0"}}).find("within 10 m"), std::string::npos);
  EXPECT_NE(with("emulated-phantom", {{"fault", "earthquake@1"}}).find("comm_error"),
            std::string::npos);
  EXPECT_NE(with("emulated-phantom", {{"fault", "comm_error@soon"}}).find("KIND@SECONDS"),
            std::string::npos);
  EXPECT_NE(with("emulated-phantom", {{"model", "novint"}}).find("omni"), std::string::npos);
  EXPECT_THROW(parse_settings({"port"}), DeviceOpenError);
  EXPECT_EQ(parse_settings({"name=a=b"}).front().second, "a=b");
}

TEST(Registry, ReportsAnUnreachableHandAndLeavesNoEmulator) {
  for (const char* name : {"emulated-phantom", "emulated-lwr", "emulated-fr3"}) {
    DeviceOptions options;
    options.lockstep = true;
    options.motion.emplace().path = {Vec3(5.0, 0.0, 0.0)};
    const std::string said = refusal(name, options);
    EXPECT_NE(said.find("reach"), std::string::npos) << said;
    options.motion->path = {Vec3::Zero()};
    EXPECT_EQ(refusal(name, options), "") << "and then it opens";
  }
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "a child is left";
}

TEST(Registry, PassesOnTheEmulatorsErrorsAboutItsOptions) {
  DeviceOptions options;
  options.settings = {{"fault", "earthquake@1"}};
  const std::string said = refusal("emulated-lwr", options);
  EXPECT_NE(said.find("status 1"), std::string::npos) << said;
  EXPECT_NE(said.find("earthquake"), std::string::npos) << said;
}

TEST(Registry, InjectsEmulatorFaultsOnTime) {
  for (const auto& [name, fault] :
       {std::pair{"emulated-phantom", "comm_error@0.1"},
        std::pair{"emulated-lwr", "drive_error@0.3"}, std::pair{"emulated-fr3", "reflex@0.2"}}) {
    DeviceOptions options;
    options.lockstep = true;
    options.settings = {{"fault", fault}};
    const auto device = open_device(name, options);
    int good = 0;
    while (good < 1000 && device->read(std::chrono::milliseconds(10)) && device->write({}))
      ++good;
    EXPECT_GT(good, 90) << name;
    EXPECT_LT(good, 400) << name;
    EXPECT_NE(device->last_error(), "") << name;
  }
}

TEST(Registry, ListsTheKnownNamesForAnUnknownOne) {
  for (const char* name :
       {"'omni'",
        "sim-phantom, sim-lwr, emulated-phantom, emulated-lwr, emulated-fr3, phantom, lwr, fr3,",
        "sim:FILE"})
    EXPECT_TRUE(refusal("omni").contains(name)) << name;
  EXPECT_EQ(device_names().size(), 8U);
}

TEST(Registry, PassesOnHandMotionAndSeed) {
  DeviceOptions options;
  options.hand = usual_hand("sim-lwr");
  EXPECT_EQ(options.hand->mass_kg, 1.3);
  options.hand->tremor_n = 10.0;  // well over the friction
  options.motion.emplace().path = {Vec3(0.1, 0.2, 0.3)};
  const auto after = [&](std::uint64_t seed) {
    options.seed = seed;
    const auto device = open_device("sim-lwr", options);
    for (int i = 0; i < 300; ++i)
      device->write({});
    return device->read(std::chrono::microseconds(0))->pose.position;
  };
  EXPECT_NEAR(after(1).z(), 0.3, 0.05);
  EXPECT_EQ(after(1), after(1));
  EXPECT_NE(after(1), after(2));
}

TEST(Registry, ReportsBadOptionsInOneSentence) {
  DeviceOptions options;
  options.motion.emplace();
  const std::string said = refusal("sim-lwr", options);
  EXPECT_TRUE(said.starts_with("device 'sim-lwr' ") && said.contains("way point") &&
              !said.contains('\n'))
      << said;
}

}  // namespace
}  // namespace voxtouch::devices
