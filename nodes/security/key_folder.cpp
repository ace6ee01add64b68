#include "nodes/security/key_folder.hpp"

#include <dlfcn.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include <dds/dds.h>
#include <fmt/format.h>
#include <openssl/x509_vfy.h>

#include "nodes/security/documents.hpp"

namespace voxtouch::security {
namespace {

namespace fs = std::filesystem;

/// The plugins belong to the DDS library in use: they are next to it, or in a folder of its name
/// there (Debian).
fs::path plugin(const std::string& name) {
  Dl_info found{};
  if (dladdr(reinterpret_cast<const void*>(&dds_create_participant), &found) == 0 ||
      !found.dli_fname)
    throw Error("Cannot find the loaded DDS library and its DDS Security plugins");
  const fs::path library = found.dli_fname;
  std::string own_folder = library.filename().string();  // libddsc.so.0debian
  if (const auto at = own_folder.find(".so."); at != std::string::npos)
    own_folder.erase(at, 4);
  for (const fs::path& folder : {library.parent_path() / own_folder, library.parent_path()})
    if (fs::path file = folder / ("lib" + name + ".so"); fs::exists(file))
      return file;
  throw Error(
      fmt::format("lib{}.so is neither next to {} nor in {}: this DDS has no DDS Security. Use "
                  "Debian's libddsc0debian",
                  name, library.string(), own_folder));
}

std::string renew(std::string_view role) {
  return fmt::format("renew it with `voxtouch keys --renew {} --out DIR` in the CA's folder", role);
}

/// The signature, dates and revocation of `certificate`.
void require_trusted(X509& certificate, X509& authority, X509_CRL& revoked, const fs::path& file,
                     std::string_view role) {
  const std::unique_ptr<X509_STORE, Free<X509_STORE_free>> store(X509_STORE_new());
  const std::unique_ptr<X509_STORE_CTX, Free<X509_STORE_CTX_free>> context(X509_STORE_CTX_new());
  if (!store || !context || X509_STORE_add_cert(store.get(), &authority) != 1 ||
      X509_STORE_add_crl(store.get(), &revoked) != 1 ||
      X509_STORE_set_flags(store.get(), X509_V_FLAG_CRL_CHECK) != 1 ||
      X509_STORE_CTX_init(context.get(), store.get(), &certificate, nullptr) != 1)
    throw Error(fmt::format("Cannot check {}", file.string()));
  if (X509_verify_cert(context.get()) == 1)
    return;
  switch (const int code = X509_STORE_CTX_get_error(context.get())) {
    case X509_V_ERR_CERT_HAS_EXPIRED:
      throw Error(fmt::format("{} expired on {}: {}", file.string(),
                              to_text(*X509_get0_notAfter(&certificate)), renew(role)));
    case X509_V_ERR_CERT_NOT_YET_VALID:
      throw Error(fmt::format("{} is not valid before {}. Set this machine's clock", file.string(),
                              to_text(*X509_get0_notBefore(&certificate))));
    case X509_V_ERR_CERT_REVOKED:
      throw Error(fmt::format("{} is revoked: {}", file.string(), renew(role)));
    default:
      throw Error(
          fmt::format("{} is not signed by the CA of ca.cert.pem in the same folder ({}). Copy all "
                      "files again from the folder of `voxtouch keys`",
                      file.string(), X509_verify_cert_error_string(code)));
  }
}

void require_text(const std::string& text, const std::string& expected, const fs::path& file,
                  std::string_view whose) {
  if (text != expected)
    throw Error(
        fmt::format("{} does not match this version's permissions for {}. Sign it again with "
                    "`voxtouch keys --renew all --out DIR` in the CA's folder",
                    file.string(), whose));
}

std::string file_value(const fs::path& file) { return "file:" + fs::absolute(file).string(); }

}  // namespace

std::string read_file(const fs::path& file) {
  std::error_code error;
  const auto status = fs::status(file, error);
  if (status.type() == fs::file_type::not_found)
    throw Error(
        fmt::format("{} is missing. Copy it from the folder of `voxtouch keys`", file.string()));
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  std::string text;
  if (fs::is_regular_file(status) && in)
    text.assign(std::istreambuf_iterator<char>(in), {});
  if (!fs::is_regular_file(status) || !in)
    throw Error(fmt::format("Cannot read {} ({}). It must be a file readable by this user",
                            file.string(),
                            fs::is_regular_file(status) ? std::strerror(errno) : "not a file"));
  return text;
}

std::string read_private_file(const fs::path& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) == 0 && S_ISREG(status.st_mode) && (status.st_mode & 077U) != 0)
    throw Error(
        fmt::format("Private key {} is readable by other users. Run `chmod 600` on it, and renew "
                    "it if it may be copied",
                    file.string()));
  return read_file(file);
}

Properties properties_of(const fs::path& folder, std::string_view role, std::string_view rig) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
    throw Error(fmt::format(
        "--security {} is not a folder. Make one with `voxtouch keys --out DIR`", folder.string()));
  const fs::path ca = folder / "ca.cert.pem", crl = folder / "crl.pem",
                 rules = folder / "governance.p7s", own = folder / role,
                 certificate = own / "cert.pem", key = own / "key.pem",
                 may = own / "permissions.p7s";
  const Certificate authority = certificate_of(read_file(ca), ca);
  if (is_over(*X509_get0_notAfter(authority.get())))
    throw Error(fmt::format(
        "{} expired on {}. Make a new folder with `voxtouch keys --out` and copy it to every host",
        ca.string(), to_text(*X509_get0_notAfter(authority.get()))));
  const RevocationList revoked = revocation_list_of(read_file(crl), crl);
  if (X509_CRL_verify(revoked.get(), X509_get0_pubkey(authority.get())) != 1)
    throw Error(fmt::format(
        "{} is not signed by the CA of ca.cert.pem in the same folder. Copy both from one folder",
        crl.string()));
  require_text(verified(read_file(rules), *authority, rules), governance(), rules, "every node");

  const Certificate identity = certificate_of(read_file(certificate), certificate);
  require_trusted(*identity, *authority, *revoked, certificate, role);
  if (common_name_of(*identity) != common_name(role, rig))
    throw Error(
        fmt::format("{} is for '{}', required: '{}'. Keys are valid for one role of one rig "
                    "(`voxtouch keys --rig {}`)",
                    certificate.string(), common_name_of(*identity), common_name(role, rig), rig));
  if (X509_check_private_key(identity.get(), key_of(read_private_file(key), key).get()) != 1)
    throw Error(fmt::format(
        "{} does not match cert.pem in the same folder. Copy both from one folder", key.string()));
  require_text(verified(read_file(may), *authority, may),
               permissions(role, rig, to_text(*X509_get0_notBefore(identity.get())),
                           to_text(*X509_get0_notAfter(identity.get()))),
               may, fmt::format("the {} of rig {}", role, rig));

  Properties properties{{"dds.sec.auth.identity_ca", file_value(ca)},
                        {"dds.sec.auth.identity_certificate", file_value(certificate)},
                        {"dds.sec.auth.private_key", file_value(key)},
                        {"org.eclipse.cyclonedds.sec.auth.crl", file_value(crl)},
                        {"dds.sec.access.permissions_ca", file_value(ca)},
                        {"dds.sec.access.governance", file_value(rules)},
                        {"dds.sec.access.permissions", file_value(may)}};
  for (const auto& [part, name, function] :
       {std::tuple("auth", "dds_security_auth", "authentication"),
        std::tuple("access", "dds_security_ac", "access_control"),
        std::tuple("crypto", "dds_security_crypto", "crypto")}) {
    const std::string library = fmt::format("dds.sec.{}.library.", part);
    properties.insert(properties.end(),
                      {{library + "path", plugin(name).string()},
                       {library + "init", fmt::format("init_{}", function)},
                       {library + "finalize", fmt::format("finalize_{}", function)}});
  }
  return properties;
}

}  // namespace voxtouch::security
