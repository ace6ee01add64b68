#pragma once
/// Keys whose rules protect messages in one of the ways that DDS Security has, to measure what each
/// costs. Every topic is allowed.
#include <filesystem>
#include <string>
#include <vector>

#include "nodes/security/key_folder.hpp"

namespace voxtouch::wake_up {

/// Names of the kinds, from none to all; "submessage" is what `voxtouch keys` signs.
std::vector<std::string> protections();
/// Into a new folder.
void make_keys_of(const std::string& protection, const std::filesystem::path& folder);
/// For a participant.
security::Properties protected_by(const std::filesystem::path& folder);

}  // namespace voxtouch::wake_up
