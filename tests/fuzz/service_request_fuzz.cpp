// Requests of the rendering's services, as clients send them. Storage is bounded, answers refer to
// existing parameters, an accepted request leaves every effect within its ranges, and a refused one
// changes nothing and gives a printable reason.
#include "nodes/rendering/effect_action.hpp"
#include "nodes/rendering/effect_parameters.hpp"
#include "nodes/runtime/request_limits.hpp"
#include "tests/fuzz/effects.hpp"
#include "tests/fuzz/service_types.hpp"
#include "tests/fuzz/wire.hpp"

namespace {

using namespace voxtouch;
using namespace voxtouch::rendering_node;
using fuzz::Asked;
using runtime::all_of, runtime::change_fits, runtime::names_fit, runtime::parameters_fit,
    runtime::prefixes_fit;

std::string_view view(const char* text) { return text ? text : ""; }

void require_sentence(const std::string& sentence) {
  constexpr std::size_t kLongest = 4096;  // known names, and 64 characters of an unknown one
  FUZZ_REQUIRE(!sentence.empty() && sentence.size() < kLongest);
  for (const char c : sentence)
    FUZZ_REQUIRE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f);
}

/// The rendering without its threads: its effects' values and the path of every change.
class Rendering {
 public:
  std::vector<RosParameter> parameters() const { return parameters_of(scene_, effects_); }

  void list(const msg::rcl_interfaces_ListParameters::Request& request) const {
    const std::vector<std::string> prefixes(request.prefixes._buffer,
                                            request.prefixes._buffer + request.prefixes._length);
    const std::vector<RosParameter> all = parameters();
    for (const std::string& name : list_parameters(all, prefixes, request.depth).names) {
      FUZZ_REQUIRE(find_parameter(all, name));
      FUZZ_REQUIRE(prefixes.empty() ||
                   std::ranges::any_of(prefixes, [&](const std::string& prefix) {
                     return name.starts_with(prefix);
                   }));
    }
  }

  template <class Request>
  void send(const Request& request) const {
    const std::vector<RosParameter> all = parameters();
    ParameterMessages messages;
    for (const char* name : all_of(request.names)) {
      const RosParameter* known = find_parameter(all, name);
      if (!known)
        continue;
      const auto descriptor = messages.descriptor(*known);
      FUZZ_REQUIRE(view(descriptor.name) == name &&
                   descriptor.type == ParameterMessages::value(known->value).type &&
                   descriptor.type != 0);
    }
  }

  void set(const msg::rcl_interfaces_Parameter& asked) {
    const std::vector<RosParameter> all = parameters();
    const auto expected = change_of(all, asked);
    if (!expected)
      return require_sentence(expected.error());
    const msg::EffectChange message = expected->message();
    const RosParameter* known = find_parameter(all, view(asked.name));
    if (change(std::span(&message, 1)))
      FUZZ_REQUIRE(known && !known->read_only);
  }

  void set_together(std::span<const msg::rcl_interfaces_Parameter> asked) {
    const std::vector<RosParameter> all = parameters();
    std::vector<ParameterChange> changes;
    for (const auto& parameter : asked) {
      auto expected = change_of(all, parameter);
      if (!expected)
        return require_sentence(expected.error());
      changes.push_back(std::move(*expected));
    }
    std::vector<msg::EffectChange> messages;
    for (const ParameterChange& expected : changes)
      messages.push_back(expected.message());
    if (!change(messages))
      FUZZ_REQUIRE(parameters() == all);  // all of them or none
  }

  void change(const msg::ChangeEffect::Request& request) {
    msg::EffectChange message{};
    message.action = request.action, message.effect = request.effect,
    message.parameter = request.parameter;
    std::ranges::copy(request.value, message.value);
    (void)change(std::span(&message, 1));
  }

 private:
  bool change(std::span<const msg::EffectChange> messages) {
    std::vector<effects::EffectRequest> requests;
    for (const msg::EffectChange& m : messages)
      requests.push_back({.action = effect_action(m.action),
                          .effect = view(m.effect),
                          .parameter = view(m.parameter),
                          .value = {m.value[0], m.value[1], m.value[2]}});
    const auto commands = effects::judge(effects_, requests);
    if (!commands) {
      require_sentence(commands.error());
      return false;
    }
    for (const effects::EffectCommand& command : *commands)
      effects::carry_out(effects_.at(command.effect), command);
    for (const effects::EffectSpec& effect : effects_)
      fuzz::require_good(effect);
    return true;
  }

  scene::Scene scene_;
  std::vector<effects::EffectSpec> effects_ = fuzz::all_effects();
};

/// Calls f(request) if DDS would store it.
template <class Service, class Fits, class F>
void receive(std::string_view cdr, Fits&& fits_in, F&& f) {
  static fuzz::Wire<typename Service::Request> wire;
  wire.through(cdr, [&](const typename Service::Request& request) {
    if (fits_in(request))
      f(request);
  });
}

void receive(Rendering& rendering, Asked asked, std::string_view cdr) {
  const auto send = [&](const auto& request) { rendering.send(request); };
  const auto named = [](const auto& request) { return names_fit(request); };
  const auto fitting = [](const auto& request) { return parameters_fit(request); };
  switch (asked) {
    case Asked::kList:
      return receive<msg::rcl_interfaces_ListParameters>(cdr, prefixes_fit,
                                                         [&](const auto& r) { rendering.list(r); });
    case Asked::kGet:
      return receive<msg::rcl_interfaces_GetParameters>(cdr, named, send);
    case Asked::kTypes:
      return receive<msg::rcl_interfaces_GetParameterTypes>(cdr, named, send);
    case Asked::kDescribe:
      return receive<msg::rcl_interfaces_DescribeParameters>(cdr, named, send);
    case Asked::kSet:
      return receive<msg::rcl_interfaces_SetParameters>(cdr, fitting, [&](const auto& r) {
        for (const auto& parameter : all_of(r.parameters))
          rendering.set(parameter);
      });
    case Asked::kSetTogether:
      return receive<msg::rcl_interfaces_SetParametersAtomically>(
          cdr, fitting, [&](const auto& r) { rendering.set_together(all_of(r.parameters)); });
    case Asked::kChange:
      return receive<msg::ChangeEffect>(cdr, change_fits,
                                        [&](const auto& r) { rendering.change(r); });
  }
}

}  // namespace

/// Consecutive requests, each after a byte for the service and two for its length.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Rendering rendering;
  fuzz::Bytes in(data, size);
  for (int n = 0; n < 8 && !in.empty(); ++n) {
    const auto asked = static_cast<Asked>(in.take<std::uint8_t>() % fuzz::kKindsOfRequests);
    std::string cdr("\0\1\0\0", 4);
    cdr += in.take(in.take<std::uint16_t>());
    receive(rendering, asked, cdr);
  }
  return 0;
}
