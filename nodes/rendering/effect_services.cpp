#include "nodes/rendering/effect_services.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "nodes/rendering/request_limits.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::rendering_node {
namespace {

/// Requests of one service at one look, so that none keeps the others waiting.
constexpr int kMaxPerLook = 64;

/// A sequence over the elements of a vector, which keeps them.
template <class Sequence, class Element>
void lend(Sequence& sequence, std::vector<Element>& elements) {
  sequence._buffer = elements.data();
  sequence._length = sequence._maximum = static_cast<std::uint32_t>(elements.size());
}

template <class Texts>
std::vector<std::string> texts_of(const Texts& texts) {
  return {texts._buffer, texts._buffer + texts._length};
}

/// What became of each change of one request, until the last word has come.
struct Results {
  struct One {
    bool done = false;
    std::string sentence;
  };
  std::vector<One> all;
  std::size_t open = 0;
};

msg::rcl_interfaces_SetParametersResult message_of(const Results::One& result) {
  // ROS tools show the reason of a refusal; of what is done they show the value.
  return {result.done, result.done ? const_cast<char*>("") : runtime::lend(result.sentence)};
}

}  // namespace

EffectServices::EffectServices(const bus::Participant& participant, const std::string& rig,
                               ChangeHandler handler)
    : node_("/" + rig + "/rendering"),
      handler_(std::move(handler)),
      change_(Server<msg::ChangeEffect>::make<change_fits>(participant, qos::kChangeEffect, rig,
                                                           "rendering")),
      list_(Server<msg::rcl_interfaces_ListParameters>::make<prefixes_fit>(
          participant, qos::kListParameters, rig, "rendering")),
      get_(Server<msg::rcl_interfaces_GetParameters>::make<names_fit>(
          participant, qos::kGetParameters, rig, "rendering")),
      types_(Server<msg::rcl_interfaces_GetParameterTypes>::make<names_fit>(
          participant, qos::kGetParameterTypes, rig, "rendering")),
      describe_(Server<msg::rcl_interfaces_DescribeParameters>::make<names_fit>(
          participant, qos::kDescribeParameters, rig, "rendering")),
      set_(Server<msg::rcl_interfaces_SetParameters>::make<parameters_fit>(
          participant, qos::kSetParameters, rig, "rendering")),
      set_together_(Server<msg::rcl_interfaces_SetParametersAtomically>::make<parameters_fit>(
          participant, qos::kSetParametersAtomically, rig, "rendering")),
      events_(participant, qos::kParameterEvents, rig, qos::profile(qos::kParameterEvents.profile)),
      told_(handler_.parameters()) {}

void EffectServices::attach_to(bus::WaitSet& wait_set) {
  for (const dds_entity_t condition :
       {change_.condition(), list_.condition(), get_.condition(), types_.condition(),
        describe_.condition(), set_.condition(), set_together_.condition()})
    wait_set.attach(condition);
}

bool EffectServices::waits() const noexcept {
  return change_.waits() || list_.waits() || get_.waits() || types_.waits() || describe_.waits() ||
         set_.waits() || set_together_.waits();
}

/// Whether `count` more go into this second; the part that does is taken.
bool EffectServices::admits(std::uint32_t count) {
  bool all = true;
  for (std::uint32_t n = 0; n < std::max(count, 1U); ++n)
    all = admitted_.take(runtime::monotonic_ns()).say && all;
  return all;
}

template <class S, class F>
void EffectServices::each(Server<S>& server, F&& f) {
  server.send_waiting();
  server.take(
      [&](const typename S::Request& request, const bus::Caller& caller) {
        if (!answers_)
          return;
        std::uint32_t count = 1;
        if constexpr (requires { request.parameters; })
          count = request.parameters._length;
        if (admits(count))
          f(request, caller);
        else
          refused_.fetch_add(1, std::memory_order_relaxed);
      },
      kMaxPerLook);
}

void EffectServices::serve(bool answers) {
  answers_ = answers;
  each(list_, [this](const auto& request, const bus::Caller& caller) {
    ListedParameters listed =
        list_parameters(handler_.parameters(), texts_of(request.prefixes), request.depth);
    list_.reply(caller, [listed = std::move(listed)](auto& response, const auto& send) {
      runtime::LentStrings names(listed.names), prefixes(listed.prefixes);
      names.into(response.result.names), prefixes.into(response.result.prefixes);
      send();
    });
  });
  serve_named();
  each(set_, [this](const auto& request, const bus::Caller& caller) { set(request, caller); });
  each(set_together_,
       [this](const auto& request, const bus::Caller& caller) { set_together(request, caller); });
  each(change_,
       [this](const auto& request, const bus::Caller& caller) { change(request, caller); });
}

template <class Names>
std::vector<RosParameter> EffectServices::named(const Names& names) const {
  const std::vector<RosParameter> all = handler_.parameters();
  std::vector<RosParameter> found;
  for (const char* name : all_of(names)) {
    const RosParameter* const known = find_parameter(all, name);
    found.push_back(known ? *known : RosParameter{.name = name, .value = {}, .meaning = {}});
  }
  return found;
}

void EffectServices::serve_named() {
  each(get_, [this](const auto& request, const bus::Caller& caller) {
    get_.reply(caller, [found = named(request.names)](auto& response, const auto& send) {
      std::vector<msg::rcl_interfaces_ParameterValue> values;
      for (const RosParameter& parameter : found)
        values.push_back(ParameterMessages::value(parameter.value));
      lend(response.values, values);
      send();
    });
  });
  each(types_, [this](const auto& request, const bus::Caller& caller) {
    types_.reply(caller, [found = named(request.names)](auto& response, const auto& send) {
      std::vector<std::uint8_t> types;
      for (const RosParameter& parameter : found)
        types.push_back(type_of(parameter.value));
      lend(response.types, types);
      send();
    });
  });
  each(describe_, [this](const auto& request, const bus::Caller& caller) {
    describe_.reply(caller, [found = named(request.names)](auto& response, const auto& send) {
      ParameterMessages messages;
      std::vector<msg::rcl_interfaces_ParameterDescriptor> descriptors;
      for (const RosParameter& parameter : found)
        descriptors.push_back(messages.descriptor(parameter));
      lend(response.descriptors, descriptors);
      send();
    });
  });
}

void EffectServices::set(const msg::rcl_interfaces_SetParameters::Request& request,
                         const bus::Caller& caller) {
  const std::span asked = all_of(request.parameters);
  const auto results =
      std::make_shared<Results>(Results{std::vector<Results::One>(asked.size()), asked.size()});
  const auto reply = [this, caller, results] {
    set_.reply(caller, [results](auto& response, const auto& send) {
      std::vector<msg::rcl_interfaces_SetParametersResult> messages;
      for (const Results::One& one : results->all)
        messages.push_back(message_of(one));
      lend(response.results, messages);
      send();
    });
  };
  const auto tell = [results, reply](std::size_t which, bool done, const std::string& sentence) {
    results->all[which] = {done, sentence};
    if (--results->open == 0)
      reply();
  };
  if (asked.empty())
    return reply();
  const std::vector<RosParameter> known = handler_.parameters();
  for (std::size_t n = 0; n < asked.size(); ++n) {
    const auto wanted = change_of(known, asked[n]);
    if (!wanted) {
      tell(n, false, wanted.error());
      continue;
    }
    const msg::EffectChange message = wanted->message();
    handler_.ask(std::span(&message, 1), false,
                 [n, tell](std::size_t, bool done, std::uint64_t, const std::string& sentence) {
                   tell(n, done, sentence);
                 });
  }
}

void EffectServices::set_together(
    const msg::rcl_interfaces_SetParametersAtomically::Request& request,
    const bus::Caller& caller) {
  const auto reply = [this, caller](Results::One result) {
    set_together_.reply(caller, [result = std::move(result)](auto& response, const auto& send) {
      response.result = message_of(result);
      send();
    });
  };
  const std::vector<RosParameter> known = handler_.parameters();
  std::vector<ParameterChange> changes;
  for (const auto& parameter : all_of(request.parameters)) {
    auto wanted = change_of(known, parameter);
    if (!wanted)
      return reply({false, wanted.error()});
    changes.push_back(std::move(*wanted));
  }
  if (changes.empty())
    return reply({true, {}});
  std::vector<msg::EffectChange> messages;
  for (const ParameterChange& wanted : changes)
    messages.push_back(wanted.message());
  const auto open = std::make_shared<std::size_t>(messages.size());
  handler_.ask(messages, true,
               [open, reply](std::size_t, bool done, std::uint64_t, const std::string& sentence) {
                 if (--*open == 0)
                   reply({done, sentence});
               });
}

void EffectServices::change(const msg::ChangeEffect::Request& request, const bus::Caller& caller) {
  msg::EffectChange message{};
  message.session_id = request.session_id, message.from_sample = request.from_sample,
  message.action = request.action;
  message.effect = request.effect, message.parameter = request.parameter,
  message.model = request.model;
  std::ranges::copy(request.value, message.value);
  message.voxel_size_m = request.voxel_size_m;
  handler_.ask(std::span(&message, 1), false,
               [this, caller](std::size_t, bool done, std::uint64_t from_sample,
                              const std::string& sentence) {
                 change_.reply(caller,
                               [done, from_sample, sentence](auto& response, const auto& send) {
                                 response.done = done, response.from_sample = from_sample;
                                 response.sentence = runtime::lend(sentence);
                                 send();
                               });
               });
}

void EffectServices::parameters_changed() {
  std::vector<RosParameter> before = std::exchange(told_, handler_.parameters());
  if (!answers_ || events_.matched_count() == 0)
    return;  // of two that play one role the acting one tells
  std::vector<msg::rcl_interfaces_Parameter> came, changed, gone;
  for (const RosParameter& now : told_) {
    const RosParameter* const was = find_parameter(before, now.name);
    if (!was)
      came.push_back(ParameterMessages::parameter(now));
    if (was && was->value != now.value)
      changed.push_back(ParameterMessages::parameter(now));
  }
  for (const RosParameter& was : before)
    if (!find_parameter(told_, was.name))
      gone.push_back(ParameterMessages::parameter(was));
  if (came.empty() && changed.empty() && gone.empty())
    return;
  msg::rcl_interfaces_ParameterEvent event{};
  event.stamp = runtime::to_time(runtime::realtime_ns());
  event.node = runtime::lend(node_);
  lend(event.new_parameters, came), lend(event.changed_parameters, changed),
      lend(event.deleted_parameters, gone);
  events_.write(event);
}

}  // namespace voxtouch::rendering_node
