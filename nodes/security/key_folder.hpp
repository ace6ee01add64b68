#pragma once
/// The folder that `voxtouch keys` made, as far as a participant needs it: ca.cert.pem,
/// governance.p7s, crl.pem, and the folder of its role with cert.pem, key.pem, permissions.p7s.
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nodes/security/credentials.hpp"

namespace voxtouch::security {

/// Names and values of a participant's DDS properties.
using Properties = std::vector<std::pair<std::string, std::string>>;

/// Validates every file that `role` of `rig` needs, as strictly as DDS, and returns the DDS
/// properties. Reads files; not for the loop. Throws Error with the file and the remedy: a file is
/// missing, unreadable, expired, revoked, of another authority, role, rig or version of voxtouch,
/// or a private key has open rights.
Properties properties_of(const std::filesystem::path& folder, std::string_view role,
                         std::string_view rig);

/// The text of a file. Throws Error.
std::string read_file(const std::filesystem::path& file);
/// The same of a private key, which only its owner may read.
std::string read_private_file(const std::filesystem::path& file);

}  // namespace voxtouch::security
