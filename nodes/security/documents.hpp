#pragma once
/// Governance and permissions of DDS Security, derived from the table of topics (qos/topics.hpp).
#include <string>
#include <string_view>
#include <vector>

namespace voxtouch::security {

/// In addition to the nodes of the ring: `voxtouch up`, which has a status, and all programs that
/// only read or request changes.
inline constexpr std::string_view kLauncher = "up", kTool = "tool";

/// Each has a certificate: the nodes of the ring, kLauncher, kTool.
std::vector<std::string> roles();
/// Role of a participant called `name`: the name if it is a role, otherwise kTool.
std::string role_of(std::string_view name);

/// Common name of a certificate: "haptic.device"; of the authority that signs them:
/// "haptic.authority".
std::string common_name(std::string_view role, std::string_view rig);
inline constexpr std::string_view kAuthority = "authority";

/// Rules for every participant: no unknown participant; participants, endpoints and messages are
/// encrypted.
std::string governance();

/// Topics that `role` may write and read, all others denied, between two times such as
/// "2026-01-31T12:00:00Z". Nodes of the ring follow the table. The logger, `up` and tools read all.
/// `up` writes what every node writes, a tool what no node writes.
std::string permissions(std::string_view role, std::string_view rig, std::string_view from,
                        std::string_view until);

}  // namespace voxtouch::security
