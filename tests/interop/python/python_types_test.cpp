// Processes of PyPI's cyclonedds 11 on every topic of a ring: with the types of `voxtouch types`,
// and with types of the same names that have arrays. A lookup of such a type ends every process of
// Cyclone DDS 0.10.
#include <gtest/gtest.h>

#include <signal.h>

#include <algorithm>
#include <functional>
#include <set>
#include <thread>

#include "qos/topics.hpp"
#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

using nlohmann::json;
using std::chrono::seconds;

bool wait_until(const std::function<bool()>& holds, seconds patience) {
  const auto until = std::chrono::steady_clock::now() + patience;
  while (!holds()) {
    if (std::chrono::steady_clock::now() > until)
      return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

/// How many lines of the running ring `up` has printed: one a second.
std::ptrdiff_t lines_of(const Process& up) {
  const std::string text = up.err();
  std::ptrdiff_t count = 0;
  for (std::size_t at = 0; (at = text.find(" samples  force", at)) != std::string::npos; ++at)
    ++count;
  return count;
}

/// Samples of every topic in a Python process, until it had a thousand device samples and wrote
/// one; null, with a failure, if it did not finish.
json read_by_python(const std::filesystem::path& types, const std::string& how) {
  if (!std::filesystem::exists(VOXTOUCH_PYTHON)) {
    ADD_FAILURE() << VOXTOUCH_PYTHON
        " is missing: deploy/setup installs it from PyPI, where deploy/packages.txt names what it "
        "holds.";
    return {};
  }
  Process python(
      {VOXTOUCH_PYTHON, "-B", VOXTOUCH_OTHER_TYPES, types.string(), fresh_domain(), how});
  const Finished end = python.wait(seconds(60));
  EXPECT_EQ(end.status, 0) << end.err;
  return json::parse(end.out, nullptr, false);
}

void expect_our_types_read_right(const json& topics, bool touching) {
  for (const char* stream : {"device/state", "rendering/contact", "coupling/command"}) {
    EXPECT_GT(topics[stream]["count"], 100) << stream;
    EXPECT_EQ(topics[stream]["sessions"], topics["device/state"]["sessions"]) << stream;
  }
  const json& state = topics["device/state"];
  ASSERT_EQ(state["sessions"].size(), 1U) << state["sessions"];
  EXPECT_NE(state["sessions"][0], 0);
  const auto numbers = state["numbers"].get<std::vector<std::uint64_t>>();
  EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end(), std::less_equal<>()));
  for (const double norm : state["norms"])
    ASSERT_NEAR(norm, 1.0, 1e-9);
  EXPECT_EQ(topics["rendering/contact"]["models"],
            json::array({msg::contact_state::kModelAdapted}));
  EXPECT_EQ(topics["rendering/contact"]["touching"] > 0, touching);
  EXPECT_EQ(topics["coupling/command"]["forces"] > 0.01, touching);
  EXPECT_LE(topics["coupling/command"]["forces"], 8.5);
  EXPECT_EQ(topics["node_status"]["nodes"],
            json::array({"coupling", "device", "rendering", "up", "validator"}));
  EXPECT_EQ(topics["node_status"]["participants"].size(), 5U);
  for (const char* once : {"device/description", "rendering/plan", "coupling/design"})
    EXPECT_EQ(topics[once]["count"], 1) << once;
  for (const char* on_demand :
       {"tf", "tf_static", "pose", "wrench", "markers", "diagnostics", "validation"})
    EXPECT_GT(topics[on_demand]["count"], 0) << on_demand;
}

class PyPIClients : public testing::TestWithParam<const char*> {};

TEST_P(PyPIClients, ReadAndWriteEveryTopicWithoutEndingTheRing) {
  const TemporaryFolder types;
  ASSERT_EQ(
      Process({VOXTOUCH_BIN "/voxtouch", "types", "--python", types.path().string()}).wait().status,
      0);
  Process up(up_arguments(shipped_scene("cup"),
                          {"--device", "sim-phantom", "--motion", GetParam(), "--no-record"}));
  ASSERT_TRUE(wait_until([&] { return lines_of(up) > 0; }, seconds(30))) << up.err();
  const std::vector<pid_t> nodes = children_of(up.pid());

  const json ours = read_by_python(types.path(), "ours");
  ASSERT_TRUE(ours.is_object());
  expect_our_types_read_right(ours["topics"], GetParam() == std::string("slide"));
  std::set<std::string> announced;
  for (const json& endpoint : ours["endpoints"]) {
    announced.insert(endpoint[0]);
    EXPECT_FALSE(endpoint[1]) << endpoint[0] << " is announced with type information";
  }
  for (const qos::Topic& topic : qos::kTopics) {
    const std::string name = qos::dds_name(topic, "haptic");
    // The scene has no effect `external`, and no page leads the hand.
    if (!topic.with_external && !topic.with_led_hand) {
      EXPECT_NE(announced.contains(name), topic.lockstep_only || topic.of_arms) << name;
    }
    EXPECT_GT(ours["matched"][name], 0) << name;  // its own reader, and the ring's
  }
  for (const char* received :
       {"rt/haptic/device/state", "rt/haptic/rendering/contact", "rt/haptic/coupling/command",
        "rt/haptic/device/description", "rt/haptic/rendering/change", "rt/haptic/node_status"})
    EXPECT_GT(ours["matched"][received], 1) << received;

  const json foreign = read_by_python(types.path(), "foreign");
  ASSERT_TRUE(foreign.is_object());
  EXPECT_EQ(foreign["matched"], ours["matched"]);
  for (const json& read : {ours, foreign})
    EXPECT_GT(read["written"], 10 * std::size(qos::kTopics));

  const auto before = lines_of(up);
  EXPECT_TRUE(wait_until([&] { return lines_of(up) > before + 1; }, seconds(10)))
      << "the ring stands still\n"
      << up.err();
  EXPECT_EQ(children_of(up.pid()), nodes) << up.err();
  up.signal(SIGINT);
  const Finished end = up.wait();
  EXPECT_LT(end.status, 128) << end.err;
  const json summary = parse_summary(end.out);
  ASSERT_TRUE(summary.is_object()) << end.out;
  EXPECT_GT(summary["samples"], 5000) << end.err;
}

INSTANTIATE_TEST_SUITE_P(InContactAndOutOfIt, PyPIClients, testing::Values("slide", "free"),
                         [](const auto& motion) { return std::string(motion.param); });

}  // namespace
}  // namespace voxtouch::test
