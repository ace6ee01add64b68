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

/// What DDS is given: names and values of a participant's properties.
using Properties = std::vector<std::pair<std::string, std::string>>;

/// Judges every file that `role` of `rig` needs, as strictly as DDS will, and returns what DDS is
/// to be given. Reads files; not for the loop. Throws Error, one sentence with the file and what to
/// do, where one is missing, unreadable, expired, revoked, of another authority, role, rig or
/// version of voxtouch, or where a private key is open to others.
Properties properties_of(const std::filesystem::path& folder, std::string_view role,
                         std::string_view rig);

/// The text of a file. Throws Error.
std::string read_file(const std::filesystem::path& file);
/// The same of a private key, which only its owner may read.
std::string read_private_file(const std::filesystem::path& file);

}  // namespace voxtouch::security
