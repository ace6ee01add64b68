// The ring under --security, in real time and in contact, beside those whom it has to keep out.
#include <gtest/gtest.h>

#include <fstream>

#include "nodes/runtime/node_registry.hpp"
#include "nodes/security/key_folder.hpp"
#include "nodes/security/make_keys.hpp"
#include "tests/ring/ring_run.hpp"
#include "tests/support/adversary.hpp"
#include "tests/support/stand_in.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds, std::chrono::seconds;
constexpr char kRig[] = "haptic";

std::uint32_t domain() { return static_cast<std::uint32_t>(std::stoul(fresh_domain())); }

bool wait_until(const std::function<bool()>& holds, milliseconds patience = seconds(20)) {
  const auto until = std::chrono::steady_clock::now() + patience;
  while (!holds() && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(milliseconds(10));
  return holds();
}

bus::ParticipantOptions with(const security::Properties& properties) { return {domain(), "lo", "adversary", {}, {}, properties}; }

/// A tool's certificate in hands that do not keep to the rules: its own DDS lets it write what it likes.
security::Properties lawless_tool(const std::filesystem::path& keys, const std::filesystem::path& rules) {
  using namespace security;
  const Signer authority{certificate_of(read_file(keys / "ca.cert.pem"), "ca"), key_of(read_file(keys / kAuthorityKey), "key")};
  std::string lax = verified(read_file(keys / "governance.p7s"), *authority.certificate, "governance");
  const std::string limited = "<enable_write_access_control>true<";
  lax.replace(lax.find(limited), limited.size(), "<enable_write_access_control>false<");
  std::ofstream(rules) << sign(authority, lax);
  Properties properties = properties_of(keys, "tool", kRig);
  for (auto& [name, value] : properties)
    if (name == "dds.sec.access.governance") value = "file:" + rules.string();
  return properties;
}

/// What each of the loop's topics would take if it came from the node that it should.
void write_everything(Adversary& a, const msg::DeviceState& newest) {
  msg::DeviceState s = newest;
  ++s.sequence_number, s.sample_time_ns += 1'000'000;
  a.write(s);
  msg::ContactState c{};
  c.session_id = s.session_id, c.sequence_number = s.sequence_number, c.sample_time_ns = s.sample_time_ns, c.wrench.force.z = 8.0;
  a.write(c);
  msg::ForceCommand f{};
  f.session_id = s.session_id, f.sequence_number = s.sequence_number, f.sample_time_ns = s.sample_time_ns;
  f.valid_until_ns = s.sample_time_ns + 10'000'000, f.wrench.force.z = 8.0;
  a.write(f);
  a.write(stylus(s.session_id));
  for (const char* node : {"up", "device", "rendering", "coupling"}) a.claim(node, s.session_id);
}

/// What the ring's own readers had of others than those that they follow; -1: nobody says.
double foreign(const runtime::NodeRegistry& registry) {
  double all = 0;
  for (const auto& [node, figure] : {std::pair("device", "foreign_commands"), std::pair("coupling", "foreign_samples"), std::pair("rendering", "foreign_samples")}) {
    const auto report = registry.find(node);
    if (!report || !report->figures.contains(figure)) return -1;
    all += report->figures.at(figure).value + report->figures.at("refused_statuses").value;
  }
  return all;
}

std::string text_of(const runtime::NodeRegistry& registry) {
  std::string text;
  for (const auto& report : registry.reports()) text += report.node + ": " + report.message + "\n";
  return text;
}

struct Strangers {
  explicit Strangers(const std::vector<security::Properties>& all) {
    for (const security::Properties& one : all) adversaries.push_back(std::make_unique<Adversary>(with(one), kRig));
  }
  void write(const msg::DeviceState& newest) {
    for (const auto& one : adversaries) write_everything(*one, newest);
  }
  std::vector<std::unique_ptr<Adversary>> adversaries;
};

/// A ring of cup_friction in contact, beside `strangers`, who claim its roles before it starts and write everything while it runs.
struct RunBesideStrangers {
  RunBesideStrangers(const std::vector<std::string>& options, const security::Properties& of_observer, const std::vector<security::Properties>& of_strangers)
      : strangers(of_strangers), observer(with(of_observer)) {
    strangers.write({});
    up.emplace(up_arguments(shipped_scene("cup_friction"), options));
    runtime::NodeRegistry registry(observer, kRig);
    bus::Reader<msg::DeviceState> states(observer, qos::kDeviceState, kRig, qos::profile(qos::ProfileId::kTap));
    msg::DeviceState newest{};
    const auto look = [&] {
      registry.update();
      while (states.take(newest)) {
      }
      strangers.write(newest);
    };
    started = wait_until([&] { return look(), !up->running() || runs(*up); }) && up->running();
    const auto until = std::chrono::steady_clock::now() + milliseconds(3500);
    while (up->running() && std::chrono::steady_clock::now() < until) {
      look();
      foreign_samples = std::max(foreign_samples, foreign(registry));
      seen = std::max(seen, registry.reports().size());
      said = text_of(registry);
      std::this_thread::sleep_for(milliseconds(2));
    }
    samples = newest.sequence_number;
  }
  Strangers strangers;
  bus::Participant observer;
  std::optional<Process> up;
  bool started = false;
  double foreign_samples = -1;
  std::size_t seen = 0;
  std::uint64_t samples = 0;
  std::string said;
};

TEST(SecuredRing, RunsInContactWithAllItsLinksAndTakesNothingOfStrangers) {
  const TemporaryFolder folder;
  const auto keys = folder / "keys", others = folder / "others";
  security::make_keys(keys, kRig, 30);
  security::make_keys(others, kRig, 30);
  const std::string bag = (folder / "bag").string();
  RunBesideStrangers run({"--motion", "slide", "--duration", "5", "--record", bag, "--security", keys.string()}, security::properties_of(keys, "tool", kRig),
                         {{}, security::properties_of(others, "coupling", kRig), lawless_tool(keys, folder / "lax.p7s")});
  ASSERT_TRUE(run.started) << run.up->err();
  Process change({VOXTOUCH_BIN "/voxtouch", "change", "friction", "gain", "0.5", "--domain", fresh_domain(), "--security", keys.string()});
  const Finished changed = change.wait(), end = run.up->wait();
  EXPECT_EQ(changed.status, 0) << changed.out << changed.err;
  const auto summary = parse_summary(end.out);
  EXPECT_EQ(end.status, 0) << end.out << end.err;
  EXPECT_EQ(run.foreign_samples, 0.0) << run.said;
  EXPECT_GE(run.seen, 6U) << "the ring's nodes and `up` as a tool hears them: " << run.said;
  EXPECT_GT(run.samples, 1000U);
  const auto contacts = read_ring_topic<msg::ContactState>(bag, "/haptic/rendering/contact");
  EXPECT_GT(std::ranges::count_if(contacts, [](const auto& c) { return std::abs(c.wrench.force.z) > 0; }), 500);
  EXPECT_GT(read_ring_topic<msg::ForceCommand>(bag, "/haptic/coupling/command").size(), 2000U);
  EXPECT_GT(read_ring_topic<msg::DeviceState>(bag, "/haptic/device/state").size(), 2000U);
}

/// The same strangers beside the same ring without --security: that the test above would see them.
TEST(SecuredRing, IsNeededPlainStrangersKeepAPlainRingFromStarting) {
  RunBesideStrangers run({"--motion", "slide", "--duration", "3", "--no-record"}, {}, {{}});
  EXPECT_FALSE(run.started);
  EXPECT_TRUE(run.up->wait().err.contains("is in use"));
}

TEST(SecuredRing, RefusesToStartHalf) {
  const TemporaryFolder folder;
  const auto keys = folder / "keys";
  security::make_keys(keys, kRig, 30);
  const auto refused = [&](const std::vector<std::string>& more, const std::string& words) {
    std::vector<std::string> arguments = more;
    arguments.insert(arguments.begin(), std::string(VOXTOUCH_BIN) + "/" + arguments.front()), arguments.erase(arguments.begin() + 1);
    arguments.insert(arguments.end(), {"--domain", fresh_domain()});
    Process process(arguments);
    const Finished end = process.wait(seconds(20));
    EXPECT_NE(end.status, 0) << arguments[0];
    EXPECT_TRUE(end.err.contains(words)) << end.err;
    EXPECT_FALSE(end.err.contains("starting")) << end.err;
  };
  const std::string scene = shipped_scene("cup"), used = keys.string();
  refused({"voxtouch", "up", scene, "--security", (folder / "none").string()}, "is no folder");
  refused({"voxtouch", "status", "--security", (folder / "none").string()}, "is no folder");
  refused({"voxtouch", "up", scene, "--security="}, "--security");
  refused({"voxtouch", "up", scene, "--security", used, "--rig", "left"}, "'left.");
  std::filesystem::remove(keys / "validator" / "key.pem");
  refused({"voxtouch", "up", scene, "--security", used}, "validator/key.pem is missing");
  std::filesystem::permissions(keys / "coupling" / "key.pem", std::filesystem::perms::others_read, std::filesystem::perm_options::add);
  refused({"voxtouch_coupling", "--scene", scene, "--security", used}, "others may read");
  security::revoke_keys(keys, "rendering");
  refused({"voxtouch_rendering", "--scene", scene, "--security", used}, "was revoked");
  std::filesystem::remove(keys / "tool" / "cert.pem");
  refused({"voxtouch", "status", "--security", used}, "tool/cert.pem is missing");
}

/// crl.pem is read when a participant starts: those that run stay as they are, and who starts with the new list takes the revoked in no more.
TEST(SecuredRing, TakesNobodyInWhoIsRevoked) {
  const TemporaryFolder folder;
  const auto keys = folder / "keys";
  security::make_keys(keys, kRig, 30);
  const security::Properties lost = security::properties_of(keys, "device", kRig);  // names files: the certificate, and another list
  const auto old_list = folder / "old.pem";
  std::filesystem::copy_file(keys / "crl.pem", old_list);
  security::Properties thief = lost;
  for (auto& [name, value] : thief)
    if (name.ends_with(".crl")) value = "file:" + old_list.string();
  const bus::Participant before(with(security::properties_of(keys, "tool", kRig)));
  bus::Reader<msg::DeviceState> reader_before(before, qos::kDeviceState, kRig, qos::profile(qos::ProfileId::kTap));
  const auto hears = [](auto& reader, Adversary& who) {
    return wait_until([&] {
      msg::DeviceState state{};
      who.write(state);
      return reader.take(state);
    }, seconds(3));
  };
  Adversary trusted(with(thief), kRig);
  EXPECT_TRUE(hears(reader_before, trusted)) << "before";
  security::revoke_keys(keys, "device");
  EXPECT_TRUE(hears(reader_before, trusted)) << "who runs is not told";
  const bus::Participant after(with(security::properties_of(keys, "tool", kRig)));
  bus::Reader<msg::DeviceState> reader_after(after, qos::kDeviceState, kRig, qos::profile(qos::ProfileId::kTap));
  EXPECT_FALSE(hears(reader_after, trusted)) << "who started since takes nothing of the revoked one";
  security::renew_keys(keys, "device", 30);
  Adversary renewed(with(security::properties_of(keys, "device", kRig)), kRig);
  EXPECT_TRUE(hears(reader_after, renewed));
}

}  // namespace
}  // namespace voxtouch::test
