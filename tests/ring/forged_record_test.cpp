// An unauthorised writer writes a record of a change that the rendering never made, into a recorded
// ring: it is not in the bag, and the replay reports it.
#include <gtest/gtest.h>

#include <csignal>
#include <functional>
#include <optional>
#include <thread>

#include "nodes/bus/writer.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/strings.hpp"
#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

bool comes(const std::function<bool()>& holds) {
  for (int i = 0; i < 30'000 && !holds(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  return holds();
}

TEST(ForgedRecord, IsNotInTheBagAndReplayIsBitIdentical) {
  const TemporaryFolder folder;
  const bus::Participant participant(
      {static_cast<std::uint32_t>(std::stoul(fresh_domain())), "lo", "forger"});
  runtime::NodeRegistry registry(participant, "haptic");
  bus::Writer<msg::EffectChange> made(participant, qos::kEffectMade, "haptic",
                                      qos::profile(qos::kEffectMade.profile));
  const auto bag = folder / "bag";
  Process up(up_arguments(shipped_scene("cup_friction"),
                          {"--lockstep", "--motion", "slide", "--record", bag.string()}));
  const auto figure = [&](const std::string& node, const char* name) {
    registry.update();
    const auto report = registry.find(node);
    return report ? runtime::value_of(report->figures, name) : 0.0;
  };
  ASSERT_TRUE(comes([&] {
    return made.matched_count() > 0 && figure("rendering", "samples") > 1500;
  })) << up.err();
  // The forged record equals the ring's except for its writer.
  const std::string friction = "friction", none;
  msg::EffectChange forged{};
  forged.session_id = registry.find("rendering")->session_id, forged.from_sample = 700,
  forged.action = msg::effect_change::kActionSwitch;
  forged.effect = runtime::lend(friction), forged.parameter = forged.model = runtime::lend(none);
  made.write(forged);
  Process change(
      {VOXTOUCH_BIN "/voxtouch", "change", "friction", "gain", "0.5", "--domain", fresh_domain()});
  const Finished changed = change.wait();
  EXPECT_EQ(changed.status, 0) << changed.err;
  // Its status reports it, and is in the bag: the logger receives its own status first.
  ASSERT_TRUE(comes([&] {
    return figure("logger", "refused_records") == 1.0 && figure("rendering", "changes") == 1.0;
  })) << registry.find("logger")->message;
  up.signal(SIGINT);
  const Finished end = up.wait(std::chrono::seconds(120));
  EXPECT_EQ(end.status, 1) << "a second writer fails the run" << end.err;
  const auto summary = parse_summary(end.out);
  EXPECT_EQ(summary["recording"]["refused_records"], 1) << end.out;
  EXPECT_NE(summary["problems"].dump().find("1 records"), std::string::npos) << end.out;

  Process again({VOXTOUCH_BIN "/voxtouch", "replay", bag.string(), "--json"});
  const Finished replayed = again.wait(std::chrono::seconds(120));
  const auto reported = nlohmann::json::parse(replayed.out, nullptr, false);
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  EXPECT_EQ(reported["changes"], 1) << replayed.out;
  EXPECT_GT(reported["contact"]["compared"], 1500);
  EXPECT_EQ(reported["contact"]["differ"], 0) << replayed.out;
  EXPECT_EQ(reported["command"]["differ"], 0) << replayed.out;
  EXPECT_EQ(reported["missing"].size(), 0U) << replayed.out;
  EXPECT_NE(reported["notes"].dump().find("refused 1 records"), std::string::npos) << replayed.out;
}

}  // namespace
}  // namespace voxtouch::test
