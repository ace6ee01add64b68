// A ring in real time with a hand led by a page. The page is a participant of the test.
#include <gtest/gtest.h>

#include <cmath>

#include "core/scene/scene_file.hpp"
#include "devices/driver.hpp"
#include "nodes/coupling/coupling_node.hpp"
#include "nodes/device/device_node.hpp"
#include "nodes/rendering/rendering_node.hpp"
#include "tests/support/stand_in.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds;

/// A participant that writes targets; with a status it claims the role `page`.
struct Page {
  explicit Page(const std::string& rig)
      : stand_in(kDomain, "page", rig),
        targets(stand_in.participant, qos::kOperatorTarget, rig,
                qos::profile(qos::kOperatorTarget.profile)) {}
  void aim(std::uint64_t session, const Vec3& at) {
    msg::OperatorTarget target{};
    target.session_id = session, target.sequence_number = sequence++;
    target.pose.position = {at.x(), at.y(), at.z()};
    target.pose.orientation = {0.0, 0.0, 0.0, 1.0};
    targets.write(target);
  }
  StandIn stand_in;
  bus::Writer<msg::OperatorTarget> targets;
  std::uint64_t sequence = 0;
};

template <class Options>
struct Node {
  Node(Options o, int (*run)(const Options&, const std::atomic<bool>&))
      : options(std::move(o)),
        thread([this, run](const std::atomic<bool>& stop) { return run(options, stop); }) {}
  Options options;
  NodeThread thread;
};

device_node::Options led_device(const std::string& rig, const bus::Guid& up,
                                const std::string& scene = "plane",
                                const std::string& motion = "hit") {
  auto o = node_options<device_node::Options>(rig, scene);
  o.hand.from_page = true;
  o.motion = motion;
  o.up = up;
  return o;
}

class LedHand : public testing::Test {
 protected:
  explicit LedHand(const std::string& scene = "plane", const std::string& motion = "hit")
      : up(kDomain, rig),
        listener({kDomain, "lo", "listener"}),
        registry(listener, rig),
        states(listener, qos::kDeviceState, rig, qos::profile(qos::ProfileId::kTap)),
        rendering(node_options<rendering_node::Options>(rig, scene), rendering_node::run),
        coupling(node_options<coupling_node::Options>(rig, scene), coupling_node::run),
        device(led_device(rig, up.participant.guid(), scene, motion), device_node::run) {
    // Of the ring's nodes only the device checks the roles; the others report.
    EXPECT_TRUE(sees([&] { return report("rendering") && report("coupling") && state.session_id; }))
        << device.thread.error();
    name({});
    EXPECT_TRUE(sees([&] { return number("samples") > 500.0; }));
  }
  /// The ring's nodes, and these pages.
  void name(const std::vector<Page*>& pages) {
    std::vector<std::pair<std::string, bus::Guid>> players = {
        {"rendering", report("rendering")->participant},
        {"coupling", report("coupling")->participant}};
    for (const Page* page : pages)
      players.emplace_back("page", page->stand_in.participant.guid());
    up.name(players);
  }
  void poll() {
    registry.update();
    states.take_each([this](const msg::DeviceState& s) { state = s; });
  }
  bool sees(const std::function<bool()>& holds) {
    return wait_until([&] { return poll(), holds(); }, std::chrono::seconds(20));
  }
  std::optional<runtime::NodeReport> report(const char* node) { return registry.find(node); }
  double number(const char* figure) {
    const auto device_report = report("device");
    return device_report ? runtime::value_of(device_report->figures, figure) : 0.0;
  }
  /// The page that leads the hand, as reported by the device.
  std::string leader() {
    auto device_report = report("device");
    return device_report ? device_report->values["hand_from"] : "";
  }
  bool sees_leader() {
    return sees([&] { return !leader().empty() && leader() != "no page"; });
  }
  /// 60 targets a second for so long.
  void aim(Page& page, std::uint64_t session, const Vec3& at, milliseconds duration) {
    const auto until = std::chrono::steady_clock::now() + duration;
    while (std::chrono::steady_clock::now() < until) {
      page.aim(session, at);
      poll();
      std::this_thread::sleep_for(milliseconds(16));
    }
  }
  Vec3 tip() const { return {state.pose.position.x, state.pose.position.y, state.pose.position.z}; }

  const std::string rig = own_rig("h");
  StandInUp up;
  bus::Participant listener;
  runtime::NodeRegistry registry;
  bus::Reader<msg::DeviceState> states;
  Node<rendering_node::Options> rendering;
  Node<coupling_node::Options> coupling;
  Node<device_node::Options> device;
  msg::DeviceState state{};
};

constexpr double kFrictionM = 0.002;  ///< of the device, over the hand's stiffness

TEST_F(LedHand, FollowsItsPageOnly) {
  const Vec3 start = tip();
  Page unauthorised(rig), page(rig);
  page.stand_in.say(state.session_id), unauthorised.stand_in.say(state.session_id);
  aim(unauthorised, state.session_id, start + Vec3(0.03, 0.0, 0.0), milliseconds(600));
  EXPECT_LT((tip() - start).norm(), 1e-4) << "none has named it";
  EXPECT_EQ(number("operator_targets"), 0.0);

  name({&page});
  ASSERT_TRUE(sees_leader());
  aim(page, state.session_id, start + Vec3(0.0, 0.0, 0.02), milliseconds(1'000));
  EXPECT_LT((tip() - start - Vec3(0.0, 0.0, 0.02)).norm(), kFrictionM);
  EXPECT_GT(number("operator_targets"), 20.0);

  const Vec3 before = tip();
  aim(unauthorised, state.session_id, start, milliseconds(1'000));
  EXPECT_LT((tip() - before).norm(), 1e-4) << "the hand rests";
  EXPECT_GT(number("foreign_targets"), 20.0);
  EXPECT_TRUE(sees([&] { return report("device")->message.find("refused") != std::string::npos; }))
      << report("device")->message;
}

TEST_F(LedHand, IgnoresTargetsOfAnotherSession) {
  Page page(rig);
  page.stand_in.say(state.session_id);
  name({&page});
  ASSERT_TRUE(sees_leader());
  const Vec3 start = tip();
  aim(page, state.session_id + 1, start + Vec3(0.0, 0.0, 0.02), milliseconds(600));
  EXPECT_LT((tip() - start).norm(), 1e-4);
  EXPECT_EQ(number("operator_targets"), 0.0);
}

TEST_F(LedHand, RestsInContactOnceItsPageHasGone) {
  std::optional<Page> page(std::in_place, rig);
  page->stand_in.say(state.session_id);
  name({&*page});
  ASSERT_TRUE(sees_leader());
  const scene::Scene plane = scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
  const Vec3 into = plane.device.pose_WD.orientation.conjugate() * Vec3(0.0, 0.0, -1.0);
  const Vec3 start = tip();
  bool touches = false;
  for (int mm = 1; mm < 60 && !touches; ++mm) {
    aim(*page, state.session_id, start + 1e-3 * mm * into, milliseconds(60));
    touches = number("last_second_max_force_n") > 0.5;
  }
  ASSERT_TRUE(touches);
  page.reset();
  std::this_thread::sleep_for(milliseconds(600));
  poll();
  const Vec3 rest = tip();
  for (int n = 0; n < 20; ++n) {
    std::this_thread::sleep_for(milliseconds(25));
    poll();
    EXPECT_LT((tip() - rest).norm(), 2e-4);
  }
  EXPECT_TRUE(sees([&] { return leader() == "no page"; })) << leader();
}

struct LedHandAtARigidWall : LedHand {
  LedHandAtARigidWall() : LedHand("press_virtual_tool", "press") {}
};

/// A message that no page would send: the device itself limits how hard its hand presses.
TEST_F(LedHandAtARigidWall, ForceStaysBelowItsLimit) {
  constexpr double kMaxForceN = 8.5, kFrictionN = 0.04;  // of the simulated Phantom
  const scene::Scene wall =
      scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/press_virtual_tool.yaml");
  const Vec3 into = wall.device.pose_WD.orientation.conjugate() * Vec3(0.0, 0.0, -1.0);
  Page page(rig);
  page.stand_in.say(state.session_id);
  name({&page});
  ASSERT_TRUE(sees_leader());
  aim(page, state.session_id, tip() + 10.0 * into, milliseconds(3'000));
  EXPECT_GT(number("last_second_max_force_n"), 0.25 * kMaxForceN);
  EXPECT_LT(number("last_second_max_force_n"), 0.3 * kMaxForceN + kFrictionN + 0.1);
}

std::string refusal(const std::string& device, bool lockstep) {
  device_node::Options o = led_device(own_rig("refused"), {});
  o.device = device, o.lockstep = lockstep;
  try {
    device_node::check_hand_from(o.device, o.hand, o.lockstep);
  } catch (const devices::DeviceOpenError& error) {
    return error.what();
  }
  return "";
}

TEST(HandFromPage, IsForSimulatedDevicesInRealTimeAlone) {
  for (const char* device : {"sim-phantom", "sim-lwr", "sim:touch"})
    EXPECT_EQ(refusal(device, false), "") << device;
  for (const char* device : {"phantom", "lwr", "fr3", "emulated-phantom", "emulated-lwr"})
    EXPECT_NE(refusal(device, false).find(device), std::string::npos) << device;
  EXPECT_NE(refusal("sim-phantom", true).find("--lockstep"), std::string::npos);
}

/// The node itself refuses too, before it opens anything.
TEST(HandFromPage, IsRefusedByTheNodeOfARealDevice) {
  device_node::Options o = led_device(own_rig("refused"), {});
  o.device = "phantom", o.rig_is_checked = true;
  const std::atomic<bool> stop{false};
  EXPECT_THROW(device_node::run(o, stop), devices::DeviceOpenError);
}

}  // namespace
}  // namespace voxtouch::test
