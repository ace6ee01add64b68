#include "devices/operator/hand_file.hpp"

#include <gtest/gtest.h>

#include <clocale>
#include <limits>
#include <locale>

#include "devices/operator/hand.hpp"

namespace voxtouch::lwr_sim {
namespace {

hand::HandFile sample() {
  hand::HandFile f;
  f.motion.path = {Vec3(0.1, -1.0 / 3.0, 1e-300), Vec3(-0.538, 0.0, 0.384)};
  f.motion.speed_m_per_s = 0.07;
  f.motion.hold_s = 0.25;
  f.motion.repeat_from = 1;
  f.motion.circle_centre = Vec3(0.1, 0.2, 0.3);
  f.motion.circle_axis = Vec3(1.0, 2.0, 3.0).normalized();
  f.motion.orientation = Quat(0.1, 0.2, -0.3, 0.4).normalized();
  f.motion.turn = {Vec3(3.0, 2.0, 1.0).normalized(), -0.2, 0.1, 1.0 / 3.0};
  f.hand = *hand::grip("arm-firm");
  f.hand.release_time_s = 2.5;
  f.hand.tremor_n = 0.1;
  f.posture_rad = {0.1, 0.2, 0.3, -1.4, 0.5, 0.6, 1.0 / 7.0};
  f.seed = std::numeric_limits<std::uint64_t>::max();
  return f;
}

TEST(HandFile, RoundTripIsBitIdentical) {
  const hand::HandFile f = sample(), back = hand::parse_hand(hand::to_text(f), "test");
  EXPECT_EQ(hand::to_text(back), hand::to_text(f));
  EXPECT_EQ(back.motion.path, f.motion.path);
  EXPECT_EQ(back.motion.orientation.coeffs(), f.motion.orientation.coeffs());
  EXPECT_EQ(back.motion.circle_axis, f.motion.circle_axis);
  EXPECT_EQ(back.motion.turn.axis, f.motion.turn.axis);
  EXPECT_EQ(back.motion.turn.angle_rad, -0.2);
  EXPECT_EQ(back.motion.turn.from_s, 0.1);
  EXPECT_EQ(back.motion.turn.to_s, 1.0 / 3.0);
  EXPECT_EQ(*back.motion.circle_centre, *f.motion.circle_centre);
  EXPECT_EQ(back.motion.repeat_from, f.motion.repeat_from);
  EXPECT_EQ(back.posture_rad, f.posture_rad);
  EXPECT_EQ(back.seed, f.seed);
  EXPECT_EQ(back.hand.stiffness_n_per_m, f.hand.stiffness_n_per_m);
  EXPECT_EQ(back.hand.release_time_s, 2.5);
  EXPECT_EQ(back.hand.grip_change_time_s, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(back.hand.carries_tool);
}

TEST(HandFile, EveryFieldOfTheOperatorIsWritten) {
  // A new field of the struct changes its size, and must be added here.
  static_assert(sizeof(sim::OperatorConfig) == 13 * sizeof(double));
  const std::string plain = hand::to_text(sample());
  for (double sim::OperatorConfig::*field :
       {&sim::OperatorConfig::release_time_s, &sim::OperatorConfig::grip_change_time_s,
        &sim::OperatorConfig::grip_factor, &sim::OperatorConfig::mass_kg,
        &sim::OperatorConfig::damping_ns_per_m, &sim::OperatorConfig::stiffness_n_per_m,
        &sim::OperatorConfig::inertia_kg_m2, &sim::OperatorConfig::damping_nms_per_rad,
        &sim::OperatorConfig::stiffness_nm_per_rad, &sim::OperatorConfig::tremor_n,
        &sim::OperatorConfig::tremor_bandwidth_hz}) {
    hand::HandFile changed = sample();
    changed.hand.*field = 0.375;
    EXPECT_NE(hand::to_text(changed), plain);
    EXPECT_EQ(hand::parse_hand(hand::to_text(changed), "test").hand.*field, 0.375);
  }
}

TEST(HandFile, DoesNotDependOnTheLocale) {
  const std::string plain = hand::to_text(sample());
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  const char* c_locale = std::setlocale(LC_ALL, "de_DE.UTF-8");  // if the machine has it
  const std::string text = hand::to_text(sample());
  EXPECT_EQ(text, plain);
  EXPECT_EQ(hand::to_text(hand::parse_hand(text, "test")), plain);
  if (c_locale)
    std::setlocale(LC_ALL, "C");
  std::locale::global(before);
}

TEST(HandFile, OmittedKeysKeepTheirDefaults) {
  const hand::HandFile f = hand::parse_hand("# a hand\n\npath_m: [[1, 2,\t3]]  # here\r\n", "test");
  EXPECT_EQ(f.motion.path.front(), Vec3(1, 2, 3));
  EXPECT_EQ(f.motion.speed_m_per_s, Motion{}.speed_m_per_s);
  EXPECT_FALSE(f.motion.repeat_from);
  EXPECT_TRUE(f.posture_rad.empty());
  EXPECT_EQ(
      hand::parse_hand("path_m:\n  - [0, 0, 0]\nrelease_time_s: .inf\nreleased: true\n", "test")
          .hand.release_time_s,
      std::numeric_limits<double>::infinity());
}

TEST(HandFile, RefusesErrorsWithTheirPlace) {
  const std::string head = "path_m: [[0, 0, 0]]\n";
  const auto message = [](const std::string& text) -> std::string {
    try {
      hand::parse_hand(text, "file");
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "taken";
  };
  EXPECT_EQ(message(head), "taken");
  for (const char* line : {"speed: 1",
                           "speed_m_per_s",
                           "speed_m_per_s:",
                           "speed_m_per_s: [1, 2]",
                           "speed_m_per_s: 1x",
                           "speed_m_per_s: 1,5",
                           "speed_m_per_s: nan",
                           "speed_m_per_s: .nan",
                           "speed_m_per_s: {a: 1}",
                           "circle_centre_m: [1, 2]",
                           "circle_centre_m: [[1], 2, 3]",
                           "orientation_wxyz: [1, 1, 0, 0]",
                           "released: yes",
                           "released: [true]",
                           "repeat_from: -1",
                           "repeat_from: 1.5",
                           "seed: 18446744073709551616",
                           "seed: -1",
                           "hold_s: 1\nhold_s: 1",
                           "format: voxtouch-hand-1",
                           "posture_rad: [1, a]",
                           "posture_rad: 1",
                           "? [1]\n: 2",
                           "hold_s: 'x",
                           "hold_s: *none"})
    EXPECT_TRUE(message(head + line).starts_with("file:2:") ||
                message(head + line).starts_with("file:3:"))
        << line << ": " << message(head + line);
  EXPECT_TRUE(message(head + "hold_s:  x").starts_with("file:2:10: 'x'"));
  EXPECT_TRUE(message(head + "hold_s: 1\nspeed: 1").starts_with("file:3:1: ") &&
              message(head + "hold_s: 1\nspeed: 1").contains("'speed'"));
  EXPECT_NE(message("hold_s: 1").find("path_m"), std::string::npos);
  for (const char* text :
       {"", "path_m", "- path_m", "path_m: [[0, 0, 0]]\n---\nspeed: 1\n",
        "path_m: [[0, 0, 0]]\n...\nspeed: 1\n", "{path_m: [[0, 0, 0]]}\n{speed: 1}\n"})
    EXPECT_NE(message(text).find("one map"), std::string::npos) << text;
  EXPECT_NE(message(",\x9a\nv=0,n\xcbn,\x9a"
                    "1"),
            "taken")
      << "what yaml-cpp takes for documents without end";
  EXPECT_NE(message(head + "mass_kg: -1").find("mass_kg"), std::string::npos);
  EXPECT_THROW(hand::read_hand("/nonexistent/hand"), std::runtime_error);
}

}  // namespace
}  // namespace voxtouch::lwr_sim
