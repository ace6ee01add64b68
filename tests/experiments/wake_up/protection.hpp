#pragma once
/// Keys with governance for one of the protection kinds of DDS Security, to measure the cost of
/// each. Every topic is permitted.
#include <filesystem>
#include <string>
#include <vector>

#include "nodes/security/key_folder.hpp"

namespace voxtouch::wake_up {

/// Names of the kinds, from none to all; `voxtouch keys` uses "submessage".
std::vector<std::string> protections();
/// Into a new folder.
void make_keys_of(const std::string& protection, const std::filesystem::path& folder);
/// For a participant.
security::Properties protected_by(const std::filesystem::path& folder);

}  // namespace voxtouch::wake_up
