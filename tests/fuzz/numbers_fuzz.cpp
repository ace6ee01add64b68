// Numbers and files of a command line: the rest after the first byte, read as one of them. An
// accepted value is finite and in its range, and a hand's file reads back unchanged.
#include <sstream>

#include "devices/driver.hpp"
#include "devices/operator/hand_file.hpp"
#include "devices/settings.hpp"
#include "nodes/cli/probe/pose_csv.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace voxtouch;

void settings(const std::string& text) try {
  const devices::DeviceSettings read = devices::parse_settings({text});
  const devices::SettingReader reader("fuzz", read, {"n", "w", "p", "v"});
  if (const auto n = reader.number("n", -1e6, 1e6))
    FUZZ_REQUIRE(std::abs(*n) <= 1e6);
  if (const auto p = reader.whole("p", 1, 65535))
    FUZZ_REQUIRE(*p > 0 && *p <= 65535);
  if (const auto v = reader.vector("v"))
    FUZZ_REQUIRE(v->allFinite());
  (void)reader.whole("w", 0, 0xffffffffU);
} catch (const devices::DeviceOpenError&) {
}

void poses(const std::string& text) try {
  std::istringstream in(text);
  for (const Pose& pose : cli::read_poses(in, "fuzz.csv"))
    FUZZ_REQUIRE(pose.finite() && std::abs(pose.orientation.norm() - 1.0) < 1e-9);
} catch (const std::runtime_error& refused) {
  FUZZ_REQUIRE(std::string_view(refused.what()).starts_with("fuzz.csv"));
}

void hand_file(const std::string& text) try {
  const hand::HandFile read = hand::parse_hand(text, "fuzz.hand");
  const std::string written = hand::to_text(read);
  FUZZ_REQUIRE(hand::to_text(hand::parse_hand(written, "again")) == written);
  for (const double time_s : {0.0, 0.5, 1e6}) {
    const MotionPoint point = motion_at(read.motion, time_s);
    FUZZ_REQUIRE(point.position.allFinite() && point.velocity.allFinite());
  }
} catch (const std::runtime_error& refused) {
  FUZZ_REQUIRE(refused.what()[0] != '\0' && std::string_view(refused.what()).find("again") != 0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes in(data, size);
  const auto choice = in.take<std::uint8_t>();
  const std::string text(in.rest());
  switch (choice % 3) {
    case 0:
      settings(text);
      break;
    case 1:
      poses(text);
      break;
    default:
      hand_file(text);
      break;
  }
  return 0;
}
