// What ROS tools look at costs nothing until one of them looks; and the plan says so of each topic.
#include "nodes/rendering/ros_outputs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/scene/scene_file.hpp"
#include "nodes/bus/reader.hpp"
#include "nodes/rendering/plan_message.hpp"
#include "nodes/rendering/plan_ring.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::test {
namespace {

using rendering_node::RosOutputCounts;

scene::Scene plane() { return scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml"); }

class RosOutputsTest : public testing::Test {
 protected:
  /// A loop that shows frames for a while.
  void run_for(std::chrono::milliseconds time) {
    const auto until = std::chrono::steady_clock::now() + time;
    for (; std::chrono::steady_clock::now() < until; std::this_thread::sleep_for(std::chrono::milliseconds(2))) show();
  }
  void show() { outputs_.show({.time_ns = ++time_ns_, .tool = {}, .wrench = {}, .contact = true}); }
  template <class Message>
  auto reader(const qos::Topic& topic) {
    return std::make_unique<bus::Reader<Message>>(other_, topic, rig_, qos::profile(topic.profile));
  }
  bool shows_until(const std::function<bool()>& holds) {
    return wait_until([&] {
      show();
      return holds();
    });
  }

  const std::string rig_ = own_rig("ros");
  scene::Scene scene_ = plane();
  bus::Participant participant_{{kDomain, "lo", "rendering"}}, other_{{kDomain, "lo", "looker"}};
  rendering_node::RosOutputs outputs_{participant_, rig_, scene_};
  std::int64_t time_ns_ = 0;
};

TEST_F(RosOutputsTest, AreNotMadeWhileNobodyReads) {
  run_for(std::chrono::milliseconds(400));  // forty turns of its thread
  const RosOutputCounts made = outputs_.made();
  // /tf has one name for all rigs: a test that runs beside this one may read it.
  EXPECT_EQ(made.pose + made.wrench + made.markers, 0U);
}

TEST_F(RosOutputsTest, AreMadeForWhoReadsAndForNothingElseAndNoLongerOnceHeHasGone) {
  auto poses = reader<msg::geometry_msgs_PoseStamped>(qos::kPose);
  ASSERT_TRUE(shows_until([&] { return outputs_.made().pose >= 5 && poses->take_each([](const auto&) {}) > 0; }));
  EXPECT_EQ(outputs_.made().wrench + outputs_.made().markers, 0U);
  poses.reset();
  // Its going takes a moment to be known; from then on the count stands still.
  std::uint64_t last = 0;
  ASSERT_TRUE(wait_until([&] {
    last = outputs_.made().pose;
    run_for(std::chrono::milliseconds(100));
    return outputs_.made().pose == last;
  }));
  run_for(std::chrono::milliseconds(300));
  EXPECT_EQ(outputs_.made().pose, last);
}

TEST_F(RosOutputsTest, AreEachMadeOnceSomebodyReadsIt) {
  auto wrenches = reader<msg::geometry_msgs_WrenchStamped>(qos::kWrench);
  ASSERT_TRUE(shows_until([&] { return outputs_.made().wrench > 0; }));
  EXPECT_EQ(outputs_.made().markers, 0U);
  auto markers = reader<msg::visualization_msgs_MarkerArray>(qos::kMarkers);
  ASSERT_TRUE(shows_until([&] { return outputs_.made().markers > 0; }));
  auto tf = reader<msg::tf2_msgs_TFMessage>(qos::kTf);
  ASSERT_TRUE(shows_until([&] { return outputs_.made().tf > 0; }));
  EXPECT_EQ(outputs_.made().pose, 0U);
}

TEST(PlanRing, HasEachTopicAndEachNodeOnceWithAReason) {
  const std::vector<rendering::PlanPart> parts = rendering_node::ring_parts(plane());
  std::multiset<std::string> names;
  for (const rendering::PlanPart& part : parts) {
    names.insert(part.name);
    EXPECT_GT(part.why.size(), 20U) << part.name;
    EXPECT_FALSE(part.node.empty());
    EXPECT_EQ(part.expected_ns, 0.0);
  }
  for (const qos::Topic& topic : qos::kTopics) {
    EXPECT_EQ(names.count("topic " + std::string(topic.path)), 1U) << topic.path;
    const auto part = std::find_if(parts.begin(), parts.end(),
                                   [&](const rendering::PlanPart& p) { return p.name == "topic " + std::string(topic.path); });
    // What the logger does not record unasked is there for ROS tools, and only for those who read it.
    EXPECT_EQ(part->why.find("only while somebody reads it") != std::string::npos, !(topic.readers & qos::kLogger)) << topic.path;
  }
  for (const char* node : {"device", "rendering", "coupling", "validator", "logger"})
    EXPECT_EQ(names.count(std::string("node ") + node), 1U);
  EXPECT_EQ(names.size(), std::size(qos::kTopics) + 5);
}

TEST(PlanMessage, CarriesThePartsOfPlanAndRingSideBySide) {
  const std::string rig = own_rig("plan");
  bus::Participant writer_side({kDomain, "lo", "rendering"}), reader_side({kDomain, "lo", "looker"});
  bus::Writer<msg::ScenePlan> writer(writer_side, qos::kScenePlan, rig, qos::profile(qos::kScenePlan.profile));
  bus::Reader<msg::ScenePlan> reader(reader_side, qos::kScenePlan, rig, qos::profile(qos::kScenePlan.profile));
  const scene::Scene scene = plane();
  rendering::BuildCounts counts;
  counts.shell_points = 100, counts.shell_bytes = 6800, counts.voxmap_bytes = 1234;
  const rendering::Plan plan = rendering::make_plan(scene, counts);
  rendering_node::publish_plan(writer, scene, plan, fitting::demand_of(scene), 0.001, 7, 0);
  std::vector<rendering::PlanPart> wanted = plan.parts, got;
  for (rendering::PlanPart& part : rendering_node::ring_parts(scene)) wanted.push_back(std::move(part));
  ASSERT_TRUE(wait_until([&] {
    reader.take_each([&](const msg::ScenePlan& m) {
      ASSERT_EQ(m.part_names._length, m.part_nodes._length);
      ASSERT_EQ(m.part_names._length, m.part_reasons._length);
      ASSERT_EQ(m.part_names._length, m.part_bytes._length);
      ASSERT_EQ(m.part_names._length, m.part_expected_ns._length);
      for (std::uint32_t n = 0; n < m.part_names._length; ++n)
        got.push_back({m.part_names._buffer[n], m.part_nodes._buffer[n], m.part_reasons._buffer[n],
                       m.part_bytes._buffer[n], m.part_expected_ns._buffer[n]});
    });
    return !got.empty();
  }));
  ASSERT_EQ(got.size(), wanted.size());
  for (std::size_t n = 0; n < got.size(); ++n) {
    EXPECT_EQ(got[n].name, wanted[n].name);
    EXPECT_EQ(got[n].node, wanted[n].node);
    EXPECT_EQ(got[n].why, wanted[n].why);
    EXPECT_EQ(got[n].bytes, wanted[n].bytes);
    EXPECT_EQ(got[n].expected_ns, wanted[n].expected_ns);
  }
}

}  // namespace
}  // namespace voxtouch::test
