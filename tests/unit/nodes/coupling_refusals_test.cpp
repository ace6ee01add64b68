// The coupling node alone: it commands no force while effects or contact exceed the device.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "core/scene/scene_file.hpp"
#include "nodes/coupling/coupling_fit.hpp"
#include "nodes/runtime/device_message.hpp"
#include "tests/unit/nodes/around_coupling.hpp"

namespace voxtouch::test::around_coupling {
namespace {

/// The second check: after the rendering's, the node that makes the force checks the device again.
TEST(CouplingNode, IsSilentIfEffectsExceedTheDevice) {
  Around around("{design: auto, kind: shaping_filter}");
  around.describe(20.0);
  around.plan();
  ASSERT_TRUE(around.force_comes());
  around.plan(30.0, 7, {50.0, 0.0, ""});
  around.expect_no_force("50 Ns/m");
  around.plan(30.0, 7, {0.1, 0.0, ""});
  EXPECT_TRUE(around.force_comes());
  around.plan(30.0, 7, {0.0, 0.0, "oil"});
  around.expect_no_force("'oil'");
  around.plan();
  EXPECT_TRUE(around.force_comes());
  EXPECT_EQ(around.node.end(), 0);
}

TEST(CouplingNode, IsSilentIfRotationDampingExceedsTheDevice) {
  Around around("{design: auto, kind: shaping_filter}");
  around.describe_one_that_gives_torque();
  around.plan(30.0, 7, {0.0, 0.0, "oil", 0.01});
  ASSERT_TRUE(around.force_comes()) << around.message();
  around.plan(30.0, 7, {0.0, 0.0, "oil", 5.0});
  around.expect_no_force("5 Nms/rad");
  around.plan(30.0, 7, {0.0, 0.0, "oil", 0.01});
  EXPECT_TRUE(around.force_comes()) << around.message();
  EXPECT_EQ(around.node.end(), 0);
}

TEST(CouplingNode, IsSilentIfAnExternalWrenchExceedsTheDevice) {
  Around around("{design: auto, kind: shaping_filter}");
  around.describe(20.0);
  around.plan(30.0, 7, {0.0, 0.0, "", 0.0, 2.0});
  ASSERT_TRUE(around.force_comes()) << around.message();
  EXPECT_TRUE(std::ranges::any_of(around.notes, [](const std::string& note) {
    return note.find("'remote'") != std::string::npos;
  })) << "the design says so";
  around.plan(30.0, 7, {0.0, 0.0, "", 0.0, 9.0});
  around.expect_no_force("force of 9 N");
  around.plan(30.0, 7, {0.0, 0.0, "", 0.0, std::numeric_limits<double>::quiet_NaN()});
  around.expect_no_force("'remote'");
  around.plan(30.0, 7, {0.0, 0.0, "", 0.0, 2.0});
  EXPECT_TRUE(around.force_comes()) << around.message();
  EXPECT_EQ(around.node.end(), 0);
}

/// A restarted rendering may run another scene: no force before its plan is received and fitted.
TEST(CouplingNode, IsSilentForARestartedRenderingWithoutPlan) {
  Around around("{design: auto, kind: shaping_filter}", false, true);
  const std::pair device{std::string("device"), around.device.participant.guid()};
  around.up.name({device, {"rendering", around.rendering->participant.guid()}});
  around.describe(20.0);
  around.plan();
  ASSERT_TRUE(around.force_comes());
  around.forces.clear();
  for (int i = 0; i < 100; ++i)
    around.touch(8);
  EXPECT_TRUE(around.forces.empty()) << "contacts of another session";
  auto second = std::make_unique<StandIn>(kDomain, "rendering", around.rig);
  bus::Writer<msg::ScenePlan> plans(second->participant, qos::kScenePlan, around.rig,
                                    Around::latched());
  bus::Writer<msg::ContactState> contacts(second->participant, qos::kContactState, around.rig,
                                          Around::stream());
  ASSERT_TRUE(
      wait_until([&] { return plans.matched_count() > 0 && contacts.matched_count() > 0; }));
  around.up.name({device,
                  {"rendering", around.rendering->participant.guid()},
                  {"rendering", second->participant.guid()}});
  second->say(7);
  around.contacts = {}, around.plans = {}, around.rendering.reset();
  around.contacts = std::move(contacts), around.plans = std::move(plans),
  around.rendering = std::move(second);
  for (int i = 0; i < 50; ++i)
    around.touch();
  around.forces.clear();
  for (int i = 0; i < 500; ++i)
    around.touch();
  EXPECT_TRUE(around.forces.empty()) << "by the plan of the one before";
  const std::size_t designs = around.seen.size();
  around.plan();
  EXPECT_TRUE(around.force_comes()) << around.message();
  EXPECT_EQ(around.seen.size(), designs + 1) << "by the coupling of the one before";
  EXPECT_EQ(around.node.end(), 0);
}

TEST(CouplingNode, IsSilentIfANewDeviceCannotBearTheEffects) {
  Around around("{design: auto, kind: shaping_filter}");
  around.describe(20.0);
  around.plan(30.0, 7, {1.0, 0.0, ""});
  ASSERT_TRUE(around.force_comes());
  around.describe(20.0, 7, 0.001);
  around.expect_no_force("0.001 kg");
  around.describe(20.0);
  EXPECT_TRUE(around.force_comes());
  EXPECT_EQ(around.node.end(), 0);
}

TEST(CouplingNode, IsSilentIfEffectsAreTooStiffForIt) {
  Around around("{kind: shaping_filter, cutoff_hz: 100, damping_ratio: 1, gain: 1}");
  around.describe(2.0);
  around.plan(30.0, 7, {0.0, 100.0, ""});
  ASSERT_TRUE(around.force_comes());
  around.plan(30.0, 7, {0.0, 900.0, ""});
  around.expect_no_force("900 N/m at the hand, device limit 800 N/m. Divide oil");
  EXPECT_EQ(around.node.end(), 0);
}

/// A fit takes tenths of a second and does not include inputs received meanwhile.
TEST(Fitting, ChecksItsResultAgainstNewerInputs) {
  const scene::Scene scene = scene::load_scene(scene_with("{design: auto, kind: shaping_filter}"));
  const Around::Demand little{0.1, 0.0, ""}, much{50.0, 0.0, ""};
  coupling_node::Fitting fitting(scene);
  fitting.set_device(runtime::from_msg(stylus(7)), 7);
  fitting.set_plan(Around::message_of(30.0, 7, little));
  ASSERT_TRUE(fitting.fit().refusal.empty());
  fitting.begin();
  fitting.set_plan(Around::message_of(30.0, 7, much));
  std::optional<device_fit::FittedCoupling> fitted;
  ASSERT_TRUE(wait_until([&] { return (fitted = fitting.poll()).has_value(); }));
  EXPECT_TRUE(fitted->refusal.error.contains("'oil'")) << fitted->refusal.error;
}

}  // namespace
}  // namespace voxtouch::test::around_coupling
