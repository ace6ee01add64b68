// Outputs for ROS tools cost nothing without a reader; the plan states this for each topic.
#include "nodes/rendering/ros_outputs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/scene/scene_file.hpp"
#include "nodes/bus/reader.hpp"
#include "nodes/mesh_import/display_mesh.hpp"
#include "nodes/rendering/plan_message.hpp"
#include "nodes/rendering/plan_ring.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::test {
namespace {

using rendering_node::RosOutput;

scene::Scene plane() {
  return scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
}

class RosOutputsTest : public testing::Test {
 protected:
  /// A loop that shows frames for a while.
  void run_for(std::chrono::milliseconds time) {
    const auto until = std::chrono::steady_clock::now() + time;
    for (; std::chrono::steady_clock::now() < until;
         std::this_thread::sleep_for(std::chrono::milliseconds(2)))
      show();
  }
  void show() {
    outputs_->show(
        {.stamp_ns = time_ns_ += step_ns_, .session = 1, .hand = {}, .object = {}, .wrench = {}});
  }
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
  std::unique_ptr<rendering_node::RosOutputs> outputs_ =
      std::make_unique<rendering_node::RosOutputs>(participant_, rig_, scene_,
                                                   qos::TimeMode::kRealTime);
  std::int64_t time_ns_ = 0;
  std::int64_t step_ns_ = 1;  ///< of simulated time, from one sample to the next
};

TEST_F(RosOutputsTest, AreNotMadeWithoutAReader) {
  run_for(std::chrono::milliseconds(400));  // forty cycles of its thread
  // /tf has one name for all rigs: a test that runs next to this one may read it.
  for (const RosOutput kind : {RosOutput::kPose, RosOutput::kWrench, RosOutput::kMarkers})
    EXPECT_EQ(outputs_->made(kind), 0U);
}

TEST_F(RosOutputsTest, AreMadeForTheTopicsWithReadersOnly) {
  auto poses = reader<msg::geometry_msgs_PoseStamped>(qos::kPose);
  ASSERT_TRUE(shows_until([&] {
    return outputs_->made(RosOutput::kPose) >= 5 && poses->take_each([](const auto&) {}) > 0;
  }));
  EXPECT_EQ(outputs_->made(RosOutput::kWrench) + outputs_->made(RosOutput::kMarkers), 0U);
  poses.reset();
  // Its departure is detected after a moment; from then on the count is constant.
  std::uint64_t last = 0;
  ASSERT_TRUE(wait_until([&] {
    last = outputs_->made(RosOutput::kPose);
    run_for(std::chrono::milliseconds(100));
    return outputs_->made(RosOutput::kPose) == last;
  }));
  run_for(std::chrono::milliseconds(300));
  EXPECT_EQ(outputs_->made(RosOutput::kPose), last);
}

TEST_F(RosOutputsTest, AreMadeFromTheFirstReaderOn) {
  auto wrenches = reader<msg::geometry_msgs_WrenchStamped>(qos::kWrench);
  ASSERT_TRUE(shows_until([&] { return outputs_->made(RosOutput::kWrench) > 0; }));
  EXPECT_EQ(outputs_->made(RosOutput::kMarkers), 0U);
  auto markers = reader<msg::visualization_msgs_MarkerArray>(qos::kMarkers);
  ASSERT_TRUE(shows_until([&] { return outputs_->made(RosOutput::kMarkers) > 0; }));
  auto tf = reader<msg::tf2_msgs_TFMessage>(qos::kTf);
  ASSERT_TRUE(shows_until([&] { return outputs_->made(RosOutput::kTf) > 0; }));
  EXPECT_EQ(outputs_->made(RosOutput::kPose), 0U);
}

std::int64_t ns_of(const msg::builtin_interfaces_Time& t) {
  return 1'000'000'000LL * t.sec + t.nanosec;
}

TEST_F(RosOutputsTest, AreWrittenAt100HertzInWallTime) {
  auto poses = reader<msg::geometry_msgs_PoseStamped>(qos::kPose);
  std::vector<std::int64_t> written, off;
  ASSERT_TRUE(wait_until([&] {
    show();
    poses->take_each([&](const msg::geometry_msgs_PoseStamped& p, const dds_sample_info_t& info) {
      written.push_back(info.source_timestamp);
      off.push_back(std::abs(info.source_timestamp - ns_of(p.header.stamp)));
    });
    return written.size() >= 800;
  }));
  std::ranges::nth_element(off, off.begin() + 400);
  EXPECT_LT(off[400], 20'000'000)
      << "stamps are not the wall's time, although the device's clock is long behind it";
  // How late each one is on a grid of 10 ms. Single ones may be late on a busy machine; the least
  // late ones must not drift.
  std::vector<double> late_ms;
  double grid_ms = 0.0;
  for (std::size_t n = 0; n < written.size(); ++n) {
    const double at_ms = static_cast<double>(written[n] - written[0]) * 1e-6;
    if (n > 0)
      grid_ms += 10.0 * std::round((at_ms - grid_ms - late_ms.back()) / 10.0);
    late_ms.push_back(at_ms - grid_ms);
  }
  const auto half = late_ms.begin() + 400;
  const double drift_ms =
      *std::min_element(half, half + 400) - *std::min_element(late_ms.begin(), half);
  EXPECT_LT(std::abs(drift_ms), 4.0) << "in 4 s: more than 0.1 Hz next to 100 Hz";
}

TEST_F(RosOutputsTest, HaveSimulatedTimeAndAClockInLockstep) {
  outputs_ = std::make_unique<rendering_node::RosOutputs>(participant_, rig_, scene_,
                                                          qos::TimeMode::kLockstep);
  auto poses = reader<msg::geometry_msgs_PoseStamped>(qos::kPose);
  auto clocks = reader<msg::rosgraph_msgs_Clock>(qos::kClock);
  std::vector<std::int64_t> of_poses, of_clocks;
  time_ns_ = 7'000'000'000, step_ns_ = 1'000'000;
  ASSERT_TRUE(shows_until([&] {
    poses->take_each([&](const msg::geometry_msgs_PoseStamped& p) {
      of_poses.push_back(ns_of(p.header.stamp));
    });
    clocks->take_each(
        [&](const msg::rosgraph_msgs_Clock& c) { of_clocks.push_back(ns_of(c.clock)); });
    return of_poses.size() > 5 && of_clocks.size() > 5;
  }));
  for (const auto& stamps : {of_poses, of_clocks}) {
    EXPECT_GT(stamps.front(), 7'000'000'000);
    EXPECT_LE(stamps.back(), time_ns_);
    EXPECT_TRUE(std::ranges::is_sorted(stamps));
  }
}

TEST_F(RosOutputsTest, HaveNoClockInRealTime) {
  auto clocks = reader<msg::rosgraph_msgs_Clock>(qos::kClock);
  auto poses = reader<msg::geometry_msgs_PoseStamped>(qos::kPose);
  ASSERT_TRUE(shows_until([&] { return outputs_->made(RosOutput::kPose) > 0; }));
  EXPECT_EQ(outputs_->made(RosOutput::kClock), 0U);
}

TEST_F(RosOutputsTest, PublishStaticFramesOnceAlsoForLateReaders) {
  for (int reader_number = 0; reader_number < 2; ++reader_number) {
    auto frames = reader<msg::tf2_msgs_TFMessage>(qos::kTfStatic);
    std::set<std::string> names;
    EXPECT_TRUE(shows_until([&] {
      frames->take_each([&](const msg::tf2_msgs_TFMessage& m) {
        for (std::uint32_t n = 0; n < m.transforms._length; ++n)
          names.insert(m.transforms._buffer[n].child_frame_id);
      });
      return names.contains(rig_ + "/device");
    })) << reader_number;
  }
  EXPECT_EQ(outputs_->made(RosOutput::kTfStatic), 1U);
}

rendering_node::LastingMarker triangle(const std::string& name_space, std::int32_t id) {
  return {name_space, id, "world", {}, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}};
}
/// "ADD scene 0, DELETE ..." of the markers sent from `now_ns` on, while any are due.
std::vector<std::string> all_due(rendering_node::MarkerRounds& rounds, std::int64_t now_ns) {
  std::vector<std::string> said;
  for (int message = 0; message < 100 && rounds.due(now_ns); ++message) {
    for (const auto& m : rounds.markers(now_ns))
      said.push_back(std::string(m.action == 0   ? "ADD "
                                 : m.action == 2 ? "DELETE "
                                                 : "DELETEALL ") +
                     m.ns + " " + std::to_string(m.id));
    rounds.sent(now_ns);
  }
  return said;
}

TEST(MarkerRounds, SendMeshesToLateReadersAndDeleteRemovedOnes) {
  using Said = std::vector<std::string>;
  constexpr std::int64_t kSecond = 1'000'000'000;
  rendering_node::MarkerRounds rounds;
  EXPECT_EQ(all_due(rounds, 0), Said());
  rounds.replace({triangle("scene", 0), triangle("scene", 1)});
  EXPECT_EQ(all_due(rounds, 1 * kSecond), (Said{"DELETEALL  0", "ADD scene 0", "ADD scene 1"}));
  EXPECT_EQ(all_due(rounds, 1.5 * kSecond), Said());
  EXPECT_EQ(all_due(rounds, 2 * kSecond), (Said{"ADD scene 0", "ADD scene 1"}))
      << "DDS may have lost the first ones";
  EXPECT_EQ(all_due(rounds, 11 * kSecond), Said()) << "they need not be sent each time";
  EXPECT_EQ(all_due(rounds, 12 * kSecond).size(), 2U) << "a viewer may have been cleared";
  rounds.reader_came();
  EXPECT_EQ(all_due(rounds, 13 * kSecond), (Said{"ADD scene 0", "ADD scene 1"}));
  rounds.replace({triangle("scene", 0), triangle("object/lid", 0)});
  EXPECT_EQ(all_due(rounds, 14 * kSecond),
            (Said{"DELETE scene 1", "ADD scene 0", "ADD object/lid 0"}));
  rounds.replace({triangle("scene", 0), triangle("scene", 1)});
  EXPECT_EQ(all_due(rounds, 15 * kSecond),
            (Said{"DELETE object/lid 0", "ADD scene 0", "ADD scene 1"}));
}

TEST(MomentMarkers, DrawNoNonFiniteForce) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300}) {
    const rendering_node::MomentMarkers markers({.stamp_ns = 0,
                                                 .hand = Vec3::Zero(),
                                                 .object = Vec3::Zero(),
                                                 .returned = Vec3(bad, 0, 0),
                                                 .contact = Vec3(0, 0, bad),
                                                 .points = {}});
    for (const auto& m : markers.all)
      EXPECT_NE(m.action, 0) << m.ns << ": a command that came from any participant has a force of "
                             << bad;
  }
}

TEST(DisplayMesh, KeepsSmallMeshesAndThinsLargeOnes) {
  using Counts = std::vector<std::size_t>;
  EXPECT_EQ(mesh_import::counts_of({12, 1'000'000, 1280}, 20'000), (Counts{12, 18'708, 1280}));
  EXPECT_EQ(mesh_import::counts_of({1'000'000, 500'000}, 20'000), (Counts{10'000, 10'000}));
  EXPECT_EQ(mesh_import::counts_of({5, 7}, 20'000), (Counts{5, 7}));
  EXPECT_EQ(mesh_import::counts_of({}, 20'000), Counts());
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
  std::size_t topics = 0;
  for (const qos::Topic& topic : qos::kTopics) {
    const bool is_absent = topic.with_external || topic.with_led_hand;
    EXPECT_TRUE(!is_absent || !names.contains("topic " + std::string(topic.path)))
        << "not in a ring of this scene";
    if (is_absent)
      continue;
    ++topics;
    EXPECT_EQ(names.count("topic " + std::string(topic.path)), 1U) << topic.path;
    const auto part = std::find_if(parts.begin(), parts.end(), [&](const rendering::PlanPart& p) {
      return p.name == "topic " + std::string(topic.path);
    });
    // Topics that the logger does not record by default exist for ROS tools, and only for readers.
    EXPECT_EQ(part->why.find("ROS tools") != std::string::npos, !(topic.readers & qos::kLogger))
        << topic.path;
  }
  for (const char* node : {"device", "rendering", "coupling", "validator", "logger"})
    EXPECT_EQ(names.count(std::string("node ") + node), 1U);
  EXPECT_EQ(names.size(), topics + 5);
}

TEST(PlanRing, ListsTheTopicOfAnExternalWrench) {
  scene::Scene scene = plane();
  effects::EffectSpec external{.name = "external",
                               .kind = effects::find_effect_kind("external"),
                               .values = {},
                               .region = {}};
  external.values = effects::EffectValues(external.kind->parameters);
  const auto count = [&](const std::string& name) {
    const std::vector<rendering::PlanPart> parts = rendering_node::ring_parts(scene);
    return std::ranges::count(parts, "topic " + name, &rendering::PlanPart::name);
  };
  EXPECT_EQ(count("external") + count("rendering/external"), 0);
  scene.effects = {external};
  EXPECT_EQ(count("external"), 1);
  EXPECT_EQ(count("rendering/external"), 1);
  scene.effects[0].text = "/sim/wrench";
  EXPECT_EQ(count("/sim/wrench"), 1);
  EXPECT_EQ(count("external"), 0);
}

TEST(PlanMessage, CarriesThePartsOfPlanAndRingSideBySide) {
  const std::string rig = own_rig("plan");
  bus::Participant writer_side({kDomain, "lo", "rendering"}),
      reader_side({kDomain, "lo", "looker"});
  bus::Writer<msg::ScenePlan> writer(writer_side, qos::kScenePlan, rig,
                                     qos::profile(qos::kScenePlan.profile));
  bus::Reader<msg::ScenePlan> reader(reader_side, qos::kScenePlan, rig,
                                     qos::profile(qos::kScenePlan.profile));
  const scene::Scene scene = plane();
  rendering::BuildCounts counts;
  counts.shell_points = 100, counts.shell_bytes = 6800, counts.voxmap_bytes = 1234;
  const rendering::Plan plan = rendering::make_plan(scene, counts);
  rendering_node::publish_plan(writer, scene, plan, device_fit::demand_of(scene), 0.001, 7, 0);
  std::vector<rendering::PlanPart> expected = plan.parts, got;
  for (rendering::PlanPart& part : rendering_node::ring_parts(scene))
    expected.push_back(std::move(part));
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
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t n = 0; n < got.size(); ++n) {
    EXPECT_EQ(got[n].name, expected[n].name);
    EXPECT_EQ(got[n].node, expected[n].node);
    EXPECT_EQ(got[n].why, expected[n].why);
    EXPECT_EQ(got[n].bytes, expected[n].bytes);
    EXPECT_EQ(got[n].expected_ns, expected[n].expected_ns);
  }
}

}  // namespace
}  // namespace voxtouch::test
