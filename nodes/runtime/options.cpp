#include "nodes/runtime/options.hpp"

#include <sched.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "core/types/number.hpp"
#include "nodes/runtime/rig_roles.hpp"
#include "nodes/runtime/scene_argument.hpp"

namespace voxtouch::runtime {

namespace {

constexpr std::size_t kMaxPrinted = 64;  ///< shown part of a faulty text, in messages

/// The interface name is inserted into the XML configuration of DDS. Kernel names are shorter than
/// the limit; an address is also allowed.
std::string check_interface(const std::string& name) {
  constexpr std::size_t kMaxLength = 64;
  const bool good = !name.empty() && name.size() <= kMaxLength &&
                    std::all_of(name.begin(), name.end(), [](unsigned char c) {
                      return std::isalnum(c) || c == '_' || c == '-' || c == '.' || c == ':' ||
                             c == '@' || c == '%';
                    });
  return good ? std::string()
              : fmt::format("'{}' is not a network interface; `ip link` lists the interfaces",
                            name.substr(0, kMaxPrinted));
}

/// A host name or address is inserted into that XML too.
std::string check_host(const std::string& name) {
  return check_interface(name).empty()
             ? std::string()
             : fmt::format("'{}' is not a host name or address", name.substr(0, kMaxPrinted));
}

constexpr std::uint32_t kLastDomain = 232;

/// Only a program that joins a domain refuses a faulty ROS_DOMAIN_ID, and --domain overrides it.
/// The fault is therefore stored, not thrown.
void take_domain_of_environment(NodeOptions& o) {
  const char* const text = std::getenv("ROS_DOMAIN_ID");
  if (!text || *text == 0)
    return;
  const auto domain = parse_number<std::uint32_t>(text);
  if (domain && *domain <= kLastDomain)
    o.domain = *domain;
  else
    o.domain_fault = fmt::format(
        "ROS_DOMAIN_ID is '{}', valid DDS domains are 0 to {}. Correct it, or use --domain",
        std::string_view(text).substr(0, kMaxPrinted), kLastDomain);
}

}  // namespace

std::string check_rig(const std::string& name) {
  constexpr std::size_t kMaxLength = 64;
  const bool good = !name.empty() && name.size() <= kMaxLength &&
                    std::isalpha(static_cast<unsigned char>(name[0])) &&
                    std::all_of(name.begin(), name.end(),
                                [](unsigned char c) { return std::isalnum(c) || c == '_'; });
  return good ? std::string()
              : fmt::format(
                    "'{}' is not a ROS name: letters, digits and _, starting with a letter, at "
                    "most {} characters",
                    name.substr(0, kMaxPrinted), kMaxLength);
}

std::string require_cpu(const std::string& text) {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0)
    return require_whole(text);  // more than a CPU set holds
  std::string known;
  for (unsigned cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (!CPU_ISSET(cpu, &allowed))
      continue;
    if (text == fmt::to_string(cpu))
      return {};
    known += (known.empty() ? "" : ", ") + fmt::to_string(cpu);
  }
  return fmt::format(
      "CPU '{}' is not available to this process; available {}: {}", text.substr(0, kMaxPrinted),
      CPU_COUNT(&allowed) == 1 ? "is 1" : fmt::format("are {}", CPU_COUNT(&allowed)), known);
}

std::string require_positive(const std::string& text) {
  const auto value = parse_finite(text);
  return value && *value > 0.0 ? ""
                               : "'" + text.substr(0, kMaxPrinted) + "' is not a finite number > 0";
}

std::string require_whole(const std::string& text) {
  // The whole text must fit: CLI11 would clamp a number that is too large.
  return parse_number<std::uint64_t>(text)
             ? ""
             : "'" + text.substr(0, kMaxPrinted) + "' is not an integer >= 0";
}

std::string require_count(const std::string& text) {
  return parse_number<std::uint64_t>(text).value_or(0) > 0
             ? ""
             : "'" + text.substr(0, kMaxPrinted) + "' is not an integer >= 1";
}

std::string check_topic(const std::string& name) {
  constexpr std::size_t kMaxLength = 256;
  const bool good =
      !name.empty() && name.size() <= kMaxLength &&
      std::all_of(name.begin(), name.end(), [](unsigned char c) { return c > ' ' && c <= '~'; });
  return good ? std::string()
              : fmt::format("'{}' is not a DDS topic name, such as rt/joint_states",
                            name.substr(0, kMaxPrinted));
}

bool NodeOptions::has_peer(std::string_view node) const {
  return std::find(peers.begin(), peers.end(), node) != peers.end();
}

void add_rig_options(CLI::App& app, NodeOptions& o) {
  app.add_option("--rig", o.rig, "Name of the rig: namespace of all topics")
      ->capture_default_str()
      ->check(check_rig);
  take_domain_of_environment(o);
  app.add_option("--domain", o.domain, "DDS domain; default: ROS_DOMAIN_ID, else 0")
      ->check(CLI::Range(std::uint32_t{0}, kLastDomain))
      ->each([&o](const std::string&) { o.domain_fault.clear(); });
  app.add_option("--interface", o.network_interface,
                 "Network card, for a ring on several hosts; host: this machine only")
      ->capture_default_str()
      ->check(check_interface);
  app.add_option("--discovery-peer", o.discovery_peers,
                 "Address of a host that multicast does not reach; repeatable")
      ->allow_extra_args(false)
      ->check(check_host);
  app.add_option("--security", o.security, "Folder of `voxtouch keys`: enables DDS Security")
      ->option_text("DIR")
      ->check([](const std::string& text) {
        return std::string(text.empty() ? "the folder name is empty" : "");
      });
  app.add_option("--ros", o.ros,
                 "ROS 2 release for node discovery: humble, or iron for later releases")
      ->transform(CLI::CheckedTransformer(std::map<std::string, bus::RosGraph>{
          {"humble", bus::RosGraph::kHumble}, {"iron", bus::RosGraph::kIron}}))
      ->option_text("humble|iron");
}

void add_node_options(CLI::App& app, NodeOptions& o, bool with_scene) {
  if (with_scene)
    app.add_option("--scene", o.scene, "Scene file (YAML), or the name of a shipped scene")
        ->required()
        ->transform(scene_argument());
  add_rig_options(app, o);
  app.add_option("--seed", o.seed, "Random seed")->capture_default_str()->check(require_whole);
  app.add_flag("--lockstep", o.lockstep,
               "Simulated time: each sample waits for its command; runs are bit-identical");
  app.add_option("--peers", o.peers,
                 "Further nodes of the ring. In lockstep the run waits for all of them; in real "
                 "time a simulated device delays\n"
                 "its first sample until its readers are matched, at most 5 s")
      ->delimiter(',')
      ->check(CLI::IsMember({"rendering", "coupling", "logger", "validator"}));
  app.add_option("--realtime", o.realtime.mode,
                 "If real-time scheduling is refused: ignore (warns) or enforce (fails)")
      ->transform(CLI::CheckedTransformer(std::map<std::string, Realtime>{
          {"ignore", Realtime::kIgnore}, {"enforce", Realtime::kEnforce}}))
      ->option_text("ignore|enforce");
  app.add_option("--cpu", o.realtime.cpu, "Pins the loop to this CPU")->check(require_cpu);
  // Used by `voxtouch up` only.
  app.add_option_function<std::string>(
         "--of-up", [&o](const std::string& text) { o.up = to_guid(text); }, "")
      ->group("");
}

std::vector<std::string> to_arguments(const NodeOptions& o, bool with_scene) {
  std::vector<std::string> a;
  if (with_scene)
    a.insert(a.end(), {"--scene", o.scene.string()});
  a.insert(a.end(), {"--rig", o.rig, "--domain", fmt::to_string(o.domain), "--interface",
                     o.network_interface, "--seed", fmt::to_string(o.seed)});
  for (const std::string& peer : o.discovery_peers)
    a.insert(a.end(), {"--discovery-peer", peer});
  if (!o.security.empty())
    a.insert(a.end(), {"--security", o.security.string()});
  if (o.ros == bus::RosGraph::kHumble)
    a.insert(a.end(), {"--ros", "humble"});
  if (o.lockstep)
    a.push_back("--lockstep");
  if (!o.peers.empty())
    a.insert(a.end(), {"--peers", fmt::format("{}", fmt::join(o.peers, ","))});
  if (o.realtime.mode == Realtime::kEnforce)
    a.insert(a.end(), {"--realtime", "enforce"});
  if (o.up != bus::Guid{})
    a.insert(a.end(), {"--of-up", to_text(o.up)});
  if (o.realtime.cpu)
    a.insert(a.end(), {"--cpu", fmt::to_string(*o.realtime.cpu)});
  return a;
}

}  // namespace voxtouch::runtime
