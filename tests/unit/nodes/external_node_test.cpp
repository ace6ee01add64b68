// The rendering node and writers of the external wrench, over real DDS: which it follows, which it
// refuses, and when the force fades.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <sstream>

#include "nodes/rendering/external_source.hpp"
#include "nodes/rendering/rendering_node.hpp"
#include "tests/support/stand_in.hpp"
#include "tests/unit/nodes/asker.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds;
using namespace msg::effect_change;
namespace result = msg::effect_changed;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                 kInf = std::numeric_limits<double>::infinity();
constexpr double kMaxN = 2.0, kTimeoutS = 0.1, kFadeS = 0.02;

/// plane.yaml with an external wrench, as a temporary file.
class ExternalScene {
 public:
  explicit ExternalScene(const std::string& topic)
      : file(std::filesystem::temp_directory_path() /
             ("external_node_test_" + std::to_string(getpid()) + ".yaml")) {
    std::ifstream in(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
    std::stringstream text;
    text << in.rdbuf();
    std::string all = text.str();
    const auto replace = [&](const std::string& from, const std::string& to) {
      for (std::size_t at = 0; (at = all.find(from, at)) != std::string::npos; at += to.size())
        all.replace(at, from.size(), to);
    };
    replace("../meshes", std::string(VOXTOUCH_DEPLOY) + "/meshes");
    replace("effects: []",
            "effects: [{external: {topic: " + topic +
                ", max_force_n: 2, timeout_s: 0.1, fade_s: 0.02, slew_n_per_s: 100}}]");
    replace("device: {position_scale: 1, force_scale: 1}",
            "device: {pose: {orientation: [0.7071067811865476, 0, 0, 0.7071067811865476]}}");
    std::ofstream(file) << all;
  }
  ~ExternalScene() { std::filesystem::remove(file); }
  std::filesystem::path file;
};

/// A participant outside the ring with a writer on the topic.
class Outsider {
 public:
  Outsider(const std::string& topic, const std::string& rig, const std::string& frame = "world")
      : participant({kDomain, "lo", "outsider"}),
        frame_(frame),
        writer_(participant, qos::external_topic(topic), rig, qos::profile(qos::ProfileId::kTap)) {}
  void write(double x, double y, double z) {
    msg::geometry_msgs_WrenchStamped m{};
    m.header.frame_id = frame_.data();
    m.wrench.force = {x, y, z};
    writer_.write(m);
  }
  bool matched() const { return writer_.matched_count() > 0; }

  bus::Participant participant;

 private:
  std::string frame_;
  bus::Writer<msg::geometry_msgs_WrenchStamped> writer_;
};

class ExternalLive : public testing::Test {
 protected:
  ExternalLive()
      : rig(own_rig("w")),
        topic("/" + rig + "/sim/wrench"),
        scene(topic),
        device(kDomain, "device", rig),
        registry(device.participant, rig),
        descriptions(device.participant, qos::kDeviceDescription, rig, latched()),
        plans(device.participant, qos::kScenePlan, rig, latched()),
        states(device.participant, qos::kDeviceState, rig, qos::profile(qos::ProfileId::kStream)),
        contacts(device.participant, qos::kContactState, rig, qos::profile(qos::ProfileId::kTap)),
        taken(device.participant, qos::kExternalSample, rig,
              qos::profile(qos::kExternalSample.profile)),
        asker(device.participant, rig),
        options(node_options<rendering_node::Options>(rig)),
        node([this](const std::atomic<bool>& stop) {
          options.scene = scene.file;
          return rendering_node::run(options, stop);
        }) {}
  void begin(std::uint64_t id) {
    descriptions.write(stylus(session = id));
    device.say(id);
    sequence = 0, planned = 0;
    ASSERT_TRUE(wait_until([&] {
      poll();
      return planned == id && states.matched_count() == 1 && contacts.matched_count() == 1;
    })) << node.error();
  }
  void poll() {
    plans.take_each([this](const msg::ScenePlan& p) {
      planned = p.session_id, may_ask_n = p.external_force_n, asks = p.external_effect;
    });
    msg::ContactState c;
    while (contacts.take(c)) {
      if (c.session_id != session)
        continue;
      const auto ms = last.session_id == session
                          ? static_cast<double>(c.sequence_number - last.sequence_number)
                          : 1.0;
      const auto &a = last.effects_wrench.force, &b = c.effects_wrench.force;
      if (last.session_id == session && ms > 0)
        most_step = std::max(most_step, std::hypot(b.x - a.x, b.y - a.y, b.z - a.z) / ms);
      last = c;
      most_n = std::max(most_n, std::hypot(b.x, b.y, b.z));
    }
    msg::ExternalSample e;
    while (taken.take(e))
      reported.push_back(e);
  }
  /// One sample of a hand that rests in the air.
  void sample() {
    msg::DeviceState m{};
    m.session_id = session;
    m.sequence_number = sequence++;
    m.sample_time_ns = static_cast<std::int64_t>(m.sequence_number) * 1'000'000;
    m.pose.position = {0.0, 0.0, 0.05};
    m.pose.orientation.w = 1.0;
    states.write(m);
    std::this_thread::sleep_for(milliseconds(1));
    poll();
  }
  void samples(int count) {
    for (int n = 0; n < count; ++n)
      sample();
  }
  /// Samples with `each` before them, until `holds`.
  bool until(
      const std::function<bool()>& holds, const std::function<void()>& each = [] {}) {
    return wait_until([&] {
      each();
      sample();
      return holds();
    });
  }
  double force() const {
    return std::hypot(last.effects_wrench.force.x, last.effects_wrench.force.y,
                      last.effects_wrench.force.z);
  }
  runtime::NodeReport report() {
    registry.update();
    return registry.find("rendering").value_or(runtime::NodeReport{});
  }
  double figure(const char* name) { return runtime::value_of(report().figures, name); }
  bool says(const std::string& text) {
    return until([&] { return report().message.find(text) != std::string::npos; });
  }
  /// Waits until this one is followed, which needs a poll of the node's monitor.
  bool is_followed(Outsider& who, double y) {
    return until([&] { return last.effects_wrench.force.y * y > 0.0; },
                 [&] { who.write(0, y, 0); });
  }

  std::string rig, topic;
  ExternalScene scene;
  StandIn device;
  runtime::NodeRegistry registry;
  bus::Writer<msg::DeviceDescription> descriptions;
  bus::Reader<msg::ScenePlan> plans;
  bus::Writer<msg::DeviceState> states;
  bus::Reader<msg::ContactState> contacts;
  bus::Reader<msg::ExternalSample> taken;
  Asker asker;
  rendering_node::Options options;
  NodeThread node;
  std::uint64_t session = 0, sequence = 0, planned = 0;
  double may_ask_n = 0.0, most_n = 0.0, most_step = 0.0;
  std::string asks;
  msg::ContactState last{};
  std::vector<msg::ExternalSample> reported;
};

TEST_F(ExternalLive, IsBoundedAndFadesWhenItsWriterFallsSilent) {
  begin(5);
  EXPECT_EQ(may_ask_n, kMaxN) << "the plan reports the coupling what may be asked for";
  EXPECT_EQ(asks, "external");
  samples(50);
  EXPECT_EQ(force(), 0.0) << "none writes";
  Outsider robot(topic, rig);
  ASSERT_TRUE(is_followed(robot, 5.0));
  ASSERT_TRUE(until([&] { return force() > 0.999 * kMaxN; }, [&] { robot.write(0, 5, 0); }));
  EXPECT_EQ(last.wrench.force.y, last.effects_wrench.force.y) << "the hand is given it";
  EXPECT_EQ(last.contact_wrench.force.y, 0.0)
      << "and it is no contact, which the validator would judge";
  ASSERT_FALSE(reported.empty());
  EXPECT_EQ(reported.back().wrench.force.y, 5.0) << "as it came, before any bound";
  EXPECT_EQ(reported.back().session_id, 5U);
  EXPECT_EQ(reported.back().sample_time_ns,
            static_cast<std::int64_t>(reported.back().sequence_number) * 1'000'000);
  const auto feed = [&] { robot.write(0, 5, 0); };
  EXPECT_TRUE(until(
      [&] {
        return !report().values["external_writer"].empty() && figure("external_samples") > 0.0;
      },
      feed))
      << "a status comes ten times a second";
  EXPECT_NE(report().values["external"].find("not certified"), std::string::npos);
  ASSERT_TRUE(until([&] { return force() > 0.999 * kMaxN; }, feed));
  // Silence: by the samples' time it is repeated for the timeout, and zero after the fade.
  ASSERT_TRUE(until([&] { return force() == 0.0; }));
  const double silent_s =
      1e-3 * static_cast<double>(last.sequence_number - reported.back().sequence_number);
  EXPECT_GE(silent_s, kTimeoutS);
  samples(20);
  EXPECT_EQ(force(), 0.0);
  EXPECT_LE(most_n, kMaxN);
  EXPECT_LE(most_step, std::max(100.0, kMaxN / kFadeS) * 1e-3 * (1 + 1e-9));
  ASSERT_TRUE(is_followed(robot, 5.0)) << "it comes back";
}

TEST_F(ExternalLive, FollowsOneWriterAndNamesEveryOther) {
  begin(5);
  Outsider robot(topic, rig);
  ASSERT_TRUE(is_followed(robot, 1.0));
  auto second = std::make_unique<Outsider>(topic, rig);
  bool turned = false;
  ASSERT_TRUE(until([&] { return figure("external_foreign") > 100.0; },
                    [&] {
                      robot.write(0, 1, 0);
                      second->write(0, -2, 0);
                      turned |= last.effects_wrench.force.y < 0.0;
                    }));
  EXPECT_FALSE(turned);
  for (const msg::ExternalSample& sample : reported)
    ASSERT_EQ(sample.wrench.force.y, 1.0) << "no foreign value reached the loop";
  EXPECT_TRUE(says("are refused: ")) << report().message;
  second.reset();
  EXPECT_TRUE(until([&] { return report().message.find("are refused") == std::string::npos; },
                    [&] { robot.write(0, 1, 0); }))
      << report().message;
}

TEST_F(ExternalLive, FollowsNoneOfSeveralInitialWriters) {
  Outsider one(topic, rig);
  auto two = std::make_unique<Outsider>(topic, rig);
  ASSERT_TRUE(wait_until([&] { return one.matched() && two->matched(); }));
  begin(5);
  const auto both = [&] { one.write(0, 1, 0), two->write(0, -1, 0); };
  EXPECT_TRUE(until([&] { return report().message.find("2 writers") != std::string::npos; }, both))
      << report().message;
  for (int n = 0; n < 200; ++n)
    both(), sample();  // ten polls of the monitor
  EXPECT_TRUE(reported.empty());
  EXPECT_EQ(force(), 0.0);
  two.reset();
  EXPECT_TRUE(is_followed(one, 1.0)) << "one is left";
}

TEST_F(ExternalLive, RefusesNonFiniteNumbersAndUnknownFrames) {
  begin(5);
  Outsider robot(topic, rig);
  ASSERT_TRUE(is_followed(robot, 1.0));
  for (const double bad : {kNan, kInf, -kInf})
    ASSERT_TRUE(until(
        [&, before = figure("external_not_finite")] {
          return figure("external_not_finite") > before;
        },
        [&] { robot.write(bad, 1, 0); }));
  ASSERT_TRUE(until([&] { return force() == 0.0; }, [&] { robot.write(0, kNan, 0); }))
      << "what is refused keeps nothing alive";
  EXPECT_TRUE(std::isfinite(most_n) && most_n <= kMaxN);
}

TEST_F(ExternalLive, TakesTheFramesOfTheRigAndNoOther) {
  begin(5);
  {
    Outsider lost(topic, rig, "base_link\x1b[2J");
    EXPECT_TRUE(
        until([&] { return figure("external_wrong_frame") > 10.0; }, [&] { lost.write(0, 1, 0); }));
    EXPECT_TRUE(reported.empty());
    EXPECT_TRUE(says("'base_link?[2J'") && says("'world' or '" + rig + "/device'"))
        << report().message;
  }
  Outsider robot(topic, rig, rig + "/device");
  ASSERT_TRUE(
      until([&] { return last.effects_wrench.force.y > 0.9; }, [&] { robot.write(1, 0, 0); }))
      << "D is turned by 90 degrees about z in W";
  EXPECT_NEAR(last.effects_wrench.force.x, 0.0, 1e-12);
}

TEST_F(ExternalLive, NewSessionStartsAtZeroAndFollowsAgain) {
  begin(5);
  Outsider robot(topic, rig);
  ASSERT_TRUE(is_followed(robot, 1.0));
  for (int n = 0; n < 20; ++n)
    robot.write(0, 1, 0);
  begin(6);
  reported.clear(), last = {}, most_n = 0.0;
  samples(50);
  EXPECT_EQ(most_n, 0.0) << "a value of the last session";
  EXPECT_TRUE(reported.empty());
  ASSERT_TRUE(is_followed(robot, 1.0));
  EXPECT_EQ(reported.back().session_id, 6U);
}

TEST_F(ExternalLive, ChangesWhileItRunsAsFarAsTheDeviceGives) {
  begin(5);
  Outsider robot(topic, rig);
  ASSERT_TRUE(asker.ready());
  ASSERT_TRUE(is_followed(robot, 5.0));
  const auto ask = [&](const msg::EffectChange& m, const char* parameter = "") {
    return asker.last_word(asker.send(m, "external", parameter),
                           [&] { robot.write(0, 5, 0), sample(); });
  };
  Said said = ask(change(kActionValue, 0.5), "max_force_n");
  EXPECT_EQ(said.result, result::kResultDone) << said.sentence;
  EXPECT_TRUE(until([&] { return std::abs(force() - 0.5) < 1e-9; }, [&] { robot.write(0, 5, 0); }))
      << force();
  said = ask(change(kActionValue, 9.0), "max_force_n");
  EXPECT_EQ(said.result, result::kResultRefused);
  EXPECT_TRUE(said.sentence.contains(" 9 N ") && said.sentence.contains(" 8.5 N")) << said.sentence;
  EXPECT_EQ(ask(change(kActionValue, kNan), "timeout_s").result, result::kResultRefused);
  EXPECT_EQ(ask(change(kActionValue, 0.0), "topic").result, result::kResultRefused);
  EXPECT_NE(ask(change(kActionValue, 0.01), "max_torque_nm").sentence.find("not built"),
            std::string::npos)
      << "torque was not asked for at the start";
  EXPECT_EQ(ask(change(kActionGain, 0.5)).result, result::kResultDone);
  EXPECT_TRUE(until([&] { return std::abs(force() - 0.25) < 1e-9; }, [&] { robot.write(0, 5, 0); }))
      << force();
  EXPECT_EQ(ask(change(kActionSwitch, 0.0)).result, result::kResultDone);
  EXPECT_TRUE(until([&] { return force() == 0.0; }, [&] { robot.write(0, 5, 0); })) << force();
  EXPECT_LE(most_step, 0.1 + 1e-9);
}

TEST(ExternalScenes, AreRefusedForATopicOfTheRing) {
  const std::string rig = own_rig("o");
  const ExternalScene scene("/" + rig + "/wrench");
  auto options = node_options<rendering_node::Options>(rig);
  options.scene = scene.file;
  NodeThread node(
      [&](const std::atomic<bool>& stop) { return rendering_node::run(options, stop); });
  ASSERT_TRUE(wait_until([&] { return node.status() >= 0; })) << "it runs";
  EXPECT_EQ(node.status(), 1);
  EXPECT_NE(node.error().find("/" + rig + "/wrench"), std::string::npos) << node.error();
}

}  // namespace
}  // namespace voxtouch::test
