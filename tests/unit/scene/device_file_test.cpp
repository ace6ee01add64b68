#include "core/scene/device_file.hpp"

#include "core/coupling/design/loop_parts.hpp"
#include "core/scene/device_figures.hpp"
#include "core/scene/device_workspace.hpp"
#include "core/scene/keys.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <vector>

#include "tests/support/facts.hpp"

namespace voxtouch::scene {
namespace device_file_test {

const std::string kArm = R"(device: third
rate_hz: 2000
max_force_n: 150
max_torque_nm: 15
max_stiffness_n_per_m: 5000
mass_kg: [3, 6]
damping_ns_per_m: 30
coulomb_friction_n: 2.5
position_resolution_m: 2e-5
delay_s: 0.002
force_bandwidth_hz: 53
rotation: {inertia_kg_m2: [0.1, 0.2], damping_nms_per_rad: 0.3, coulomb_friction_nm: 0.25, orientation_resolution_rad: 1e-4, max_stiffness_nm_per_rad: 300}
jitter: 0.4
consecutive_losses: 3
grip: arm
)";

std::string changed(const std::string& from, const std::string& to) {
  std::string text = kArm;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(DeviceFile, EveryKeyReachesItsField) {
  const DeviceFile file = parse_device_file(kArm, "arm.yaml");
  EXPECT_EQ(validate(file.description), "");
  const coupling::design::DeviceModel m = coupling::design::model_of(file.description);
  EXPECT_EQ(m.name, "third");
  EXPECT_EQ(m.grip, coupling::design::Grip::kArm);
  EXPECT_EQ(m.timing.period_s, 0.0005);
  EXPECT_EQ(m.timing.delay_s, 0.002);
  EXPECT_EQ(m.timing.jitter, 0.4);
  EXPECT_EQ(m.timing.consecutive_losses, 3);
  EXPECT_EQ(m.translation.max_effort, 150);
  EXPECT_EQ(m.translation.max_stiffness, 5000);
  EXPECT_EQ(m.translation.inertia_min, 3);
  EXPECT_EQ(m.translation.inertia_max, 6);
  EXPECT_EQ(m.translation.damping, 30);
  EXPECT_EQ(m.translation.coulomb_friction, 2.5);
  EXPECT_EQ(m.translation.resolution, 2e-5);
  EXPECT_EQ(m.translation.effort_bandwidth_hz, 53);
  EXPECT_TRUE(m.gives_torque);
  EXPECT_EQ(m.rotation.max_effort, 15);
  EXPECT_EQ(m.rotation.max_stiffness, 300);
  EXPECT_EQ(m.rotation.inertia_min, 0.1);
  EXPECT_EQ(m.rotation.inertia_max, 0.2);
  EXPECT_EQ(m.rotation.damping, 0.3);
  EXPECT_EQ(m.rotation.coulomb_friction, 0.25);
  EXPECT_EQ(m.rotation.resolution, 1e-4);
  EXPECT_EQ(m.rotation.effort_bandwidth_hz, 53) << "force and torque go through the same motors";
}

TEST(DeviceFile, MayLeaveTheBandwidthOut) {
  EXPECT_TRUE(std::isinf(parse_device_file(changed("force_bandwidth_hz: 53\n", ""), "a.yaml")
                             .description.force_bandwidth_hz));
}

TEST(DeviceFile, OfAllShippedExamplesIsRead) {
  int read = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(VOXTOUCH_DEPLOY) / "devices")) {
    if (entry.path().extension() != ".yaml")
      continue;  // the folder also holds pages and rules for a lab
    const DeviceFile file = load_device_file(entry.path());
    EXPECT_EQ(validate(file.description), "") << entry.path();
    EXPECT_TRUE(file.workspace_m) << entry.path();
    ++read;
  }
  EXPECT_GE(read, 13);
  const coupling::design::DeviceModel premium = coupling::design::model_of(
      load_device_file(std::string(VOXTOUCH_DEPLOY) + "/devices/premium_3.yaml").description);
  EXPECT_EQ(premium.translation.max_effort, 22);
  EXPECT_EQ(premium.translation.max_stiffness, 1000);
  EXPECT_FALSE(premium.gives_torque);
  EXPECT_EQ(premium.grip, coupling::design::Grip::kPen);
}

/// One change to a good file; '^' marks the place that the error must name and is taken out.
struct Bad {
  const char* from;
  const char* to;
  const char* facts;  ///< of the sentence, as `missing_fact` has them
};

const std::vector<Bad> kBad = {
    {"rate_hz: 2000", "^rate: 2000", "'rate_hz'"},
    {"grip: arm", "grip: arm\n^max_force_rate_n_per_s: 1", "'device file'"},
    {"grip: arm", "grip: arm\n^jitter: 1", "'jitter'"},
    {"device: third", "device: ^''", "'device'"},
    {"2000", "^0", "'rate_hz'|1 or above"},
    {"2000", "^0.5", "'rate_hz'|1 or above"},
    {"2000", "^2e5", "1 to 100000."},
    {"2000", "^1 kHz", "'rate_hz'|a number"},
    {"150", "^0", "'max_force_n'|above 0"},
    {"150", "^.inf", "finite"},
    {"max_torque_nm: 15", "max_torque_nm: ^-1", "'max_torque_nm' is -1"},
    {"5000", "^0", "'max_stiffness_n_per_m' is 0"},
    {"[3, 6]", "^[6, 3]", "'mass_kg'|[6, 3]"},
    {"[3, 6]", "^[0, 3]", "'mass_kg'|above 0"},
    {"[3, 6]", "^0", "'mass_kg'|above 0"},
    {"[3, 6]", "^heavy", "'mass_kg'|'heavy'"},
    {"grip: arm", "grip: arm\nworkspace_m: ^0.4", "'workspace_m'|'0.4'|[x, y, z]|list of 3"},
    {"grip: arm", "grip: arm\nworkspace_m: ^[0.4, 0, 0.4]", "'workspace_m'|above 0"},
    {"[3, 6]", "^[3, 4, 6]", "[low, high]"},
    {"damping_ns_per_m: 30", "damping_ns_per_m: ^-30", "0 or above"},
    {"coulomb_friction_n: 2.5", "coulomb_friction_n: ^-1", "0 or above"},
    {"2e-5", "^0.02", "'position_resolution_m'|0 to 0.01."},
    {"2e-5", "^-1", "0 or above"},
    {"delay_s: 0.002", "delay_s: ^2", "'delay_s'|0 to 1."},
    {"delay_s: 0.002", "delay_s: ^-0.001", "0 or above"},
    {"force_bandwidth_hz: 53", "force_bandwidth_hz: ^0", "'force_bandwidth_hz' is 0"},
    {"jitter: 0.4", "jitter: ^20", "'jitter'|0 to 10."},
    {"jitter: 0.4", "jitter: ^-0.1", "0 or above"},
    {"consecutive_losses: 3", "consecutive_losses: ^-1", "whole number"},
    {"consecutive_losses: 3", "consecutive_losses: ^1.5", "whole number"},
    {"consecutive_losses: 3", "consecutive_losses: ^1001", "'consecutive_losses'|0 to 1000."},
    {"grip: arm", "grip: ^fist", "'grip'|'fist'|pen, arm"},
    {"max_torque_nm: 15", "max_torque_nm: 0", "'rotation'|'max_torque_nm'"},
    {"rotation: {", "rotation: ^1 #", "'rotation'|inertia_kg_m2,"},
    {"[0.1, 0.2]", "^[0, 0.2]", "'inertia_kg_m2' starts at 0"},
    {"[0.1, 0.2]", "^[0.3, 0.2]", "'inertia_kg_m2' is [0.3, 0.2]"},
    {"damping_nms_per_rad: 0.3", "damping_nms_per_rad: ^-1", "0 or above"},
    {"coulomb_friction_nm: 0.25", "coulomb_friction_nm: ^-1", "0 or above"},
    {"orientation_resolution_rad: 1e-4", "orientation_resolution_rad: ^1",
     "'orientation_resolution_rad'|0 to 0.1."},
    {"max_stiffness_nm_per_rad: 300", "max_stiffness_nm_per_rad: ^0",
     "'max_stiffness_nm_per_rad' is 0"},
    {"max_stiffness_nm_per_rad: 300", "^max_stiffness: 300", "'max_stiffness_nm_per_rad'"},
    {"rate_hz: 2000", "rate_hz: ^!!int 2000", "Tags"},
    {"rate_hz: 2000", "rate_hz: ^&a 2000", "Anchors"},
};

/// Names the place of `mark` in `text` as messages do.
std::string head_at(const std::string& text, std::size_t mark) {
  SourcePlace place{1, 1};
  for (std::size_t i = 0; i < mark; ++i) {
    ++place.column;
    if (text[i] == '\n')
      ++place.line, place.column = 1;
  }
  return at_place("arm.yaml", place, "");
}

TEST(DeviceFile, ReportsErrorsWithTheirPlace) {
  for (const Bad& bad : kBad) {
    std::string text = changed(bad.from, bad.to);
    const std::size_t mark = text.find('^');
    if (mark != std::string::npos)
      text.erase(mark, 1);
    const std::string head =
        head_at(text, mark == std::string::npos ? text.find("rotation") : mark);
    try {
      parse_device_file(text, "arm.yaml");
      ADD_FAILURE() << "was accepted: " << bad.to;
    } catch (const SceneError& error) {
      const std::string said = error.what();
      EXPECT_TRUE(said.starts_with(head))
          << bad.to << "\n  wanted " << head << "\n  got    " << said;
      EXPECT_EQ(test::missing_fact(said, bad.facts), "") << bad.to << "\n  " << said;
      EXPECT_TRUE(said.ends_with('.') || said.ends_with('?')) << said;
    }
  }
}

std::string refusal_of(const std::string& text) {
  try {
    parse_device_file(text, "arm.yaml");
  } catch (const SceneError& error) {
    return error.sentence();
  }
  return "accepted";
}

TEST(DeviceFile, ListsAllMissingKeysWithRangeAndMeaning) {
  const std::string said = refusal_of("device: third\ngrip: pen\n");
  EXPECT_TRUE(said.starts_with("6 keys ") &&
              said.contains("\n  rate_hz: 500 to 4000 Hz (stylus), 200 to 1000 Hz (arm)"))
      << said;
  for (const char* key : {"max_force_n", "max_torque_nm", "max_stiffness_n_per_m", "mass_kg",
                          "position_resolution_m"})
    EXPECT_NE(said.find(std::string("\n  ") + key + ": "), std::string::npos) << key << "\n"
                                                                              << said;
  EXPECT_EQ(said.find("delay_s"), std::string::npos) << "has a standard";
  EXPECT_TRUE(refusal_of(changed("mass_kg: [3, 6]\n", "")).contains("\n  mass_kg: 0.03 to 0.3 kg"))
      << said;
}

TEST(DeviceFile, FillsGapsFromTheClassAndReportsThem) {
  const std::string sheet =
      "rate_hz: 1000\nmax_force_n: 5\nmax_torque_nm: 1\nmax_stiffness_n_per_m: "
      "900\nposition_resolution_m: 1e-5\n";
  const DeviceFile pen =
      parse_device_file("device: p\ngrip: pen\nmass_kg: 0.25\n" + sheet, "a.yaml");
  EXPECT_EQ(pen.description.mass_min_kg, 0.25);
  EXPECT_EQ(pen.description.mass_max_kg, 0.25);
  EXPECT_EQ(pen.description.damping_ns_per_m, 0.005);
  EXPECT_EQ(pen.description.delay_s, 0.001);
  EXPECT_EQ(pen.description.jitter, 0.2);
  EXPECT_EQ(pen.description.consecutive_losses, 1U);
  EXPECT_EQ(pen.description.max_stiffness_nm_per_rad, 0.3);
  EXPECT_EQ(pen.description.output_dof, 6U);
  EXPECT_EQ(pen.assumed.size(), 10U);
  EXPECT_TRUE(assumed_sentence(pen).contains("stylus: delay_s 0.001, ")) << assumed_sentence(pen);
  const DeviceFile arm = parse_device_file(
      "device: a\ngrip: arm\nmass_kg: 2\nrotation: {inertia_kg_m2: 0.2}\n" + sheet, "a.yaml");
  EXPECT_EQ(arm.description.delay_s, 0.002);
  EXPECT_EQ(arm.description.inertia_max_kg_m2, 0.2);
  EXPECT_EQ(arm.assumed.size(), 9U);
  EXPECT_EQ(assumed_sentence(parse_device_file(kArm, "a.yaml")), "");
  for (const DeviceFile* file : {&pen, &arm})
    EXPECT_EQ(validate(file->description), "");
}

TEST(DeviceFile, ReadsEveryKeyOfItsOwnDocumentation) {
  for (const Key& key : keys::device_file.keys) {
    if (key.kind == KeyKind::kMap || key.name == "workspace_m" || key.name == "force_bandwidth_hz")
      continue;
    EXPECT_EQ(device_figure(key.name).pen_standard.has_value(), key.rule == KeyRule::kOptional)
        << key.name;
  }
  for (const Key& key : keys::device_rotation.keys)
    EXPECT_TRUE(device_figure(key.name).arm_standard) << key.name;
}

TEST(DeviceFile, ReportsWhereAMotionLeavesTheWorkspace) {
  Motion motion;
  motion.path = {Vec3(0, 0, 0), Vec3(0.1, 0, 0)};
  EXPECT_EQ(beyond_workspace(motion, {0.1, 0.05, 0.05}, "d"), "");
  const std::string beyond = beyond_workspace(motion, {0.05, 0.05, 0.05}, "d");
  for (const char* fact :
       {" 0.1 x 0 x 0 m, ", " d is 0.05 x 0.05 x 0.05 m", "position_scale", "factor of 2"})
    EXPECT_TRUE(beyond.contains(fact)) << beyond;
  motion.circle_centre = Vec3(0.1, 0.1, 0);  // a circle of 0.1 m about it
  EXPECT_EQ(beyond_workspace(motion, {0.3, 0.3, 0.1}, "d"), "");
  EXPECT_NE(beyond_workspace(motion, {0.3, 0.15, 0.1}, "d"), "");
}

TEST(DeviceFile, OfAnotherDeviceIsNamed) {
  const std::string measured = kArm + "measured: {date: 2026-11-29, command: c, serial: '7'}\n";
  const DeviceFile file = parse_device_file(measured, "a.yaml");
  const DeviceDescription own = file.description;
  EXPECT_EQ(other_device(file, own, "7"), "");
  EXPECT_EQ(other_device(file, own, ""), "") << "the driver reports no serial number";
  EXPECT_TRUE(other_device(file, own, "8").contains("serial number '7', this one has '8'"));
  EXPECT_EQ(other_device(parse_device_file(kArm, "a.yaml"), own, "8"), "");
  const auto differs = [&](auto change) {
    DeviceDescription other = own;
    change(other);
    return !other_device(file, other, "7").empty();
  };
  EXPECT_TRUE(differs([](DeviceDescription& d) { d.model = "fourth"; }));
  EXPECT_TRUE(differs([](DeviceDescription& d) { d.rate_hz = 1000; }));
  EXPECT_TRUE(differs([](DeviceDescription& d) { d.grip = "pen"; }));
  EXPECT_TRUE(differs([](DeviceDescription& d) { d.max_torque_nm = 0; }));
  EXPECT_FALSE(differs([](DeviceDescription& d) { d.rate_hz *= 1.005; }));
  EXPECT_FALSE(differs([](DeviceDescription& d) { d.mass_min_kg = 1; }));
}

TEST(DeviceFile, MeasuredFiguresKeepTheDriversLimits) {
  const DeviceFile file = parse_device_file(kArm, "a.yaml");
  DeviceDescription driver = file.description;
  driver.max_force_n = 100, driver.mass_min_kg = 1, driver.max_stiffness_n_per_m = 4000;
  driver.simulated = false;
  const DeviceDescription d = measured_device(file, driver);
  EXPECT_EQ(d.max_force_n, 100);
  EXPECT_EQ(d.max_stiffness_n_per_m, 4000);
  EXPECT_EQ(d.mass_min_kg, 3);
  EXPECT_EQ(validate(d), "");
  EXPECT_NEAR(coupling::design::model_of(d).timing.delay_s, 0.002, 1e-12)
      << "the period that a command may wait is a part of the file's delay";
}

TEST(DeviceFile, IsAFileWithADeviceInIt) {
  const auto refusal = [](const std::filesystem::path& file) -> std::string {
    try {
      load_device_file(file);
    } catch (const SceneError& error) {
      return error.sentence();
    }
    return "accepted";
  };
  EXPECT_NE(refusal("/nonexistent/third.yaml"), "accepted");
  EXPECT_TRUE(refusal(std::filesystem::temp_directory_path()).contains("folder"));
  EXPECT_THROW(parse_device_file("", "a.yaml"), SceneError);
  EXPECT_THROW(parse_device_file("just words", "a.yaml"), SceneError);
  EXPECT_THROW(parse_device_file("scene: cup\n", "a.yaml"), SceneError);
}

}  // namespace device_file_test
}  // namespace voxtouch::scene
