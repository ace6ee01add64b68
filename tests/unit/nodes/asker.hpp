#pragma once
/// A client that requests changes of a running rendering, over DDS, and the replies.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/runtime/strings.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::test {

struct Said {
  std::uint32_t result = 0;
  std::uint64_t from_sample = 0, session = 0;
  std::string sentence;
};

/// A client: `voxtouch change`, or a ROS 2 tool.
class Asker {
 public:
  Asker(const bus::Participant& participant, const std::string& rig)
      : changes(participant, qos::kEffectChange, rig, qos::profile(qos::kEffectChange.profile)),
        answers(participant, qos::kEffectChanged, rig, qos::profile(qos::kEffectChanged.profile)) {}
  bool ready() {
    return wait_until([&] { return changes.matched_count() == 1 && answers.matched_count() == 1; });
  }

  /// Repeats the request until it is received: a first message may be sent before discovery.
  bool send_until_received(msg::EffectChange m, std::uint64_t request) {
    static char none[] = "", name[] = "viscosity";
    m.request = request;
    m.effect = name, m.parameter = m.model = none;
    return wait_until([&] {
      changes.write(m);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      take_answers();
      return !said[request].empty();
    });
  }
  std::uint64_t send(msg::EffectChange m, const std::string& effect = "",
                     const std::string& parameter = "", const std::string& model = "") {
    m.request = ++requests;
    m.effect = runtime::lend(effect), m.parameter = runtime::lend(parameter),
    m.model = runtime::lend(model);
    changes.write(m);
    return requests;
  }
  /// The first word on a request, if only that it waits.
  Said first_word(std::uint64_t request) {
    EXPECT_TRUE(wait_until([&] { return take_answers(), !said[request].empty(); }))
        << "none answered " << request;
    return said[request].empty() ? Said{} : said[request].front();
  }
  /// The final reply to a request; calls `meanwhile` until then.
  Said last_word(std::uint64_t request, const std::function<void()>& meanwhile) {
    EXPECT_TRUE(wait_until([&] {
      meanwhile();
      take_answers();
      return !said[request].empty() &&
             said[request].back().result != msg::effect_changed::kResultPending;
    })) << "none answered "
        << request;
    return said[request].empty() ? Said{} : said[request].back();
  }

  void take_answers() {
    answers.take_each([&](const msg::EffectChanged& a) {
      said[a.request].push_back({a.result, a.from_sample, a.session_id, a.sentence});
    });
  }

  bus::Writer<msg::EffectChange> changes;
  bus::Reader<msg::EffectChanged> answers;
  std::map<std::uint64_t, std::vector<Said>> said;
  std::uint64_t requests = 0;
};

inline msg::EffectChange change(std::uint32_t action, double value = 0.0,
                                std::uint64_t from_sample = 0, std::uint64_t session = 0) {
  msg::EffectChange m{};
  m.action = action;
  m.value[0] = value;
  m.from_sample = from_sample;
  m.session_id = session;
  return m;
}

inline const qos::Profile& latched() { return qos::profile(qos::ProfileId::kLatched); }

}  // namespace voxtouch::test
