#include <array>
#include <chrono>
#include <optional>
#include <random>
#include <thread>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/types/number.hpp"
#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/log/tell.hpp"
#include "nodes/runtime/options.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::cli {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using namespace msg::effect_change;

constexpr milliseconds kPatience{2000};

struct ChangeOptions {
  runtime::NodeOptions node;
  std::vector<std::string> words;
  bool reload = false, json = false;
  double voxel_size_m = 0.0;
  std::string model;
  std::uint64_t from_sample = 0;
};

/// One message to be.
struct Wish {
  std::uint32_t action = 0;
  std::string effect, parameter;
  std::array<double, 3> value{};
};

struct Answer {
  std::uint32_t result = 0;
  std::uint64_t from_sample = 0;
  std::string sentence;
};

[[noreturn]] void misread(const std::string& what) {
  throw std::runtime_error(
      what + ". Say EFFECT on, EFFECT off, EFFECT gain 0.5, or EFFECT PARAMETER=VALUE; see voxtouch change --help");
}

double number(std::string_view text) {
  const auto value = parse_finite(text);
  if (!value) misread(fmt::format("'{}' is not a number", text));
  return *value;
}

/// PARAMETER=VALUE or PARAMETER=X,Y,Z.
Wish assignment(const std::string& effect, const std::string& word) {
  const std::size_t equals = word.find('=');
  if (equals == std::string::npos || equals == 0)
    misread(fmt::format("'{}' is neither on, off, gain nor PARAMETER=VALUE", word));
  Wish wish{kActionValue, effect, word.substr(0, equals), {}};
  std::string_view rest = std::string_view(word).substr(equals + 1);
  for (std::size_t n = 0;; ++n) {
    if (n == 3) misread(fmt::format("'{}' holds more than three numbers", word));
    const std::size_t comma = rest.find(',');
    wish.value[n] = number(rest.substr(0, comma));
    if (comma == std::string_view::npos) return wish;
    rest.remove_prefix(comma + 1);
  }
}

std::vector<Wish> read_words(const ChangeOptions& o) {
  if (o.reload) {
    if (!o.words.empty()) misread("--reload takes no effect");
    return {{kActionReload, {}, {}, {}}};
  }
  if (o.voxel_size_m > 0.0 || !o.model.empty()) misread("--voxel-size and --model belong to --reload");
  if (o.words.size() < 2) misread("an effect and what is to become of it are missing");
  const std::string& effect = o.words[0];
  std::vector<Wish> wishes;
  for (std::size_t n = 1; n < o.words.size(); ++n) {
    const std::string& word = o.words[n];
    if (word == "on" || word == "off") {
      wishes.push_back({kActionSwitch, effect, {}, {word == "on" ? 1.0 : 0.0, 0.0, 0.0}});
    } else if (word == "gain") {
      if (++n == o.words.size()) misread("'gain' needs a number from 0 to 1");
      wishes.push_back({kActionGain, effect, {}, {number(o.words[n]), 0.0, 0.0}});
    } else {
      wishes.push_back(assignment(effect, word));
    }
  }
  return wishes;
}

std::uint64_t request_number() {
  std::random_device random;
  return (std::uint64_t{random()} << 32) | random();
}

class Asker {
 public:
  explicit Asker(const ChangeOptions& o)
      : options_(o), participant_(o.node.participant("change")),
        changes_(participant_, qos::kEffectChange, o.node.rig, qos::profile(qos::kEffectChange.profile)),
        answers_(participant_, qos::kEffectChanged, o.node.rig, qos::profile(qos::kEffectChanged.profile)) {}

  /// False where nobody can hear.
  bool find() {
    return until(kPatience, [&] { return changes_.matched_count() > 0 && answers_.matched_count() > 0; });
  }

  /// None where nobody answers. Once it is said that it takes time, it may take what it takes.
  std::optional<Answer> ask(const Wish& wish) {
    const std::uint64_t request = request_number();
    std::optional<Answer> answer;
    const auto look = [&] {
      answers_.take_each([&](const msg::EffectChanged& m) {
        if (m.request == request) answer = Answer{m.result, m.from_sample, m.sentence};
      });
      return answer && answer->result != msg::effect_changed::kResultWaiting;
    };
    // A first message may go before the other end knows this one; asked again, it is answered and not done again.
    for (int tries = 0; !answer && tries < 10; ++tries) {
      send(wish, request);
      until(kPatience / 10, [&] { return look() || answer; });
    }
    if (!answer) return answer;
    if (answer->result == msg::effect_changed::kResultWaiting) tell("{}\n", answer->sentence);
    while (answer->result == msg::effect_changed::kResultWaiting && changes_.matched_count() > 0)
      until(milliseconds(200), look);
    return answer;
  }

 private:
  template <class Holds>
  bool until(Clock::duration patience, Holds&& holds) {
    for (const auto end = Clock::now() + patience; !holds(); std::this_thread::sleep_for(milliseconds(2)))
      if (Clock::now() > end) return false;
    return true;
  }

  void send(const Wish& wish, std::uint64_t request) {
    msg::EffectChange m{};
    m.request = request;
    m.from_sample = options_.from_sample;
    m.action = wish.action;
    m.effect = runtime::lend(wish.effect);
    m.parameter = runtime::lend(wish.parameter);
    std::copy(wish.value.begin(), wish.value.end(), m.value);
    m.voxel_size_m = options_.voxel_size_m;
    m.model = runtime::lend(options_.model);
    changes_.write(m);
  }

  const ChangeOptions& options_;
  bus::Participant participant_;
  bus::Writer<msg::EffectChange> changes_;
  bus::Reader<msg::EffectChanged> answers_;
};

std::string nobody(const ChangeOptions& o) {
  return fmt::format(
      "no rendering of rig '{}' answers on domain {}: is the ring running, with the same --rig, --domain and "
      "--interface?",
      o.node.rig, o.node.domain);
}

int change(const ChangeOptions& o) {
  const std::vector<Wish> wishes = read_words(o);
  Asker asker(o);
  nlohmann::ordered_json answers = nlohmann::ordered_json::array();
  std::string problem = asker.find() ? "" : nobody(o);
  for (const Wish& wish : wishes) {
    if (!problem.empty()) break;
    const std::optional<Answer> answer = asker.ask(wish);
    if (!answer) {
      problem = nobody(o);
    } else if (answer->result != msg::effect_changed::kResultDone) {
      problem = answer->result == msg::effect_changed::kResultRefused ? answer->sentence
                                                                      : "not waited for: " + answer->sentence;
    } else {
      answers.push_back({{"done", answer->sentence}, {"from_sample", answer->from_sample}});
      if (!o.json) print_result("{}\n", answer->sentence);
    }
  }
  if (o.json) {
    nlohmann::ordered_json j{
        {"ok", problem.empty()}, {"answers", answers}, {"problems", nlohmann::ordered_json::array()}};
    if (!problem.empty()) j["problems"].push_back(problem);
    print_result("{}\n", j.dump(2));
  } else if (!problem.empty()) {
    tell("error: {}\n", problem);
  }
  return problem.empty() ? 0 : 1;
}

}  // namespace

void add_change(CLI::App& app, Action& action) {
  auto o = std::make_shared<ChangeOptions>();
  CLI::App* verb = app.add_subcommand(
      "change",
      "Changes a ring while it runs, without a step of force: switches an effect, sets its gain or its parameters "
      "(each goes to\n"
      "its new value in 0.1 s), or builds the scene anew beside the loop and fades over to it in 0.2 s. Prints what "
      "was done or\n"
      "why not; exit status 1 where it was refused or nobody answers within 2 s.\n"
      "  voxtouch change viscosity off\n"
      "  voxtouch change viscosity gain 0.5\n"
      "  voxtouch change viscosity damping_ns_per_m=2\n"
      "  voxtouch change --reload                                     the scene file, read again\n"
      "  voxtouch change --reload --voxel-size 0.001 --model field    with another voxel size and contact model\n"
      "An effect is named by its kind, from the second of a kind on with its number (viscosity, viscosity2). After "
      "--reload an\n"
      "effect that the file still asks for in the same words keeps what was changed. Meshes, voxel size, contact and "
      "effects may\n"
      "change in the file; another device or coupling section needs a restart and is refused; motions stay as they "
      "were.");
  verb->add_option("WORDS", o->words, "EFFECT on|off, EFFECT gain X, or EFFECT PARAMETER=VALUE[,V,V] ...")
      ->option_text("EFFECT ...");
  verb->add_flag("--reload", o->reload, "Reads the scene file again, builds it beside the loop and swaps it in");
  verb->add_option("--voxel-size", o->voxel_size_m, "With --reload: voxel edge [m] instead of the file's")
      ->check(runtime::require_positive);
  verb->add_option("--model", o->model, "With --reload: contact model instead of the file's")
      ->check(CLI::IsMember({"original", "adapted", "clustered", "field"}));
  verb->add_option(
          "--from-sample", o->from_sample,
          "Sequence number of the first device sample that the change holds for; a run in lockstep then gives the same "
          "bits\neach time. Refused where it has passed. Default: the next one")
      ->check(runtime::require_whole);
  runtime::add_rig_options(*verb, o->node);
  verb->add_flag("--json", o->json, "One JSON object on stdout; all else goes to stderr");
  verb->callback([o, &action] { action = [o] { return change(*o); }; });
}

}  // namespace voxtouch::cli
