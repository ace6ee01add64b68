#include "nodes/security/make_keys.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include <fmt/format.h>

#include "nodes/security/credentials.hpp"
#include "nodes/security/documents.hpp"
#include "nodes/security/key_folder.hpp"

namespace voxtouch::security {
namespace {

namespace fs = std::filesystem;
constexpr mode_t kPrivate = 0600, kPublic = 0644;

[[noreturn]] void fail(const fs::path& path) {
  throw Error(fmt::format("Cannot write {} ({})", path.string(), std::strerror(errno)));
}

/// Atomic, also if it replaces a file; its rights never exceed `mode`.
void write_file(const fs::path& file, const std::string& text, mode_t mode) {
  fs::path fresh = file;
  fresh += ".new";
  unlink(fresh.c_str());
  const int fd = open(fresh.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  if (fd < 0)
    fail(fresh);
  const bool is_whole =
      write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size()) && fsync(fd) == 0;
  if (close(fd) != 0 || !is_whole || rename(fresh.c_str(), file.c_str()) != 0)
    fail(file);
}

void make_folder(const fs::path& folder) {
  if (mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
    fail(folder);
}

void write_role(const fs::path& folder, const Signer& authority, const std::string& role,
                const std::string& rig, int days) {
  const Key key = make_key();
  const Certificate certificate = issue(authority, *key, common_name(role, rig), days);
  const std::string may = permissions(role, rig, to_text(*X509_get0_notBefore(certificate.get())),
                                      to_text(*X509_get0_notAfter(certificate.get())));
  const std::string signed_text = sign(authority, may);
  make_folder(folder / role);
  write_file(folder / role / "key.pem", to_pem(*key), kPrivate);
  write_file(folder / role / "cert.pem", to_pem(*certificate), kPublic);
  write_file(folder / role / "permissions.p7s", signed_text, kPublic);
}

Signer authority_of(const fs::path& folder) {
  const fs::path key = folder / kAuthorityKey, certificate = folder / "ca.cert.pem";
  if (!fs::exists(key))
    throw Error(fmt::format(
        "{} is missing. Certificates are renewed and revoked in the folder of `voxtouch keys`",
        key.string()));
  Signer authority{certificate_of(read_file(certificate), certificate),
                   key_of(read_private_file(key), key)};
  if (X509_check_private_key(authority.certificate.get(), authority.key.get()) != 1)
    throw Error(fmt::format("{} does not match {}", key.string(), certificate.string()));
  return authority;
}

}  // namespace

void make_keys(const fs::path& folder, const std::string& rig, int days) {
  if (fs::exists(fs::symlink_status(folder)))
    throw Error(fmt::format("{} exists and is not overwritten. Choose another folder, or --renew",
                            folder.string()));
  const fs::path whole = fs::absolute(folder);
  std::string fresh = whole.string() + ".XXXXXX";
  if (!mkdtemp(fresh.data()))
    fail(whole);  // mode 0700
  try {
    const Signer authority = make_authority(common_name(kAuthority, rig), 10 * days);
    const fs::path in = fresh;
    make_folder(in / kAuthority);
    write_file(in / kAuthorityKey, to_pem(*authority.key), kPrivate);
    write_file(in / "ca.cert.pem", to_pem(*authority.certificate), kPublic);
    write_file(in / "governance.p7s", sign(authority, governance()), kPublic);
    write_file(in / "crl.pem", to_pem(*make_revocation_list(authority, nullptr, nullptr)), kPublic);
    for (const std::string& role : roles())
      write_role(in, authority, role, rig, days);
    if (renameat2(AT_FDCWD, fresh.c_str(), AT_FDCWD, whole.c_str(), RENAME_NOREPLACE) != 0)
      fail(whole);
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(fresh, ignored);
    throw;
  }
}

std::string renew_keys(const fs::path& folder, const std::string& role, int days) {
  const Signer authority = authority_of(folder);
  const std::string name = common_name_of(*authority.certificate),
                    rig = name.substr(0, name.find('.'));
  write_file(folder / "governance.p7s", sign(authority, governance()), kPublic);
  for (const std::string& one : roles())
    if (role == "all" || role == one)
      write_role(folder, authority, one, rig, days);
  return rig;
}

void revoke_keys(const fs::path& folder, const std::string& role) {
  const Signer authority = authority_of(folder);
  const fs::path list = folder / "crl.pem", certificate = folder / role / "cert.pem";
  const RevocationList old = revocation_list_of(read_file(list), list);
  const Certificate revoked = certificate_of(read_file(certificate), certificate);
  if (is_revoked(*old, *revoked))
    throw Error(fmt::format("{} is already revoked", certificate.string()));
  write_file(list, to_pem(*make_revocation_list(authority, old.get(), revoked.get())), kPublic);
}

}  // namespace voxtouch::security
