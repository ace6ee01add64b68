#pragma once
/// Who may do what on the network, as DDS Security wants it written: derived from the table of
/// topics (qos/topics.hpp).
#include <string>
#include <string_view>
#include <vector>

namespace voxtouch::security {

/// In addition to the nodes of the ring: `voxtouch up`, which has a status of its own, and
/// everything that only looks or asks for changes.
inline constexpr std::string_view kLauncher = "up", kTool = "tool";

/// Each has a certificate: the nodes of the ring, kLauncher, kTool.
std::vector<std::string> roles();
/// Of a participant called `name`: its own name where that is a role, else kTool.
std::string role_of(std::string_view name);

/// Common name of a certificate: "haptic.device"; of the authority that signs them:
/// "haptic.authority".
std::string common_name(std::string_view role, std::string_view rig);
inline constexpr std::string_view kAuthority = "authority";

/// What holds for every participant: no unknown participant; participants and endpoints are
/// encrypted, and so is every message.
std::string governance();

/// What `role` may write and read, everything else being denied, between two times such as
/// "2026-01-31T12:00:00Z". Nodes of the ring write and read as the table says; the logger, `up` and
/// tools read all; `up` writes what every node writes, a tool what no node does.
std::string permissions(std::string_view role, std::string_view rig, std::string_view from,
                        std::string_view until);

}  // namespace voxtouch::security
