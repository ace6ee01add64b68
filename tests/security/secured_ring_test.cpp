// The ring under --security, in real time and in contact, next to unauthorised participants.
#include <gtest/gtest.h>

#include "nodes/runtime/node_registry.hpp"
#include "nodes/security/key_folder.hpp"
#include "nodes/security/make_keys.hpp"
#include "tests/ring/ring_run.hpp"
#include "tests/support/adversary.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds, std::chrono::seconds;
constexpr char kRig[] = "haptic";

std::uint32_t domain() { return static_cast<std::uint32_t>(std::stoul(fresh_domain())); }

bool wait_until(const std::function<bool()>& holds, milliseconds patience = seconds(20)) {
  const auto until = std::chrono::steady_clock::now() + patience;
  bool is_so = holds();
  while (!is_so && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(milliseconds(10));
    is_so = holds();
  }
  return is_so;
}

bus::ParticipantOptions with(const security::Properties& properties) {
  return {domain(), "lo", "adversary", {}, {}, properties};
}

/// Number of samples that the ring's readers received from participants that they do not follow;
/// -1: not reported.
double foreign(const runtime::NodeRegistry& registry) {
  double all = 0;
  for (const auto& [node, figure] :
       {std::pair("device", "foreign_commands"), std::pair("coupling", "foreign_samples"),
        std::pair("rendering", "foreign_samples")}) {
    const auto report = registry.find(node);
    if (!report || !report->figures.contains(figure))
      return -1;
    all += report->figures.at(figure).value + report->figures.at("refused_statuses").value;
  }
  return all;
}

std::string text_of(const runtime::NodeRegistry& registry) {
  std::string text;
  for (const auto& report : registry.reports())
    text += report.node + ": " + report.message + "\n";
  return text;
}

/// Separate processes: one with a plain and a secured participant in the same domain crashes in
/// Cyclone DDS 0.10.2.
struct Unauthorised {
  explicit Unauthorised(const std::vector<std::vector<std::string>>& all) {
    for (std::vector<std::string> arguments : all) {
      arguments.insert(arguments.begin(), {VOXTOUCH_BIN "/voxtouch_unauthorised", fresh_domain()});
      processes.push_back(std::make_unique<Process>(arguments));
    }
    for (const auto& one : processes)
      EXPECT_TRUE(wait_until([&] { return one->err().contains("writes"); })) << one->err();
  }
  std::vector<std::unique_ptr<Process>> processes;
};

/// A ring of cup_friction in contact, next to `unauthorised`, which claim its roles before it
/// starts and write everything while it runs.
struct RunNextToUnauthorised {
  RunNextToUnauthorised(const std::vector<std::string>& options,
                        const security::Properties& of_observer,
                        const std::vector<std::vector<std::string>>& of_unauthorised)
      : unauthorised(of_unauthorised),
        observer(with(of_observer)) {
    up.emplace(up_arguments(shipped_scene("cup_friction"), options));
    runtime::NodeRegistry registry(observer, kRig);
    bus::Reader<msg::DeviceState> states(observer, qos::kDeviceState, kRig,
                                         qos::profile(qos::ProfileId::kTap));
    msg::DeviceState newest{};
    const auto poll = [&] {
      registry.update();
      while (states.take(newest)) {
      }
    };
    started = wait_until([&] { return poll(), !up->running() || runs(*up); }) && up->running();
    const auto until = std::chrono::steady_clock::now() + milliseconds(2500);
    while (up->running() && std::chrono::steady_clock::now() < until) {
      poll();
      foreign_samples = std::max(foreign_samples, foreign(registry));
      seen = std::max(seen, registry.reports().size());
      said = text_of(registry);
      std::this_thread::sleep_for(milliseconds(2));
    }
    samples = newest.sequence_number;
  }
  Unauthorised unauthorised;
  bus::Participant observer;
  std::optional<Process> up;
  bool started = false;
  double foreign_samples = -1;
  std::size_t seen = 0;
  std::uint64_t samples = 0;
  std::string said;
};

TEST(SecuredRing, RunsInContactAndRejectsUnauthorisedPeers) {
  const TemporaryFolder folder;
  const auto keys = folder / "keys", others = folder / "others";
  security::make_keys(keys, kRig, 30);
  security::make_keys(others, kRig, 30);
  const std::string bag = (folder / "bag").string();
  RunNextToUnauthorised run(
      {"--motion", "slide", "--duration", "4.5", "--record", bag, "--security", keys.string()},
      security::properties_of(keys, "tool", kRig),
      {{},
       {others.string(), "coupling"},
       {keys.string(), "tool", (folder / "lax").string()},
       {keys.string(), "tool", (folder / "all").string(), others.string()}});
  ASSERT_TRUE(run.started) << run.up->err();
  Process change({VOXTOUCH_BIN "/voxtouch", "change", "friction", "gain", "0.5", "--domain",
                  fresh_domain(), "--security", keys.string()});
  const Finished changed = change.wait(), end = run.up->wait();
  EXPECT_EQ(changed.status, 0) << changed.out << changed.err;
  const auto summary = parse_summary(end.out);
  EXPECT_EQ(end.status, 0) << end.out << end.err;
  EXPECT_EQ(run.foreign_samples, 0.0) << run.said;
  EXPECT_GE(run.seen, 6U) << "the ring's nodes and `up` as a tool receives them: " << run.said;
  EXPECT_GT(run.samples, 1000U);
  const auto contacts = read_ring_topic<msg::ContactState>(bag, "/haptic/rendering/contact");
  EXPECT_GT(
      std::ranges::count_if(contacts, [](const auto& c) { return std::abs(c.wrench.force.z) > 0; }),
      500);
  EXPECT_GT(read_ring_topic<msg::ForceCommand>(bag, "/haptic/coupling/command").size(), 2000U);
  EXPECT_GT(read_ring_topic<msg::DeviceState>(bag, "/haptic/device/state").size(), 2000U);
}

/// Called by processes, for the reason above.
TEST(SecuredRing, AnswersOnlyToolsWithItsKeys) {
  const TemporaryFolder folder;
  const auto keys = folder / "keys", others = folder / "others";
  security::make_keys(keys, kRig, 30);
  security::make_keys(others, kRig, 30);
  Process up(up_arguments(
      shipped_scene("cup_friction"),
      {"--motion", "slide", "--duration", "0", "--no-record", "--security", keys.string()}));
  ASSERT_TRUE(wait_until([&] { return !up.running() || runs(up); })) << up.err();
  const auto asks = [](double gain, const std::vector<std::string>& with) {
    std::vector<std::string> arguments = {VOXTOUCH_BIN "/voxtouch_asker", fresh_domain(),
                                          std::to_string(gain)};
    arguments.insert(arguments.end(), with.begin(), with.end());
    return Process(arguments).wait(seconds(60));
  };
  const Finished tool = asks(0.8, {keys.string(), "tool"});
  EXPECT_EQ(tool.out, "is 1\nset true\nis 0.8\nchanged true\nis 0.4\n") << tool.err;
  for (const std::vector<std::string>& with :
       {std::vector<std::string>{}, {others.string(), "tool"}, {keys.string(), "validator"}}) {
    const Finished end = asks(0.1, with);
    EXPECT_TRUE(end.out.starts_with("no server")) << end.out << end.err;
  }
  const Finished again = asks(0.4, {keys.string(), "tool"});
  EXPECT_EQ(again.out, "is 0.4\nset true\nis 0.4\nchanged true\nis 0.2\n") << again.err;
  EXPECT_TRUE(up.running());
  up.signal(SIGINT);
  EXPECT_EQ(up.wait().status, 0);
}

/// A plain unauthorised participant next to the same ring without --security: shows that the test
/// above would detect it.
TEST(SecuredRing, PlainRingIsBlockedByUnauthorisedPeers) {
  const TemporaryFolder folder;
  security::make_keys(
      folder / "keys", kRig,
      30);  // of the observer alone: a plain one and a secured one do not live in one process
  RunNextToUnauthorised run({"--motion", "slide", "--duration", "3", "--no-record"},
                            security::properties_of(folder / "keys", "tool", kRig), {{}});
  EXPECT_FALSE(run.started);
  EXPECT_TRUE(run.up->wait().err.contains(std::string("'") + kRig + "'"));
}

TEST(SecuredRing, RefusesToStartWithIncompleteKeys) {
  const TemporaryFolder folder;
  const auto keys = folder / "keys";
  security::make_keys(keys, kRig, 30);
  const auto refused = [&](const std::vector<std::string>& more, const std::string& words) {
    std::vector<std::string> arguments = more;
    arguments.insert(arguments.begin(), std::string(VOXTOUCH_BIN) + "/" + arguments.front()),
        arguments.erase(arguments.begin() + 1);
    arguments.insert(arguments.begin() + 1 + (arguments[1][0] != '-'),
                     {"--domain", fresh_domain()});
    Process process(arguments);
    const Finished end = process.wait(seconds(20));
    EXPECT_NE(end.status, 0) << arguments[0];
    EXPECT_TRUE(end.err.contains(words)) << end.err;
    EXPECT_FALSE(end.err.contains("starting")) << end.err;
  };
  const std::string scene = shipped_scene("cup"), used = keys.string();
  refused({"voxtouch", "up", scene, "--security", (folder / "none").string()}, "/none");
  refused({"voxtouch", "status", "--security", (folder / "none").string()}, "/none");
  refused({"voxtouch", "up", scene, "--security", ""}, "--security");
  refused({"voxtouch", "up", scene, "--security", used, "--rig", "left"}, "'left.");
  refused({"voxtouch", "up", scene, "--security", used, "--one-process"}, "certificate");
  std::filesystem::remove(keys / "validator" / "key.pem");
  refused({"voxtouch", "up", scene, "--security", used}, "validator/key.pem");
  std::filesystem::permissions(keys / "coupling" / "key.pem", std::filesystem::perms::others_read,
                               std::filesystem::perm_options::add);
  refused({"voxtouch_coupling", "--scene", scene, "--security", used}, "readable by other users");
  security::revoke_keys(keys, "rendering");
  refused({"voxtouch_rendering", "--scene", scene, "--security", used}, "is revoked");
  std::filesystem::remove(keys / "tool" / "cert.pem");
  refused({"voxtouch", "status", "--security", used}, "tool/cert.pem");
}

/// crl.pem is read when a participant starts. Running participants are unaffected; one that starts
/// with the new list rejects the revoked one.
TEST(SecuredRing, RefusesARevokedParticipant) {
  const TemporaryFolder folder;
  const auto keys = folder / "keys";
  security::make_keys(keys, kRig, 30);
  struct Listener {
    explicit Listener(const security::Properties& properties) : participant(with(properties)) {}
    bool receives(milliseconds patience = seconds(15)) {
      msg::DeviceState state{};
      while (reader.take(state)) {
      }
      return wait_until([&] { return reader.take(state); }, patience);
    }
    bus::Participant participant;
    bus::Reader<msg::DeviceState> reader{participant, qos::kDeviceState, kRig,
                                         qos::profile(qos::ProfileId::kTap)};
  };
  const security::Properties tool = security::properties_of(keys, "tool", kRig);
  Listener before(tool);
  const Unauthorised lost({{keys.string(), "device"}});
  EXPECT_TRUE(before.receives()) << "its certificate is good";
  security::revoke_keys(keys, "device");
  EXPECT_TRUE(before.receives()) << "who runs is not reported";
  Listener after(tool);
  EXPECT_FALSE(after.receives(seconds(4))) << "who started since takes nothing of the revoked one";
  security::renew_keys(keys, "device", 30);
  const Unauthorised renewed({{keys.string(), "device"}});
  EXPECT_TRUE(after.receives());
}

}  // namespace
}  // namespace voxtouch::test
