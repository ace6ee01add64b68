#include <chrono>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <dds/version.h>

#include "core/types/program_folder.hpp"
#include "nodes/bus/exchange.hpp"
#include "nodes/bus/participant.hpp"
#include "nodes/bus/ros_discovery.hpp"
#include "nodes/cli/child_program.hpp"
#include "nodes/cli/doctor/doctor_checks.hpp"
#include "nodes/cli/doctor/machine_checks.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/console/log.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/options.hpp"
#include "nodes/runtime/signals.hpp"

namespace voxtouch::cli {
namespace {

/// Other participants on the domain: joins it for 2 s.
std::vector<Finding> check_neighbours(const runtime::NodeOptions& o) {
  const bus::Participant own(o.participant("doctor"));
  bus::RosDiscovery found(own);
  std::this_thread::sleep_for(std::chrono::seconds(2));
  found.poll();
  std::vector<Finding> findings{
      {Health::kGood,
       fmt::format("{} participants of ROS 2 or voxtouch on domain {}, {} others; Cyclone DDS {}",
                   found.ros_participants(), o.domain, found.other_participants(), DDS_VERSION)}};
  if (std::string mismatch = found.mismatch(o.ros); !mismatch.empty())
    findings.push_back({Health::kWarning, std::move(mismatch)});
  return findings;
}

constexpr char kEchoRig[] = "voxtouch_doctor", kEcho[] = "echo";

/// The other process of an exchange: writes a status for 1.5 s.
int echo(const runtime::NodeOptions& o) {
  runtime::catch_signals();
  const bus::Participant own(o.participant(kEcho));
  runtime::StatusWriter writer(own, kEcho, kEchoRig);
  for (int n = 0; n < 15 && !runtime::stop_requested().load(); ++n) {
    writer.publish({}, false);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return 0;
}

/// A second process writes a status on the domain, and this one reads it.
Finding check_exchange(const runtime::NodeOptions& o) {
  const bus::Participant own(o.participant("doctor"));
  runtime::NodeRegistry registry(own, kEchoRig);
  std::vector<std::string> words{(program_folder() / "voxtouch").string(),
                                 "doctor",
                                 "--echo",
                                 "--domain",
                                 fmt::to_string(o.domain),
                                 "--interface",
                                 o.network_interface};
  for (const std::string& peer : o.discovery_peers)
    words.insert(words.end(), {"--discovery-peer", peer});
  constexpr std::chrono::seconds kPatience{10};
  const auto begun = std::chrono::steady_clock::now();
  std::optional<double> took_s;
  const auto ended = run_program(
      {.words = words, .patience = kPatience, .listen = [&](std::string_view) {
         registry.update();
         if (!took_s && registry.find(kEcho))
           took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
       }});
  if (took_s)
    return {Health::kGood,
            fmt::format("DDS between two processes works (first message after {:.2f} s)", *took_s)};
  if (ended && ended->status != 0)
    return {Health::kBad,
            fmt::format("A second process cannot join domain {}: {}", o.domain, ended->said)};
  const char* const uri = std::getenv("CYCLONEDDS_URI");
  return {Health::kBad,
          fmt::format("Two processes on this machine do not receive each other over DDS: {}",
                      bus::reception_fault(o.network_interface, o.domain, uri ? uri : ""))};
}

int doctor(const runtime::NodeOptions& o) {
  bool is_bad = false;
  const auto print = [&](const std::vector<Finding>& findings) {
    static constexpr std::string_view kMarks[] = {"ok     ", "warning", "BAD    "};
    for (const Finding& finding : findings) {
      console::print_result("{}  {}\n", kMarks[static_cast<std::size_t>(finding.health)],
                            finding.sentence);
      is_bad = is_bad || finding.health == Health::kBad;
    }
  };
  if (const char* uri = std::getenv("CYCLONEDDS_URI"); uri && bus::names_cards(uri))
    print({{Health::kWarning,
            "CYCLONEDDS_URI selects network cards and overrides --interface: other machines can "
            "reach the ring"}});
  else
    print(check_cards(o.network_interface, bus::network_cards()));
  std::ifstream udp("/proc/net/udp");
  print({check_indices(taken_indices(udp, o.domain))});
  print({check_kernel(), check_limits()});
  print(check_rights());
  print({check_governors()});
  print(check_link(o.network_interface));
  print(check_devices());
  if (!is_bad && o.security.empty())
    print({check_exchange(o)});  // keys are for the topics of their rig
  if (is_bad)
    return 1;
  print(check_neighbours(o));
  console::print_result("\nIf ROS 2 (rmw_cyclonedds_cpp) does not discover the ring, set:\n{}",
                        ros_environment(o.domain, o.network_interface));
  return 0;
}

}  // namespace

void add_doctor(CLI::App& app, Action& action) {
  auto o = std::make_shared<runtime::NodeOptions>();
  CLI::App* verb = app.add_subcommand("doctor");
  runtime::add_rig_options(*verb, *o);
  auto is_echo = std::make_shared<bool>(false);
  verb->add_flag("--echo", *is_echo, "Second process of the DDS check")->group("");
  verb->callback([o, is_echo, &action] {
    action = [o, is_echo] { return *is_echo ? echo(*o) : doctor(*o); };
  });
}

}  // namespace voxtouch::cli
