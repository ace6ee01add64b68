// voxtouch_asker DOMAIN GAIN [KEYS ROLE]: calls a ring's services, plain or with a certificate:
// reads `friction.gain`, sets it, and changes it to half of that by change_effect. Prints a line
// for each; `no server` and exit status 1 if no server is found or permitted.
#include <fmt/format.h>

#include <optional>
#include <string>
#include <vector>

#include "nodes/bus/participant.hpp"
#include "nodes/security/key_folder.hpp"
#include "tests/support/service_client.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::seconds;
constexpr char kRig[] = "haptic";
constexpr std::uint8_t kDouble = 3;

template <class Service>
ServiceClient<Service> client_of(const bus::Participant& participant, const qos::Service& row) {
  ServiceClient<Service> client(participant.get(), row, kRig, "rendering");
  if (!client.finds_server(seconds(5)))
    throw bus::Error("no server of " + std::string(row.path));
  return client;
}

/// Whether it was answered.
template <class Service, class F>
void ask(ServiceClient<Service>& client, const typename Service::Request& request, F&& reported) {
  if (!client.call(request, seconds(10), reported))
    throw bus::Error("no answer");
}

void run(const bus::Participant& participant, double gain) {
  auto set = client_of<msg::rcl_interfaces_SetParameters>(participant, qos::kSetParameters);
  auto get = client_of<msg::rcl_interfaces_GetParameters>(participant, qos::kGetParameters);
  auto change = client_of<msg::ChangeEffect>(participant, qos::kChangeEffect);
  char name[] = "friction.gain", effect[] = "friction", none[] = "";
  msg::rcl_interfaces_Parameter parameter{};
  parameter.name = name, parameter.value.string_value = none;
  parameter.value.type = kDouble, parameter.value.double_value = gain;
  msg::rcl_interfaces_SetParameters::Request expected{};
  expected.parameters._buffer = &parameter,
  expected.parameters._length = expected.parameters._maximum = 1;
  char* names[] = {name};
  msg::rcl_interfaces_GetParameters::Request named{};
  named.names._buffer = names, named.names._length = named.names._maximum = 1;
  const auto report = [&] {
    ask(get, named, [](const auto& r) {
      fmt::print("is {}\n", r.values._length == 1 ? r.values._buffer[0].double_value : -1.0);
    });
  };
  report();
  ask(set, expected, [](const auto& r) {
    fmt::print("set {}\n", r.results._length == 1 && r.results._buffer[0].successful);
  });
  report();
  msg::ChangeEffect::Request half{};
  half.action = msg::effect_change::kActionGain;
  half.effect = effect, half.parameter = half.model = none, half.value[0] = 0.5 * gain;
  ask(change, half, [](const auto& r) { fmt::print("changed {}\n", r.done); });
  report();
}

}  // namespace
}  // namespace voxtouch::test

int main(int argc, char** argv) {
  using namespace voxtouch;
  if (argc != 3 && argc != 5)
    return 2;
  try {
    const security::Properties properties =
        argc == 5 ? security::properties_of(argv[3], argv[4], "haptic") : security::Properties{};
    test::run(
        bus::Participant(
            {static_cast<std::uint32_t>(std::stoul(argv[1])), "lo", "asker", {}, {}, properties}),
        std::stod(argv[2]));
    return 0;
  } catch (const std::exception& error) {
    fmt::print("no server: {}\n", error.what());
    return 1;
  }
}
