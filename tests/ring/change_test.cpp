// A ring that is changed while it runs: nothing is felt of it but the change itself, and in lockstep it gives the same bits.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <thread>

#include "nodes/bag/bag_hash.hpp"
#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/runtime/strings.hpp"
#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds;
using namespace msg::effect_change;
constexpr double kDamping = 2.0;

/// plane.yaml as through oil, in a folder of the test.
std::string oily_plane(const TemporaryFolder& folder) {
  std::ifstream in(shipped_scene("plane"));
  std::stringstream text;
  text << in.rdbuf();
  std::string scene = text.str();
  const auto replace = [&](const std::string& from, const std::string& to) {
    for (std::size_t at = 0; (at = scene.find(from, at)) != std::string::npos; at += to.size()) scene.replace(at, from.size(), to);
  };
  replace("../meshes", std::string(VOXTOUCH_DEPLOY) + "/meshes");
  replace("effects: []", "effects: [{viscosity: {damping_ns_per_m: 2}}]");
  const auto file = folder / "oily_plane.yaml";
  std::ofstream(file) << scene;
  return file.string();
}

struct Wish {
  std::uint32_t action = 0;
  double value = 0.0;
  std::uint64_t from_sample = 0;
  double voxel_size_m = 0.0;
  std::string effect = "viscosity", parameter = {};
};

/// Sends wishes to the ring of this test's domain and waits for their last answers.
class Asker {
 public:
  Asker()
      : participant_({static_cast<std::uint32_t>(std::stoul(fresh_domain())), "lo", "asker"}),
        changes_(participant_, qos::kEffectChange, "haptic", qos::profile(qos::kEffectChange.profile)),
        answers_(participant_, qos::kEffectChanged, "haptic", qos::profile(qos::kEffectChanged.profile)) {}

  bool find() {
    return until([&] { return changes_.matched_count() > 0 && answers_.matched_count() > 0; });
  }
  void send(const Wish& w) {
    msg::EffectChange m{};
    const std::string model;
    m.request = ++sent_;
    m.action = w.action;
    m.value[0] = w.value;
    m.from_sample = w.from_sample;
    m.voxel_size_m = w.voxel_size_m;
    m.effect = runtime::lend(w.effect), m.parameter = runtime::lend(w.parameter), m.model = runtime::lend(model);
    changes_.write(m);
  }
  /// Whether all that was sent was done.
  bool all_done() {
    std::map<std::uint64_t, std::uint32_t> results;
    until([&] {
      answers_.take_each([&](const msg::EffectChanged& a) {
        if (a.result == msg::effect_changed::kResultRefused) problems += std::string(a.sentence) + "\n";
        if (a.result != msg::effect_changed::kResultWaiting) results[a.request] = a.result;
      });
      return results.size() == sent_;
    });
    return results.size() == sent_ && problems.empty();
  }
  std::string problems;

 private:
  static bool until(const std::function<bool()>& holds) {
    for (int i = 0; i < 15'000 && !holds(); ++i) std::this_thread::sleep_for(milliseconds(2));
    return holds();
  }
  bus::Participant participant_;
  bus::Writer<msg::EffectChange> changes_;
  bus::Reader<msg::EffectChanged> answers_;
  std::uint64_t sent_ = 0;
};

/// A lockstep run of `scene` with `wishes`, recorded under `name`.
void lockstep(const TemporaryFolder& folder, const std::string& name, const std::string& motion,
              const std::vector<Wish>& wishes, std::vector<std::string> more = {}) {
  more.insert(more.end(), {"--lockstep", "--motion", motion, "--duration", "5", "--record", (folder / name).string()});
  Asker asker;
  Process up(up_arguments(oily_plane(folder), more));
  ASSERT_TRUE(asker.find());
  for (const Wish& wish : wishes) asker.send(wish);
  EXPECT_TRUE(asker.all_done()) << asker.problems;
  const Finished end = up.wait(std::chrono::seconds(120));
  ASSERT_EQ(end.status, 0) << end.err << end.out;
  const auto summary = parse_summary(end.out);
  EXPECT_EQ(summary["validator"]["disagree"], 0);
  EXPECT_GT(summary["validator"]["decided"], 0);
}

std::map<std::string, bag::TopicHash> hashes(const std::filesystem::path& folder) {
  const auto bag = bag::BagReader::open(folder);
  if (!bag) throw std::runtime_error(bag.error().sentence);
  std::map<std::string, bag::TopicHash> all;
  for (const char* topic : {"device/state", "rendering/contact", "coupling/command", "validation", "rendering/plan", "coupling/design"}) {
    const bool latched = std::string(topic) == "rendering/plan" || std::string(topic) == "coupling/design";
    const auto hash = bag::hash_topic(*bag, std::string("/haptic/") + topic, latched ? bag::KeyOf{} : bag::ring_sequence_number);
    if (!hash) throw std::runtime_error(hash.error().sentence);
    all[topic] = *hash;
  }
  return all;
}

template <class T>
double step(const T& a, const T& b) {
  return std::hypot(b.x - a.x, b.y - a.y, b.z - a.z);
}
/// Largest change of `force(message)` from one sample to the next, in [first, last).
template <class T, class F>
double largest_step(const std::vector<T>& all, std::size_t first, std::size_t last, F&& force) {
  double most = 0.0;
  for (std::size_t i = std::max<std::size_t>(first, 1); i < std::min(last, all.size()); ++i)
    most = std::max(most, step(force(all[i - 1]), force(all[i])));
  return most;
}
const auto kForce = [](const auto& m) { return m.wrench.force; };
const auto kEffects = [](const auto& m) { return m.effects_wrench.force; };

std::vector<msg::ContactState> contacts(const TemporaryFolder& folder, const std::string& name) {
  return read_ring_topic<msg::ContactState>(folder / name, "/haptic/rendering/contact");
}
std::vector<msg::ForceCommand> commands(const TemporaryFolder& folder, const std::string& name) {
  return read_ring_topic<msg::ForceCommand>(folder / name, "/haptic/coupling/command");
}

TEST(Change, OfAnEffectInContactIsNoStepOfTheForceAndGivesTheSameBitsTwice) {
  const TemporaryFolder folder;
  const std::vector<Wish> wishes = {{kActionSwitch, 0.0, 1500},
                                    {kActionSwitch, 1.0, 2000},
                                    {kActionValue, 0.5, 2500, 0.0, "viscosity", "damping_ns_per_m"},
                                    {kActionGain, 0.3, 2600}};
  lockstep(folder, "plain", "slide", {});
  lockstep(folder, "first", "slide", wishes);
  lockstep(folder, "second", "slide", wishes, {"--one-process"});
  const auto plain = contacts(folder, "plain"), changed = contacts(folder, "first");
  ASSERT_EQ(changed.size(), 5000U);
  EXPECT_GT(changed[1499].surface_hits, 0U) << "in contact";
  EXPECT_GT(std::abs(changed[1499].effects_wrench.force.x), 0.1);
  for (std::size_t i = 0; i < 1500; ++i) ASSERT_EQ(plain[i].wrench.force.x, changed[i].wrench.force.x) << i;
  EXPECT_EQ(changed[1650].effects_wrench.force.x, 0.0);
  EXPECT_LT(changed[2200].effects_wrench.force.x, -0.1);
  // The tool moves at up to 0.1 m/s: a ramp of a tenth of a second takes at most this much a sample.
  const double ramp = kDamping * 0.1 * 0.001 / 0.1, before = largest_step(plain, 1400, 3000, kEffects);
  EXPECT_LE(largest_step(changed, 1400, 3000, kEffects), before + ramp);
  const double felt_before = largest_step(commands(folder, "plain"), 1400, 3000, kForce),
               felt = largest_step(commands(folder, "first"), 1400, 3000, kForce);
  RecordProperty("largest_step_n", std::to_string(felt));
  RecordProperty("largest_step_without_a_change_n", std::to_string(felt_before));
  std::printf("largest step of the command: %.5f N, without a change %.5f N; a ramp may add %.5f N\n", felt, felt_before, ramp);
  EXPECT_LE(felt, felt_before + ramp);
  const auto first = hashes(folder / "first"), second = hashes(folder / "second");
  for (const auto& [topic, hash] : first) EXPECT_TRUE(hash == second.at(topic)) << topic;
  EXPECT_FALSE(first.at("rendering/contact") == hashes(folder / "plain").at("rendering/contact"));
}

TEST(Change, ToASceneThatWasBuiltAnewInContactIsNoStepOfTheForceAndGivesTheSameBitsTwice) {
  const TemporaryFolder folder;
  const std::vector<Wish> wishes = {{kActionReload, 0.0, 4000, 0.0015, ""}};
  lockstep(folder, "plain", "hit", {});
  lockstep(folder, "first", "hit", wishes);
  lockstep(folder, "second", "hit", wishes, {"--one-process"});
  const auto plain = contacts(folder, "plain"), changed = contacts(folder, "first");
  ASSERT_EQ(changed.size(), 5000U);
  EXPECT_EQ(plain[3999].wrench.force.z, changed[3999].wrench.force.z);
  EXPECT_GT(changed[3999].wrench.force.z, 0.1) << "in contact";
  const double way = std::abs(changed[4250].wrench.force.z - changed[3999].wrench.force.z);
  EXPECT_GT(way, 0.05) << "the two scenes must differ, or nothing is shown";
  const double fade = 1.5 * way * 0.001 / 0.2, before = largest_step(plain, 3900, 4900, kForce);
  std::printf("contact: %.4f N to %.4f N, largest step %.5f N, without a change %.5f N, a fade may add %.5f N\n",
              changed[3999].wrench.force.z, changed[4250].wrench.force.z, largest_step(changed, 3900, 4900, kForce), before, fade);
  EXPECT_LE(largest_step(changed, 3900, 4900, kForce), before + fade);
  const double felt_before = largest_step(commands(folder, "plain"), 3900, 4900, kForce),
               felt = largest_step(commands(folder, "first"), 3900, 4900, kForce);
  std::printf("command: largest step %.5f N, without a change %.5f N\n", felt, felt_before);
  EXPECT_LE(felt, felt_before + fade);
  for (std::size_t i = 0; i < changed.size(); ++i)
    ASSERT_EQ((changed[i].flags & msg::contact_state::kFlagFading) != 0, i >= 4000 && i < 4200) << i;
  const auto first = hashes(folder / "first"), second = hashes(folder / "second");
  for (const auto& [topic, hash] : first) EXPECT_TRUE(hash == second.at(topic)) << topic;
  EXPECT_EQ(first.at("rendering/plan").messages, 2U);
  EXPECT_EQ(first.at("coupling/design").messages, 2U) << "designed anew for what the new scene can show";
}

TEST(Change, GarbageOnTheTopicIsNotFelt) {
  const TemporaryFolder folder;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  lockstep(folder, "plain", "slide", {});
  Asker asker;
  Process up(up_arguments(oily_plane(folder), {"--lockstep", "--motion", "slide", "--duration", "5", "--record", (folder / "garbage").string()}));
  ASSERT_TRUE(asker.find());
  for (int i = 0; i < 300; ++i) {
    asker.send({kActionGain, kNan});
    asker.send({kActionValue, kNan, 0, 0.0, "viscosity", "damping_ns_per_m"});
    asker.send({kActionReload, 0.0, 0, kNan});
    asker.send({static_cast<std::uint32_t>(i) * 7919 + 5, 1.0});
    asker.send({kActionSwitch, 0.0, 0, 0.0, std::string(20'000, '\xff')});
    std::this_thread::sleep_for(milliseconds(5));
  }
  const Finished end = up.wait(std::chrono::seconds(120));
  ASSERT_EQ(end.status, 0) << end.err << end.out;
  const auto plain = hashes(folder / "plain"), garbage = hashes(folder / "garbage");
  for (const auto& [topic, hash] : plain) EXPECT_TRUE(hash == garbage.at(topic)) << topic;
}

// --- the verb

struct Verb {
  Finished end;
  double seconds = 0.0;
};
Verb change(std::vector<std::string> words) {
  words.insert(words.begin(), {VOXTOUCH_BIN "/voxtouch", "change", "--domain", fresh_domain()});
  const auto begin = std::chrono::steady_clock::now();
  Process process(words);
  Verb verb{process.wait(), 0.0};
  verb.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return verb;
}

TEST(ChangeVerb, SaysWhatWasDoneOrWhyNot) {
  const TemporaryFolder folder;
  Process up(up_arguments(oily_plane(folder), {"--motion", "slide", "--no-record"}));
  for (int i = 0; i < 1500 && up.err().find(" samples  force") == std::string::npos; ++i) std::this_thread::sleep_for(milliseconds(20));
  const auto says = [](const Verb& verb, int status, const std::string& text) {
    EXPECT_EQ(verb.end.status, status) << verb.end.err << verb.end.out;
    EXPECT_NE((status == 0 ? verb.end.out : verb.end.err).find(text), std::string::npos) << verb.end.err << verb.end.out;
  };
  says(change({"viscosity", "off"}), 0, "'viscosity' off: holds from sample ");
  says(change({"viscosity", "on", "gain", "0.5", "damping_ns_per_m=1.5"}), 0, "'damping_ns_per_m' of 'viscosity': holds from sample");
  says(change({"honey", "off"}), 1, "the scene lists: viscosity");
  says(change({"viscosity", "damping_ns_per_m=1e6"}), 1, "from 0 to 100");
  says(change({"viscosity", "damping_ns_per_m=nan"}), 1, "is not a number");
  says(change({"viscosity", "gain"}), 1, "'gain' needs a number");
  says(change({"viscosity"}), 1, "missing");
  says(change({"viscosity", "softly"}), 1, "neither on, off");
  says(change({"--voxel-size", "0.001", "viscosity", "on"}), 1, "belong to --reload");
  says(change({"--reload", "--voxel-size", "0.0015"}), 0, "built anew: holds from sample ");
  const Verb json = change({"viscosity", "off", "--json"});
  EXPECT_EQ(nlohmann::json::parse(json.end.out)["ok"], true) << json.end.out;
  up.signal(2);
  const Finished end = up.wait();
  EXPECT_EQ(end.status, 0) << end.err << end.out;
}

TEST(ChangeVerb, SaysSoWhereNobodyAnswersWithinTwoSeconds) {
  const Verb verb = change({"viscosity", "off"});
  EXPECT_EQ(verb.end.status, 1);
  EXPECT_NE(verb.end.err.find("is the ring running"), std::string::npos) << verb.end.err;
  EXPECT_GT(verb.seconds, 1.9);
}

}  // namespace
}  // namespace voxtouch::test
