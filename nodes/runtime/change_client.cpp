#include "nodes/runtime/change_client.hpp"

#include <algorithm>
#include <chrono>
#include <random>
#include <thread>

#include <fmt/format.h>

#include "core/types/number.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::runtime {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using namespace msg::effect_change;

constexpr milliseconds kPatience{2000};

[[noreturn]] void misread(const std::string& what) {
  throw std::runtime_error(what +
                           ". Usage: EFFECT on, EFFECT off, EFFECT gain 0.5, or EFFECT "
                           "PARAMETER=VALUE (voxtouch change --help)");
}

double number(std::string_view text) {
  const auto value = parse_finite(text);
  if (!value)
    misread(fmt::format("'{}' is not a number", text));
  return *value;
}

/// Parses PARAMETER=VALUE or PARAMETER=X,Y,Z.
ChangeRequest assignment(const std::string& effect, const std::string& word) {
  const std::size_t equals = word.find('=');
  if (equals == std::string::npos || equals == 0)
    misread(fmt::format("'{}' is not one of on, off, gain or PARAMETER=VALUE", word));
  ChangeRequest change{kActionValue, effect, word.substr(0, equals), {}};
  std::string_view rest = std::string_view(word).substr(equals + 1);
  for (std::size_t n = 0;; ++n) {
    if (n == 3)
      misread(fmt::format("'{}' has more than three numbers", word));
    const std::size_t comma = rest.find(',');
    change.value[n] = number(rest.substr(0, comma));
    if (comma == std::string_view::npos)
      return change;
    rest.remove_prefix(comma + 1);
  }
}

std::uint64_t request_number() {
  std::random_device random;
  return (std::uint64_t{random()} << 32) | random();
}

template <class Holds>
bool until(Clock::duration patience, Holds&& holds) {
  for (const auto end = Clock::now() + patience; !holds();
       std::this_thread::sleep_for(milliseconds(2)))
    if (Clock::now() > end)
      return false;
  return true;
}

}  // namespace

std::vector<ChangeRequest> read_changes(const ChangeWords& o) {
  if (o.reload) {
    if (!o.words.empty())
      misread("--reload cannot be combined with an effect");
    return {{kActionReload, {}, {}, {}}};
  }
  if (o.voxel_size_m > 0.0 || !o.model.empty())
    misread("--voxel-size and --model require --reload");
  if (o.words.size() < 2)
    misread("effect and value are missing");
  const std::string& effect = o.words[0];
  std::vector<ChangeRequest> changes;
  for (std::size_t n = 1; n < o.words.size(); ++n) {
    const std::string& word = o.words[n];
    if (word == "on" || word == "off") {
      changes.push_back({kActionSwitch, effect, {}, {word == "on" ? 1.0 : 0.0, 0.0, 0.0}});
    } else if (word == "gain") {
      if (++n == o.words.size())
        misread("'gain' needs a number from 0 to 1");
      changes.push_back({kActionGain, effect, {}, {number(o.words[n]), 0.0, 0.0}});
    } else {
      changes.push_back(assignment(effect, word));
    }
  }
  return changes;
}

ChangeClient::ChangeClient(const bus::Participant& participant, const NodeOptions& options)
    : rig_(options.rig),
      domain_(options.domain),
      changes_(participant, qos::kEffectChange, options.rig,
               qos::profile(qos::kEffectChange.profile)),
      answers_(participant, qos::kEffectChanged, options.rig,
               qos::profile(qos::kEffectChanged.profile)),
      plans_(participant, qos::kScenePlan, options.rig, qos::profile(qos::kScenePlan.profile)) {}

std::string ChangeClient::request(const ChangeWords& words,
                                  const std::function<void(const ChangeAnswer&)>& answered,
                                  const std::function<void(const std::string&)>& waits,
                                  const std::function<bool()>& leave) {
  const std::vector<ChangeRequest> changes = read_changes(words);
  if (!until(kPatience, [&] {
        return leave() || (changes_.matched_count() > 0 && answers_.matched_count() > 0);
      }))
    return no_rendering();
  // A rendering that waits for its first device has published no session.
  until(kPatience / 4, [&] {
    plans_.take_each([&](const msg::ScenePlan& plan) { session_ = plan.session_id; });
    return leave() || session_ != 0;
  });
  for (const ChangeRequest& change : changes) {
    const std::optional<Message> answer = request_in_session(change, words, waits, leave);
    if (!answer)
      return no_rendering();
    if (answer->result == msg::effect_changed::kResultRefused)
      return answer->sentence;
    if (answer->result != msg::effect_changed::kResultDone)
      return "reply not awaited: " + answer->sentence;
    answered({answer->from_sample, answer->sentence});
  }
  return {};
}

/// Repeats the request once if another session has begun; the reply names that session.
std::optional<ChangeClient::Message> ChangeClient::request_in_session(
    const ChangeRequest& change, const ChangeWords& words,
    const std::function<void(const std::string&)>& waits, const std::function<bool()>& leave) {
  std::optional<Message> answer = request_one(change, words, waits, leave);
  if (!answer || answer->result != msg::effect_changed::kResultRefused || session_ == 0 ||
      answer->session == session_)
    return answer;
  session_ = answer->session;
  return request_one(change, words, waits, leave);
}

/// Returns nothing without a reply.
std::optional<ChangeClient::Message> ChangeClient::request_one(
    const ChangeRequest& change, const ChangeWords& words,
    const std::function<void(const std::string&)>& waits, const std::function<bool()>& leave) {
  const std::uint64_t request = request_number();
  std::optional<Message> answer;
  const auto poll = [&] {
    answers_.take_each([&](const msg::EffectChanged& m) {
      if (m.request == request)
        answer = Message{m.result, m.session_id, m.from_sample, m.sentence};
    });
    return leave() || (answer && answer->result != msg::effect_changed::kResultPending);
  };
  // The first message may be sent while the other end has not discovered this participant. A
  // repeated request is answered and not applied again.
  for (int tries = 0; !answer && tries < 10 && !leave(); ++tries) {
    send(change, words, request);
    until(kPatience / 10, [&] { return poll() || answer; });
  }
  if (!answer)
    return answer;
  if (answer->result == msg::effect_changed::kResultPending)
    waits(answer->sentence);
  while (answer->result == msg::effect_changed::kResultPending && changes_.matched_count() > 0 &&
         !leave())
    until(milliseconds(200), poll);
  return answer;
}

void ChangeClient::send(const ChangeRequest& change, const ChangeWords& words,
                        std::uint64_t request) {
  msg::EffectChange m{};
  m.request = request;
  m.session_id = session_;
  m.from_sample = words.from_sample;
  m.action = change.action;
  m.effect = lend(change.effect);
  m.parameter = lend(change.parameter);
  std::copy(change.value.begin(), change.value.end(), m.value);
  m.voxel_size_m = words.voxel_size_m;
  m.model = lend(words.model);
  changes_.write(m);
}

std::string ChangeClient::no_rendering() const {
  return fmt::format(
      "No reply from the rendering of rig '{}' on domain {}. Check that the ring runs with the "
      "same --rig, --domain and --interface",
      rig_, domain_);
}

}  // namespace voxtouch::runtime
