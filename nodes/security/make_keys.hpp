#pragma once
/// What `voxtouch keys` does with a folder: makes it, renews what is in it, revokes a certificate.
/// All throw Error, a sentence.
#include <filesystem>
#include <string>

namespace voxtouch::security {

/// Where it is made: `authority/ca.key.pem` signs everything and leaves this machine never.
inline constexpr char kAuthorityKey[] = "authority/ca.key.pem";

/// A whole folder (mode 0700; private keys 0600): an authority that holds for `10 * days`, and for
/// each role key, certificate and permissions that hold for `days`. Nothing is overwritten; what
/// fails leaves nothing.
void make_keys(const std::filesystem::path& folder, const std::string& rig, int days);

/// A new key, certificate and permissions of `role`, or of "all", and the governance of this
/// version. Returns the rig.
std::string renew_keys(const std::filesystem::path& folder, const std::string& role, int days);

/// Puts the certificate that stands in the folder of `role` into crl.pem.
void revoke_keys(const std::filesystem::path& folder, const std::string& role);

}  // namespace voxtouch::security
