#pragma once
/// What every node is given when it starts.
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

/// The nodes of a ring. ROS 2 tools see them alone as nodes: verbs come and go, and serve no
/// parameters.
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
  std::string domain_fault;  ///< why ROS_DOMAIN_ID is no domain; empty where it is one, or --domain
                             ///< is given
  std::string network_interface{bus::kThisHost};
  std::vector<std::string> discovery_peers;
  bus::RosGraph ros = bus::RosGraph::kIron;
  std::filesystem::path security;  ///< folder of keys; empty: plain DDS
  bool lockstep = false;
  std::vector<std::string>
      peers;  ///< the nodes that take part, the device aside; see participation.hpp
  std::uint64_t seed = 1;
  RealtimeOptions realtime;
  bus::Guid up{};               ///< the `voxtouch up` that started this node; all zero: none did
  bool rig_is_checked = false;  ///< whoever started this node has checked that the rig is free
  bool announce = false;        ///< say on stderr what changes; for nodes that are started by hand
  std::vector<std::string> warnings;  ///< of the start-up; each node keeps them in its reports

  qos::TimeMode mode() const noexcept {
    return lockstep ? qos::TimeMode::kLockstep : qos::TimeMode::kRealTime;
  }
  /// Judges the files of --security first: throws security::Error. Throws bus::Error where the
  /// domain is none.
  bus::ParticipantOptions participant(const std::string& node) const {
    if (!domain_fault.empty())
      throw bus::Error(domain_fault);
    bus::RosNode shown{"/" + rig, node, ros};
    if (!is_ring_node(node))
      shown.name.clear();
    return {domain, network_interface, "voxtouch_" + node + "/" + rig, discovery_peers,
            shown,  require_keys(node)};
  }
  /// Of the role that `node` has; nothing without --security. Throws security::Error, a sentence.
  security::Properties require_keys(std::string_view node) const {
    return security.empty() ? security::Properties()
                            : security::properties_of(security, security::role_of(node), rig);
  }
  /// Whether `node` is among --peers.
  bool has_peer(std::string_view node) const;
  /// In lockstep no deadline is to be met, and a loop that never rests would keep the real-time
  /// rings of this machine from running.
  RealtimeOptions scheduling() const {
    RealtimeOptions asked = realtime;
    if (lockstep)
      asked.priority = 0;
    return asked;
  }
};

/// For numbers on a command line: a check with a message that a person can read.
std::string require_positive(const std::string& text);
/// CLI11 would take a negative number for a huge one.
std::string require_whole(const std::string& text);
std::string require_count(const std::string& text);  ///< a whole number of 1 or more
/// A rig becomes part of every topic name.
std::string check_rig(const std::string& name);
/// A name that a DDS topic may have.
std::string check_topic(const std::string& name);
/// The number of a CPU that this process may run on (its affinity mask).
std::string require_cpu(const std::string& text);

/// --rig, --domain, --interface and --discovery-peer, --security and --ros alone: whom to talk to.
void add_rig_options(CLI::App& app, NodeOptions& options);

/// Adds the options above to a command line: --scene (where `with_scene`), --rig, --domain,
/// --interface, --lockstep, ...
void add_node_options(CLI::App& app, NodeOptions& options, bool with_scene);

/// The command line of a node that gets exactly these options: what `up` starts its children with.
std::vector<std::string> to_arguments(const NodeOptions& options, bool with_scene);

}  // namespace voxtouch::runtime
