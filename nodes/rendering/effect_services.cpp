#include "nodes/rendering/effect_services.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/request_limits.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::rendering_node {
namespace {

/// Requests per poll.
constexpr int kMaxPerPoll = 64;

/// A sequence that refers to the elements of a vector, which must outlive it.
template <class Sequence, class Element>
void lend(Sequence& sequence, std::vector<Element>& elements) {
  sequence._buffer = elements.data();
  sequence._length = sequence._maximum = static_cast<std::uint32_t>(elements.size());
}

}  // namespace

EffectServices::EffectServices(const bus::Participant& participant, const std::string& rig,
                               bool lockstep, ChangeHandler handler)
    : node_("/" + rig + "/rendering"),
      handler_(std::move(handler)),
      change_(bus::ServiceServer<msg::ChangeEffect>::make<runtime::change_fits>(
          participant, qos::kChangeEffect, rig, "rendering")),
      parameters_(
          participant, rig, "rendering", lockstep,
          {handler_.parameters,
           [this](auto parameters, bool together, const bus::Guid& by,
                  const runtime::SettingReply& reply) { set(parameters, together, by, reply); }},
          limit_),
      events_(participant, qos::kParameterEvents, rig, qos::profile(qos::kParameterEvents.profile)),
      published_(handler_.parameters()) {}

void EffectServices::attach_to(bus::WaitSet& wait_set) {
  wait_set.attach(change_.condition());
  parameters_.attach_to(wait_set);
}

bool EffectServices::waits() const noexcept { return change_.waits() || parameters_.waits(); }

void EffectServices::serve() {
  parameters_.serve();
  change_.send_waiting();
  change_.take(
      [this](const msg::ChangeEffect::Request& request, const bus::Caller& caller) {
        if (limit_.admits(1))
          change(request, caller);
      },
      kMaxPerPoll);
}

void EffectServices::set(std::span<const msg::rcl_interfaces_Parameter> parameters, bool together,
                         const bus::Guid& by, const runtime::SettingReply& reply) {
  const std::vector<RosParameter> known = handler_.parameters();
  std::vector<ParameterChange> changes;
  std::vector<std::size_t> places;
  for (std::size_t n = 0; n < parameters.size(); ++n) {
    auto requested = change_of(known, parameters[n]);
    if (!requested && together) {
      for (std::size_t all = 0; all < parameters.size(); ++all)
        reply(all, false, requested.error());
      return;
    }
    if (!requested) {
      reply(n, false, requested.error());
      continue;
    }
    changes.push_back(std::move(*requested)), places.push_back(n);
  }
  std::vector<msg::EffectChange> messages;
  for (const ParameterChange& requested : changes)
    messages.push_back(requested.message());
  const auto reply_at = [reply](std::size_t place, bool done, const std::string& sentence) {
    reply(place, done, sentence);
  };
  if (together)
    return handler_.ask(messages, true, by,
                        [places, reply_at](std::size_t which, bool done, std::uint64_t,
                                           const std::string& sentence) {
                          reply_at(places[which], done, sentence);
                        });
  for (std::size_t n = 0; n < messages.size(); ++n)
    handler_.ask(std::span(&messages[n], 1), false, by,
                 [place = places[n], reply_at](std::size_t, bool done, std::uint64_t,
                                               const std::string& sentence) {
                   reply_at(place, done, sentence);
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
  handler_.ask(std::span(&message, 1), false, change_.participant_of(caller),
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
  std::vector<RosParameter> before = std::exchange(published_, handler_.parameters());
  if (events_.matched_count() == 0)
    return;
  std::vector<msg::rcl_interfaces_Parameter> came, changed, gone;
  for (const RosParameter& now : published_) {
    const RosParameter* const was = find_parameter(before, now.name);
    if (!was)
      came.push_back(ParameterMessages::parameter(now));
    if (was && was->value != now.value)
      changed.push_back(ParameterMessages::parameter(now));
  }
  for (const RosParameter& was : before)
    if (!find_parameter(published_, was.name))
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
