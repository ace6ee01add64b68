// Changes of a running ring: the force shows only the change, and in lockstep the results are
// bit-identical.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <thread>

#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/runtime/strings.hpp"
#include "tests/ring/ring_run.hpp"
#include "tests/support/bag_hash.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds;
using namespace msg::effect_change;
constexpr double kDamping = 2.0;

/// plane.yaml as through oil, in a folder of the test. `smooth`: with a contact model that does not
/// step at voxel borders.
std::string oily_plane(const TemporaryFolder& folder, bool smooth = false) {
  // With unbounded damping on a filtered velocity the hand keeps its height for tens of samples, in
  // which a force step of a change would be visible.
  std::vector<std::pair<std::string, std::string>> words = {
      {"effects: []", "effects: [{viscosity: {damping_ns_per_m: 2}}]"},
      {"{design: auto, kind: shaping_filter}",
       "{design: auto, kind: shaping_filter, damping_force_ratio: 0, min_damping_ratio: 0, "
       "velocity_windows: false}"}};
  if (smooth)
    words.push_back(
        {"{model: adapted, stiffness_n_per_m: 30}", "{model: field, stiffness_n_per_m3: 6.0e+7}"});
  return changed_scene(folder, "plane", words);
}

struct Change {
  std::uint32_t action = 0;
  double value = 0.0;
  std::uint64_t from_sample = 0;
  double voxel_size_m = 0.0;
  std::string effect = "viscosity", parameter = {}, model = {};
};

/// Sends requests to the ring of this test's domain and waits for their last answers.
class Asker {
 public:
  Asker()
      : participant_({static_cast<std::uint32_t>(std::stoul(fresh_domain())), "lo", "asker"}),
        changes_(participant_, qos::kEffectChange, "haptic",
                 qos::profile(qos::kEffectChange.profile)),
        answers_(participant_, qos::kEffectChanged, "haptic",
                 qos::profile(qos::kEffectChanged.profile)) {}

  bool find() {
    return until([&] { return changes_.matched_count() > 0 && answers_.matched_count() > 0; });
  }
  void send(const Change& w) { send(w, ++sent_); }
  void send(const Change& w, std::uint64_t request) {
    msg::EffectChange m{};
    m.request = request;
    m.action = w.action;
    m.value[0] = w.value;
    m.from_sample = w.from_sample;
    m.voxel_size_m = w.voxel_size_m;
    m.effect = runtime::lend(w.effect), m.parameter = runtime::lend(w.parameter),
    m.model = runtime::lend(w.model);
    changes_.write(m);
  }
  /// Whether all of `changes` were made. Each is sent, and sent again ten times a second, until it
  /// has an answer, and the next one only then: the ring makes changes in order, and its reader may
  /// find this writer later than the writer has found the reader.
  bool make(const std::vector<Change>& changes) {
    for (const Change& change : changes) {
      const std::uint64_t request = ++sent_;
      int looks = 0;
      until([&] {
        if (looks++ % 50 == 0)
          send(change, request);
        return take_answers(), received_.contains(request);
      });
    }
    until([&] { return take_answers(), made_.size() == sent_ || !problems.empty(); });
    return made_.size() == sent_ && problems.empty();
  }
  std::string problems;

 private:
  static bool until(const std::function<bool()>& holds) {
    for (int i = 0; i < 15'000 && !holds(); ++i)
      std::this_thread::sleep_for(milliseconds(2));
    return holds();
  }
  bus::Participant participant_;
  bus::Writer<msg::EffectChange> changes_;
  bus::Reader<msg::EffectChanged> answers_;
  void take_answers() {
    answers_.take_each([&](const msg::EffectChanged& a) {
      received_.insert(a.request);
      if (a.result == msg::effect_changed::kResultRefused)
        problems += std::string(a.sentence) + "\n";
      if (a.result == msg::effect_changed::kResultDone)
        made_.insert(a.request);
    });
  }
  std::uint64_t sent_ = 0;
  std::set<std::uint64_t> received_, made_;
};

/// A lockstep run of `scene` with `changes`, recorded under `name`.
void lockstep(const TemporaryFolder& folder, const std::string& name, const std::string& motion,
              const std::vector<Change>& changes, std::vector<std::string> more = {},
              bool smooth = false) {
  more.insert(more.end(), {"--lockstep", "--motion", motion, "--duration", "5", "--record",
                           (folder / name).string()});
  Asker asker;
  Process up(up_arguments(oily_plane(folder, smooth), more));
  ASSERT_TRUE(asker.find());
  EXPECT_TRUE(asker.make(changes)) << asker.problems;
  const Finished end = up.wait(std::chrono::seconds(120));
  ASSERT_EQ(end.status, 0) << end.err << end.out;
  const auto summary = parse_summary(end.out);
  EXPECT_EQ(summary["validator"]["disagree"], 0);
  EXPECT_GT(summary["validator"]["decided"], 0);
}

std::map<std::string, bag::TopicHash> hashes(const std::filesystem::path& folder) {
  const auto bag = bag::WholeBag::open(folder);
  if (!bag)
    throw std::runtime_error(bag.error().sentence);
  std::map<std::string, bag::TopicHash> all;
  for (const char* topic : {"device/state", "rendering/contact", "coupling/command", "validation",
                            "rendering/plan", "coupling/design"}) {
    const bool latched =
        std::string(topic) == "rendering/plan" || std::string(topic) == "coupling/design";
    const auto hash = bag::hash_topic(*bag, std::string("/haptic/") + topic,
                                      latched ? bag::KeyOf{} : bag::ring_sequence_number);
    if (!hash)
      throw std::runtime_error(hash.error().sentence);
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
/// The same after the tool has been in contact for a while: a first touch is a step itself.
template <class T, class F>
double largest_step_in_contact(const std::vector<msg::ContactState>& contacts,
                               const std::vector<T>& all, F&& force) {
  double most = 0.0;
  for (std::size_t i = 1; i < all.size(); ++i)
    if (contacts[i].surface_hits > 0 && contacts[i - 1].surface_hits > 0)
      most = std::max(most, step(force(all[i - 1]), force(all[i])));
  return most;
}
/// The same for commands, if the tool has kept its height for 20 samples; `looked_at`: their
/// number.
double largest_resting_step(const std::vector<msg::ContactState>& contacts,
                            const std::vector<msg::ForceCommand>& all, std::size_t first,
                            std::size_t last, std::size_t& looked_at) {
  double most = 0.0;
  std::size_t still = 0;
  for (std::size_t i = first - 20; i < last; ++i) {
    still =
        contacts[i].tool_pose.position.z == contacts[i - 1].tool_pose.position.z ? still + 1 : 0;
    if (i < first || still < 20)
      continue;
    most = std::max(most, step(all[i - 1].wrench.force, all[i].wrench.force));
    ++looked_at;
  }
  return most;
}
double contact_alone(const msg::ContactState& c) { return c.contact_wrench.force.z; }
const auto kForce = [](const auto& m) { return m.wrench.force; };
const auto kEffects = [](const auto& m) { return m.effects_wrench.force; };

std::vector<msg::ContactState> contacts(const TemporaryFolder& folder, const std::string& name) {
  return read_ring_topic<msg::ContactState>(folder / name, "/haptic/rendering/contact");
}
std::vector<msg::ForceCommand> commands(const TemporaryFolder& folder, const std::string& name) {
  return read_ring_topic<msg::ForceCommand>(folder / name, "/haptic/coupling/command");
}

TEST(Change, OfAnEffectIsContinuousAndReproducible) {
  const TemporaryFolder folder;
  const std::vector<Change> changes = {
      {kActionSwitch, 0.0, 1500},
      {kActionSwitch, 1.0, 2000},
      {kActionValue, 0.5, 2500, 0.0, "viscosity", "damping_ns_per_m"},
      {kActionGain, 0.3, 2600}};
  lockstep(folder, "plain", "slide", {});
  lockstep(folder, "first", "slide", changes);
  lockstep(folder, "second", "slide", changes, {"--one-process"});
  const auto plain = contacts(folder, "plain"), changed = contacts(folder, "first");
  ASSERT_EQ(changed.size(), 5000U);
  EXPECT_GT(changed[1499].surface_hits, 0U) << "in contact";
  EXPECT_GT(std::abs(changed[1499].effects_wrench.force.x), 0.05);
  for (std::size_t i = 0; i < 1500; ++i)
    ASSERT_EQ(plain[i].wrench.force.x, changed[i].wrench.force.x) << i;
  EXPECT_EQ(changed[1650].effects_wrench.force.x, 0.0);
  EXPECT_LT(changed[2200].effects_wrench.force.x, -0.05);
  // The tool moves at up to 0.1 m/s: a ramp of a tenth of a second takes at most this much a
  // sample.
  const double ramp = kDamping * 0.1 * 0.001 / 0.1,
               before = largest_step(plain, 1400, 3000, kEffects);
  EXPECT_LE(largest_step(changed, 1400, 3000, kEffects), before + ramp);
  const double step_without_change = largest_step(commands(folder, "plain"), 1400, 3000, kForce),
               with_change = largest_step(commands(folder, "first"), 1400, 3000, kForce);
  RecordProperty("largest_step_n", std::to_string(with_change));
  RecordProperty("largest_step_without_a_change_n", std::to_string(step_without_change));
  std::printf(
      "largest step of the command: %.5f N, without a change %.5f N; a ramp may add %.5f N\n",
      with_change, step_without_change, ramp);
  EXPECT_LE(with_change, step_without_change + ramp);
  // Until the first change both runs are equal, so its hundred samples can be compared if the hand
  // keeps its height. If only one of the hands makes an encoder step, the damping answers it for
  // some samples.
  std::size_t looked_at = 0;
  const double first =
      largest_resting_step(changed, commands(folder, "first"), 1500, 1600, looked_at);
  EXPECT_GE(looked_at, 20U);
  EXPECT_LE(first, largest_step(commands(folder, "plain"), 1500, 1600, kForce) + ramp);
  const auto once = hashes(folder / "first"), second = hashes(folder / "second");
  for (const auto& [topic, hash] : once)
    EXPECT_TRUE(hash == second.at(topic)) << topic;
  EXPECT_FALSE(once.at("rendering/contact") == hashes(folder / "plain").at("rendering/contact"));
}

TEST(Change, ToAReloadedSceneIsContinuousAndReproducible) {
  const TemporaryFolder folder;
  const std::vector<Change> changes = {{kActionReload, 0.0, 1800, 0.0015, "", "", "adapted"}};
  lockstep(folder, "plain", "slide", {}, {}, true);
  lockstep(folder, "first", "slide", changes, {}, true);
  lockstep(folder, "second", "slide", changes, {"--one-process"}, true);
  const auto plain = contacts(folder, "plain"), changed = contacts(folder, "first");
  ASSERT_EQ(changed.size(), 5000U);
  for (std::size_t i = 0; i < 1800; ++i)
    ASSERT_EQ(plain[i].wrench.force.z, changed[i].wrench.force.z) << i;
  EXPECT_EQ(changed[1799].model, msg::contact_state::kModelField);
  EXPECT_EQ(changed[2000].model, msg::contact_state::kModelAdapted);
  for (std::size_t i = 0; i < changed.size(); ++i)
    ASSERT_EQ((changed[i].flags & msg::contact_state::kFlagFading) != 0, i >= 1800 && i < 2000)
        << i;
  const double displacement = std::abs(changed[2000].wrench.force.z - changed[1799].wrench.force.z);
  EXPECT_GT(changed[1799].wrench.force.z, 0.1) << "in contact";
  // The hand moves by the change, and each step of its encoder is a step of the force: the run
  // without a change has similar ones when the hand comes down. At constant height only the fade
  // may be visible, and the steps of `adapted` at voxel borders. The two scenes differ by up to
  // twice as much during the motion as between its start and its end, because the hand moves.
  const double fade = 2.0 * displacement * 0.001 / 0.2,
               before = largest_step_in_contact(plain, plain, kForce),
               after = largest_step(changed, 1790, 2010, kForce);
  const auto largest_at_one_height = [&](std::size_t from, std::size_t to) {
    double largest = 0.0;
    for (std::size_t i = from; i < to; ++i)
      if (changed[i].tool_pose.position.z == changed[i - 1].tool_pose.position.z)
        largest =
            std::max(largest, std::abs(contact_alone(changed[i]) - contact_alone(changed[i - 1])));
    return largest;
  };
  const double resting = largest_at_one_height(1790, 2010),
               of_adapted = largest_at_one_height(2010, 2600);
  std::printf(
      "contact: %.4f N to %.4f N; largest step %.5f N (%.5f N at one height), without a change "
      "%.5f N; a fade may add "
      "%.5f N\n",
      changed[1799].wrench.force.z, changed[2000].wrench.force.z, after, resting, before, fade);
  EXPECT_GT(displacement, 2.0 * (before + fade))
      << "the two scenes must differ, or nothing is shown";
  EXPECT_LE(after, before + fade);
  std::printf("steps of adapted alone at one height: %.5f N\n", of_adapted);
  // The weights of both contacts are linear in time, and a spring is in series with their sum: the
  // force changes faster while the stiffer contact has the larger weight (twice, for these two).
  EXPECT_LE(resting, 2.0 * fade + of_adapted);
  const double step_without_change =
                   largest_step_in_contact(plain, commands(folder, "plain"), kForce),
               with_change = largest_step(commands(folder, "first"), 1790, 2600, kForce);
  std::printf("command: largest step %.5f N, without a change %.5f N\n", with_change,
              step_without_change);
  EXPECT_LE(with_change, step_without_change + fade);
  const auto first = hashes(folder / "first"), second = hashes(folder / "second");
  for (const auto& [topic, hash] : first)
    EXPECT_TRUE(hash == second.at(topic)) << topic;
  EXPECT_EQ(first.at("rendering/plan").messages, 2U);
  EXPECT_EQ(first.at("coupling/design").messages, 2U)
      << "designed anew for what the new scene can show";
}

TEST(Change, IgnoresGarbageOnTheTopic) {
  const TemporaryFolder folder;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  lockstep(folder, "plain", "slide", {});
  Asker asker;
  Process up(up_arguments(oily_plane(folder), {"--lockstep", "--motion", "slide", "--duration", "5",
                                               "--record", (folder / "garbage").string()}));
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
  for (const auto& [topic, hash] : plain)
    EXPECT_TRUE(hash == garbage.at(topic)) << topic;
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

TEST(ChangeVerb, PrintsTheResultOrTheReason) {
  const TemporaryFolder folder;
  Process up(up_arguments(oily_plane(folder), {"--motion", "slide", "--no-record"}));
  for (int i = 0; i < 1500 && !runs(up); ++i)
    std::this_thread::sleep_for(milliseconds(20));
  const auto says = [](const Verb& verb, int status, const std::string& text) {
    EXPECT_EQ(verb.end.status, status) << verb.end.err << verb.end.out;
    EXPECT_NE((status == 0 ? verb.end.out : verb.end.err).find(text), std::string::npos)
        << verb.end.err << verb.end.out;
  };
  says(change({"viscosity", "off"}), 0, "'viscosity' off: ");
  says(change({"viscosity", "on", "gain", "0.5", "damping_ns_per_m=1.5"}), 0,
       "'damping_ns_per_m' of 'viscosity'");
  says(change({"honey", "off"}), 1, ": viscosity");
  says(change({"viscosity", "damping_ns_per_m=1e6"}), 1, "from 0 to 100");
  says(change({"viscosity", "damping_ns_per_m=nan"}), 1, "number");
  says(change({"viscosity", "gain"}), 1, "'gain'");
  says(change({"viscosity"}), 1, "missing");
  says(change({"viscosity", "softly"}), 1, "softly");
  says(change({"--voxel-size", "0.001", "viscosity", "on"}), 1, "--reload");
  says(change({"--reload", "--voxel-size", "0.0015"}), 0, "the rebuilt scene");
  const Verb json = change({"viscosity", "off", "--json"});
  EXPECT_EQ(nlohmann::json::parse(json.end.out)["ok"], true) << json.end.out;
  up.signal(2);
  const Finished end = up.wait();
  EXPECT_EQ(end.status, 0) << end.err << end.out;
}

/// A change that is refused at the start is refused at run time, with the same sentence on every
/// path.
TEST(ChangeVerb, RefusesMoreThanTheDeviceBears) {
  const TemporaryFolder folder;
  std::string file;
  const auto write = [&](const std::string& damping) {
    file = changed_scene(folder, "cup_viscosity",
                         {{"damping_ns_per_m: 1}", "damping_ns_per_m: " + damping + "}"}});
  };
  write("1");
  Process up(up_arguments(file, {"--motion", "slide", "--no-record"}));
  for (int i = 0; i < 1500 && !runs(up); ++i)
    std::this_thread::sleep_for(milliseconds(20));
  const auto refused = [](const Verb& verb, const std::string& text) {
    EXPECT_EQ(verb.end.status, 1) << verb.end.err << verb.end.out;
    EXPECT_NE(verb.end.err.find(text), std::string::npos) << verb.end.err << verb.end.out;
  };
  const std::string stands = "margin 2";
  refused(change({"viscosity", "damping_ns_per_m=50"}), "50 Ns/m");
  refused(change({"viscosity", "damping_ns_per_m=50"}), stands);
  write("60");
  refused(change({"--reload"}), stands);
  refused(change({"viscosity", "off", "--from-sample", "900000"}), "10 s");
  write("1.5");
  for (int i = 0; i < 3; ++i) {
    const Verb again = change({"--reload", "--voxel-size", i % 2 ? "0.003" : "0.0025"});
    EXPECT_EQ(again.end.status, 0) << again.end.err;
  }
  up.signal(2);
  const Finished end = up.wait();
  EXPECT_EQ(end.status, 0) << end.err << end.out;
}

TEST(ChangeVerb, FailsAfterTwoSecondsWithoutAnAnswer) {
  const Verb verb = change({"viscosity", "off"});
  EXPECT_EQ(verb.end.status, 1);
  EXPECT_FALSE(verb.end.err.empty());
  EXPECT_GT(verb.seconds, 1.9);
}

}  // namespace
}  // namespace voxtouch::test
