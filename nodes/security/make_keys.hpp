#pragma once
/// Key folders of `voxtouch keys`: create, renew, revoke. All throw Error.
#include <filesystem>
#include <string>

namespace voxtouch::security {

/// On the machine that creates it: `authority/ca.key.pem` signs everything and must stay there.
inline constexpr char kAuthorityKey[] = "authority/ca.key.pem";

/// Creates a folder (mode 0700; private keys 0600): an authority valid for `10 * days`, and for
/// each role key, certificate and permissions valid for `days`. Overwrites nothing; a failure
/// leaves nothing.
void make_keys(const std::filesystem::path& folder, const std::string& rig, int days);

/// A new key, certificate and permissions of `role`, or of "all", and the governance of this
/// version. Returns the rig.
std::string renew_keys(const std::filesystem::path& folder, const std::string& role, int days);

/// Adds the certificate in the folder of `role` to crl.pem.
void revoke_keys(const std::filesystem::path& folder, const std::string& role);

}  // namespace voxtouch::security
