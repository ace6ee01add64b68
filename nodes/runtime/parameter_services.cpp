#include "nodes/runtime/parameter_services.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/request_limits.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::runtime {
namespace {

/// Requests of one service per poll, so that no service delays the others.
constexpr int kMaxPerPoll = 64;
constexpr char kUseSimTime[] = "use_sim_time";

/// A sequence that refers to the elements of a vector, which must outlive it.
template <class Sequence, class Element>
void lend_all(Sequence& sequence, std::vector<Element>& elements) {
  sequence._buffer = elements.data();
  sequence._length = sequence._maximum = static_cast<std::uint32_t>(elements.size());
}

/// Collects the results of the settings of one request until all are final.
struct Results {
  struct One {
    bool done = false;
    std::string sentence;
  };
  std::vector<One> all;
  std::size_t open = 0;
};

msg::rcl_interfaces_SetParametersResult message_of(const Results::One& result) {
  // ROS tools print the reason of a refusal. For an applied setting they print the value.
  return {result.done, result.done ? const_cast<char*>("") : lend(result.sentence)};
}

/// Returns nothing if the node must decide. Otherwise returns whether it is done, or the reason for
/// refusal.
std::optional<Results::One> judged(std::span<const RosParameter> known,
                                   const msg::rcl_interfaces_Parameter& requested, bool node_sets) {
  const std::string name = requested.name ? requested.name : "";
  const RosParameter* const parameter = find_parameter(known, name);
  if (parameter && requested.value.type == 0)
    return Results::One{false, fmt::format("'{}' cannot be deleted", name)};
  if (parameter && parameter->read_only && is_same(parameter->value, requested.value))
    return Results::One{true, {}};
  if (name == kUseSimTime)
    return Results::One{false, "'use_sim_time' is read-only: it is true in a ring with --lockstep"};
  if (node_sets)
    return std::nullopt;
  if (parameter)
    return Results::One{false,
                        fmt::format("'{}' is read-only: it is set when the node starts", name)};
  return Results::One{false, fmt::format("unknown parameter '{}'", name)};
}

}  // namespace

bool RequestLimit::admits(std::uint32_t count) {
  bool all = true;
  for (std::uint32_t n = 0; n < std::max(count, 1U); ++n)
    all = admitted_.take(monotonic_ns()).print && all;
  if (!all)
    refused_.fetch_add(1, std::memory_order_relaxed);
  return all;
}

ParameterServices::ParameterServices(const bus::Participant& participant, const std::string& rig,
                                     const std::string& node, bool lockstep,
                                     ParameterHandler handler, RequestLimit& limit)
    : lockstep_(lockstep),
      handler_(std::move(handler)),
      limit_(limit),
      list_(Server<msg::rcl_interfaces_ListParameters>::make<prefixes_fit>(
          participant, qos::kListParameters, rig, node)),
      get_(Server<msg::rcl_interfaces_GetParameters>::make<names_fit>(
          participant, qos::kGetParameters, rig, node)),
      types_(Server<msg::rcl_interfaces_GetParameterTypes>::make<names_fit>(
          participant, qos::kGetParameterTypes, rig, node)),
      describe_(Server<msg::rcl_interfaces_DescribeParameters>::make<names_fit>(
          participant, qos::kDescribeParameters, rig, node)),
      set_(Server<msg::rcl_interfaces_SetParameters>::make<parameters_fit>(
          participant, qos::kSetParameters, rig, node)),
      set_together_(Server<msg::rcl_interfaces_SetParametersAtomically>::make<parameters_fit>(
          participant, qos::kSetParametersAtomically, rig, node)) {}

void ParameterServices::attach_to(bus::WaitSet& wait_set) {
  for (const dds_entity_t condition :
       {list_.condition(), get_.condition(), types_.condition(), describe_.condition(),
        set_.condition(), set_together_.condition()})
    wait_set.attach(condition);
}

bool ParameterServices::waits() const noexcept {
  return list_.waits() || get_.waits() || types_.waits() || describe_.waits() || set_.waits() ||
         set_together_.waits();
}

std::vector<RosParameter> ParameterServices::parameters() const {
  std::vector<RosParameter> all = handler_.parameters();
  RosParameter sim_time{
      .name = kUseSimTime, .value = lockstep_, .meaning = "True if time is simulated (/clock)."};
  sim_time.read_only = true;
  all.insert(std::ranges::lower_bound(all, sim_time.name, {}, &RosParameter::name),
             std::move(sim_time));
  return all;
}

template <class S, class F>
void ParameterServices::each(Server<S>& server, F&& f) {
  server.send_waiting();
  server.take(
      [&](const typename S::Request& request, const bus::Caller& caller) {
        std::uint32_t count = 1;
        if constexpr (requires { request.parameters; })
          count = request.parameters._length;
        if (limit_.admits(count))
          f(request, caller);
      },
      kMaxPerPoll);
}

void ParameterServices::serve() {
  each(list_, [this](const auto& request, const bus::Caller& caller) {
    const std::span prefixes = all_of(request.prefixes);
    ListedParameters listed = list_parameters(
        parameters(), std::vector<std::string>(prefixes.begin(), prefixes.end()), request.depth);
    list_.reply(caller, [listed = std::move(listed)](auto& response, const auto& send) {
      StringViews names(listed.names), own(listed.prefixes);
      names.into(response.result.names), own.into(response.result.prefixes);
      send();
    });
  });
  serve_named();
  each(set_, [this](const auto& request, const bus::Caller& caller) {
    const std::span requested = all_of(request.parameters);
    const auto results = std::make_shared<Results>(
        Results{std::vector<Results::One>(requested.size()), requested.size()});
    const auto reply = [this, caller, results] {
      set_.reply(caller, [results](auto& response, const auto& send) {
        std::vector<msg::rcl_interfaces_SetParametersResult> messages;
        for (const Results::One& one : results->all)
          messages.push_back(message_of(one));
        lend_all(response.results, messages);
        send();
      });
    };
    if (requested.empty())
      return reply();
    set(requested, false, set_.participant_of(caller),
        [results, reply](std::size_t which, bool done, const std::string& sentence) {
          results->all[which] = {done, sentence};
          if (--results->open == 0)
            reply();
        });
  });
  each(set_together_, [this](const auto& request, const bus::Caller& caller) {
    const std::span requested = all_of(request.parameters);
    const auto open = std::make_shared<std::size_t>(requested.size());
    const auto reply = [this, caller](bool done, const std::string& sentence) {
      set_together_.reply(
          caller, [result = Results::One{done, sentence}](auto& response, const auto& send) {
            response.result = message_of(result);
            send();
          });
    };
    if (requested.empty())
      return reply(true, {});
    // The first refusal is reported.
    const auto first = std::make_shared<Results::One>(Results::One{true, {}});
    set(requested, true, set_together_.participant_of(caller),
        [open, first, reply](std::size_t, bool done, const std::string& sentence) {
          if (!done && first->done)
            *first = {done, sentence};
          if (--*open == 0)
            reply(first->done, first->sentence);
        });
  });
}

void ParameterServices::set(std::span<const msg::rcl_interfaces_Parameter> requested, bool together,
                            const bus::Guid& by, const SettingReply& reply) {
  const std::vector<RosParameter> known = parameters();
  std::vector<std::optional<Results::One>> results;
  for (const auto& one : requested)
    results.push_back(judged(known, one, handler_.set != nullptr));
  const auto refusal =
      std::ranges::find_if(results, [](const auto& one) { return one && !one->done; });
  if (together && refusal != results.end()) {
    const std::string sentence = (*refusal)->sentence;
    for (std::size_t n = 0; n < requested.size(); ++n)
      reply(n, false, sentence);
    return;
  }
  std::vector<std::size_t> places;
  std::vector<msg::rcl_interfaces_Parameter> rest;
  for (std::size_t n = 0; n < requested.size(); ++n)
    if (!results[n])
      places.push_back(n), rest.push_back(requested[n]);
  for (std::size_t n = 0; n < requested.size(); ++n)
    if (results[n])
      reply(n, results[n]->done, results[n]->sentence);
  if (!rest.empty())
    handler_.set(rest, together, by,
                 [places, reply](std::size_t which, bool done, const std::string& sentence) {
                   reply(places[which], done, sentence);
                 });
}

template <class Names>
std::vector<RosParameter> ParameterServices::named(const Names& names) const {
  const std::vector<RosParameter> all = parameters();
  std::vector<RosParameter> found;
  for (const char* name : all_of(names)) {
    const RosParameter* const known = find_parameter(all, name);
    found.push_back(known ? *known : RosParameter{.name = name, .value = {}, .meaning = {}});
  }
  return found;
}

void ParameterServices::serve_named() {
  each(get_, [this](const auto& request, const bus::Caller& caller) {
    get_.reply(caller, [found = named(request.names)](auto& response, const auto& send) {
      std::vector<msg::rcl_interfaces_ParameterValue> values;
      for (const RosParameter& parameter : found)
        values.push_back(ParameterMessages::value(parameter.value));
      lend_all(response.values, values);
      send();
    });
  });
  each(types_, [this](const auto& request, const bus::Caller& caller) {
    types_.reply(caller, [found = named(request.names)](auto& response, const auto& send) {
      std::vector<std::uint8_t> types;
      for (const RosParameter& parameter : found)
        types.push_back(type_of(parameter.value));
      lend_all(response.types, types);
      send();
    });
  });
  each(describe_, [this](const auto& request, const bus::Caller& caller) {
    describe_.reply(caller, [found = named(request.names)](auto& response, const auto& send) {
      ParameterMessages messages;
      std::vector<msg::rcl_interfaces_ParameterDescriptor> descriptors;
      for (const RosParameter& parameter : found)
        descriptors.push_back(messages.descriptor(parameter));
      lend_all(response.descriptors, descriptors);
      send();
    });
  });
}

}  // namespace voxtouch::runtime
