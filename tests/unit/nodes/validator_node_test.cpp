// The validator works only while its verdicts have a reader.
#include "nodes/validator/validator_node.hpp"

#include <gtest/gtest.h>

#include "core/scene/scene_file.hpp"
#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/strings.hpp"
#include "tests/support/stand_in.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::test {
namespace {

class ValidatorNodeTest : public testing::Test {
 protected:
  ValidatorNodeTest() {
    options_ = node_options<validator::Options>(rig_, "plane");
    options_.every = 1;
    const std::string name = scene_.name, hash = scene_.hash;
    msg::ScenePlan plan{};
    plan.contact_model = runtime::lend(none_);
    plan.scene = runtime::lend(name), plan.scene_hash = runtime::lend(hash);
    plan.session_id = 7;
    plan.voxel_size_m = 1e-3, plan.largest_shell_gap_m = 1e-3;
    plans_.write(plan);
    rendering_.say(7);
    node_ = std::make_unique<NodeThread>(
        [this](const std::atomic<bool>& stop) { return validator::run(options_, stop); });
  }

  /// A rendering that shows a tool high above the plane.
  void show() {
    msg::ContactState c{};
    c.session_id = 7;
    c.sequence_number = ++sequence_;
    c.object_pose.orientation.w = 1.0;
    c.object_pose.position.z = 1.0;
    contacts_.write(c);
  }
  void show_for(std::chrono::milliseconds time) {
    const auto until = std::chrono::steady_clock::now() + time;
    for (; std::chrono::steady_clock::now() < until;
         std::this_thread::sleep_for(std::chrono::milliseconds(2)))
      show();
  }
  bool shows_until(const std::function<bool()>& holds) {
    return wait_until([&] {
      show();
      return holds();
    });
  }
  std::string message() {
    registry_.update([](const auto&) { return true; });
    const auto report = registry_.find("validator");
    return report ? report->message : "no report";
  }
  std::uint64_t figure(const char* name) {
    registry_.update([](const auto&) { return true; });
    const auto report = registry_.find("validator");
    return report ? runtime::as_count(runtime::value_of(report->figures, name)) : 0;
  }
  std::uint64_t checked() { return figure("checked"); }

  const std::string rig_ = own_rig("v"), none_;
  const scene::Scene scene_ =
      scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
  StandIn rendering_{kDomain, "rendering", rig_};
  bus::Participant reader_{{kDomain, "lo", "reader"}};
  runtime::NodeRegistry registry_{reader_, rig_};
  bus::Writer<msg::ScenePlan> plans_{rendering_.participant, qos::kScenePlan, rig_,
                                     qos::profile(qos::ProfileId::kLatched)};
  bus::Writer<msg::ContactState> contacts_{rendering_.participant, qos::kContactState, rig_,
                                           qos::profile(qos::ProfileId::kStream)};
  validator::Options options_;
  std::uint64_t sequence_ = 0;
  std::unique_ptr<NodeThread> node_;
};

TEST_F(ValidatorNodeTest, IsIdleWithoutAReaderAndReportsIt) {
  ASSERT_TRUE(shows_until([&] { return message().starts_with("idle: "); }))
      << message() << node_->error();
  show_for(std::chrono::milliseconds(300));
  EXPECT_EQ(checked(), 0U);
}

TEST_F(ValidatorNodeTest, EvaluatesOnlyWhileRead) {
  auto verdicts = std::make_unique<bus::Reader<msg::ValidationReport>>(
      reader_, qos::kValidation, rig_, qos::profile(qos::ProfileId::kTap));
  std::uint64_t received = 0;
  ASSERT_TRUE(shows_until([&] {
    verdicts->take_each([&](const msg::ValidationReport& v) { received = v.agree; });
    return received >= 5;
  })) << message();
  verdicts.reset();
  // His going takes a moment to be known, and the status is reported a few times a second only.
  ASSERT_TRUE(shows_until([&] { return message().starts_with("idle: "); })) << message();
  const std::uint64_t last = checked();
  EXPECT_GE(last, received);
  show_for(std::chrono::milliseconds(400));
  EXPECT_EQ(checked(), last);
}

TEST_F(ValidatorNodeTest, CountsTheDueSamplesThatItMissed) {
  bus::Reader<msg::ValidationReport> verdicts(reader_, qos::kValidation, rig_,
                                              qos::profile(qos::ProfileId::kTap));
  ASSERT_TRUE(shows_until([&] { return checked() >= 5; })) << message();
  const std::uint64_t before = figure("skipped");
  sequence_ += 10;
  ASSERT_TRUE(shows_until([&] { return figure("skipped") >= before + 10; })) << message();
  EXPECT_TRUE(wait_until([&] {
    return checked() + figure("skipped") == sequence_ - figure("first_checked") + 1;
  })) << checked()
      << " checked, " << figure("skipped") << " skipped of " << sequence_;
  EXPECT_TRUE(message().contains("due samples skipped")) << message();
}

}  // namespace
}  // namespace voxtouch::test
