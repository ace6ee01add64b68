#pragma once
/// Keys, certificates and signed texts, with owners that free OpenSSL's objects. Every function
/// throws Error.
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include <openssl/evp.h>
#include <openssl/x509.h>

namespace voxtouch::security {

/// Missing, damaged or expired files, or files of another owner or with open rights. The text has
/// the path and the remedy.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

template <auto free>
struct Free {
  void operator()(auto* object) const noexcept { free(object); }
};
using Key = std::unique_ptr<EVP_PKEY, Free<EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, Free<X509_free>>;
using RevocationList = std::unique_ptr<X509_CRL, Free<X509_CRL_free>>;

Key make_key();  ///< elliptic curve prime256v1
std::string to_pem(EVP_PKEY& key);
std::string to_pem(X509& certificate);
std::string to_pem(X509_CRL& list);
/// `from` is named if the text has no key.
Key key_of(const std::string& pem, const std::filesystem::path& from);
Certificate certificate_of(const std::string& pem, const std::filesystem::path& from);
RevocationList revocation_list_of(const std::string& pem, const std::filesystem::path& from);

/// A certificate and the key that signs with it.
struct Signer {
  Certificate certificate;
  Key key;
};
/// An authority that signs itself.
Signer make_authority(const std::string& common_name, int days);
/// The certificate of `key`, signed by `authority`; valid from a day ago, since clocks of hosts
/// differ.
Certificate issue(const Signer& authority, EVP_PKEY& key, const std::string& common_name, int days);
/// Those revoked in `old` (may be null) and `revoked` (may be null), valid as long as the
/// authority.
RevocationList make_revocation_list(const Signer& authority, X509_CRL* old, X509* revoked);
/// Whether `list` names the certificate; the signature of the list itself is not checked here.
bool is_revoked(X509_CRL& list, X509& certificate);

/// S/MIME as DDS Security has it: the text and its signature in one.
std::string sign(const Signer& authority, const std::string& text);
/// The text signed by `authority`; `from` is named if the signature is invalid.
std::string verified(const std::string& smime, X509& authority, const std::filesystem::path& from);

/// Empty if there is none.
std::string common_name_of(X509& certificate);
/// "2026-01-31T12:00:00Z".
std::string to_text(const ASN1_TIME& time);
/// Whether `time` lies before now.
bool is_over(const ASN1_TIME& time);

}  // namespace voxtouch::security
