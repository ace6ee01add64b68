#pragma once
/// Start-up options of every node.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "nodes/bus/entity.hpp"
#include "nodes/bus/network.hpp"
#include "nodes/bus/participant.hpp"
#include "nodes/runtime/realtime.hpp"
#include "nodes/security/documents.hpp"
#include "nodes/security/key_folder.hpp"
#include "qos/topics.hpp"

namespace CLI {
class App;
}

namespace voxtouch::runtime {

/// The nodes of a ring. ROS 2 tools list only these; verbs are short-lived and serve no parameters.
constexpr bool is_ring_node(std::string_view node) noexcept {
  for (const std::string_view known : {"device", "rendering", "coupling", "logger", "validator"})
    if (node == known)
      return true;
  return false;
}

struct NodeOptions {
  std::filesystem::path scene;
  std::string rig = "haptic";
  std::uint32_t domain = 0;
  /// Why ROS_DOMAIN_ID is invalid; empty if it is valid or --domain is given.
  std::string domain_fault;
  std::string network_interface{bus::kThisHost};
  std::vector<std::string> discovery_peers;
  bus::RosGraph ros = bus::RosGraph::kIron;
  std::filesystem::path security;  ///< folder of keys; empty: DDS without security
  bool lockstep = false;
  std::vector<std::string> peers;  ///< participating nodes except the device; see participation.hpp
  std::uint64_t seed = 1;
  RealtimeOptions realtime;
  bus::Guid up{};  ///< the `voxtouch up` that started this node; all zero: started by hand
  bool rig_is_checked = false;  ///< the starting program has checked that the rig is free
  bool announce = false;        ///< print changes on stderr; for nodes that are started by hand
  std::vector<std::string> warnings;  ///< of the start-up; each node keeps them in its reports

  qos::TimeMode mode() const noexcept {
    return lockstep ? qos::TimeMode::kLockstep : qos::TimeMode::kRealTime;
  }
  /// Checks the files of --security first: throws security::Error. Throws bus::Error for an invalid
  /// domain.
  bus::ParticipantOptions participant(const std::string& node) const {
    if (!domain_fault.empty())
      throw bus::Error(domain_fault);
    bus::RosNode ros_node{"/" + rig, node, ros};
    if (!is_ring_node(node))
      ros_node.name.clear();
    return {domain,          network_interface, "voxtouch_" + node + "/" + rig,
            discovery_peers, ros_node,          require_keys(node)};
  }
  /// Security properties for the role of `node`; empty without --security. Throws security::Error
  /// with a sentence.
  security::Properties require_keys(std::string_view node) const {
    return security.empty() ? security::Properties()
                            : security::properties_of(security, security::role_of(node), rig);
  }
  /// Whether `node` is among --peers.
  bool has_peer(std::string_view node) const;
  /// Lockstep has no deadlines, and a loop that never sleeps would block the real-time rings of
  /// this machine.
  RealtimeOptions scheduling() const {
    RealtimeOptions requested = realtime;
    if (lockstep)
      requested.priority = 0;
    return requested;
  }
};

/// Checks for numbers on a command line, with readable messages.
std::string require_positive(const std::string& text);
/// CLI11 would convert a negative number to a huge one.
std::string require_whole(const std::string& text);
std::string require_count(const std::string& text);  ///< a whole number of 1 or more
/// A rig name is part of every topic name.
std::string check_rig(const std::string& name);
/// Checks that a DDS topic may have this name.
std::string check_topic(const std::string& name);
/// Checks for the number of a CPU in the affinity mask of this process.
std::string require_cpu(const std::string& text);

/// Adds --rig, --domain, --interface, --discovery-peer, --security and --ros.
void add_rig_options(CLI::App& app, NodeOptions& options);

/// Adds all node options to a command line; --scene only if `with_scene`.
void add_node_options(CLI::App& app, NodeOptions& options, bool with_scene);

/// The command line that gives these options. `up` starts its child processes with it.
std::vector<std::string> to_arguments(const NodeOptions& options, bool with_scene);

}  // namespace voxtouch::runtime
