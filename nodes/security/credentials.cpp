#include "nodes/security/credentials.hpp"

#include <ctime>

#include <openssl/bio.h>
#include <openssl/crypto.h>
#include <openssl/ec.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>

#include <fmt/format.h>

namespace voxtouch::security {
namespace {

using Bio = std::unique_ptr<BIO, Free<BIO_free_all>>;
using Stack =
    std::unique_ptr<STACK_OF(X509),
                    decltype([](STACK_OF(X509) * stack) { sk_X509_free(stack); })>;  // a macro
using Pkcs7 = std::unique_ptr<PKCS7, Free<PKCS7_free>>;
constexpr long kDay = 24 * 60 * 60;

/// Threads of DDS still decipher while a process exits. OpenSSL would have cleaned itself up under
/// them by then, and of ten secured rings one had a node that ended by signal 11. Only its first
/// call has an effect, so no thread waits for a second.
[[maybe_unused]] const int kNoCleanUpAtExit = OPENSSL_init_crypto(OPENSSL_INIT_NO_ATEXIT, nullptr);

/// For calls that OpenSSL should never refuse.
void require(bool worked, std::string_view what) {
  if (worked)
    return;
  const unsigned long code = ERR_get_error();
  ERR_clear_error();
  const char* const reason = ERR_reason_error_string(code);
  throw Error(fmt::format("Cannot make {} (OpenSSL: {})", what, reason ? reason : "nothing"));
}

Bio reading(const std::string& text) {
  Bio bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
  require(bio != nullptr, "a buffer");
  return bio;
}

std::string text_of(BIO& bio) {
  char* bytes = nullptr;
  const long size = BIO_get_mem_data(&bio, &bytes);
  return {bytes, static_cast<std::size_t>(std::max(size, 0L))};
}

template <class Write>
std::string written(std::string_view what, Write&& write) {
  const Bio bio(BIO_new(BIO_s_mem()));
  require(bio && write(bio.get()) == 1, what);
  return text_of(*bio);
}

template <class Owner, class Read>
Owner read(const std::string& pem, const std::filesystem::path& from, std::string_view what,
           Read&& read) {
  const auto no_password = [](char*, int, int, void*) {
    return -1;
  };  // never prompts on the terminal
  Owner owner(read(reading(pem).get(), nullptr, no_password, nullptr));
  ERR_clear_error();
  if (!owner)
    throw Error(fmt::format("No {1} in {0}. Copy the file again from the folder of `voxtouch keys`",
                            from.string(), what));
  return owner;
}

void add_extension(X509& certificate, int kind, const char* value) {
  const std::unique_ptr<X509_EXTENSION, Free<X509_EXTENSION_free>> one(
      X509V3_EXT_conf_nid(nullptr, nullptr, kind, value));
  require(one && X509_add_ext(&certificate, one.get(), -1) == 1, "a certificate");
}

void set_serial(X509& certificate) {
  unsigned char bytes[16];
  require(RAND_bytes(bytes, sizeof bytes) == 1, "a serial number");
  bytes[0] = static_cast<unsigned char>((bytes[0] & 0x7fU) | 0x40U);
  const std::unique_ptr<BIGNUM, Free<BN_free>> number(BN_bin2bn(bytes, sizeof bytes, nullptr));
  require(number && BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(&certificate)),
          "a serial number");
}

Certificate certify(EVP_PKEY& key, const std::string& common_name, int days, bool is_authority,
                    X509* issuer, EVP_PKEY& signing) {
  Certificate one(X509_new());
  require(one && X509_set_version(one.get(), X509_VERSION_3) == 1 &&
              X509_set_pubkey(one.get(), &key) == 1,
          "a certificate");
  set_serial(*one);
  X509_NAME* const name = X509_get_subject_name(one.get());
  require(X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC,
                                     reinterpret_cast<const unsigned char*>(common_name.c_str()),
                                     -1, -1, 0) == 1 &&
              X509_set_issuer_name(one.get(), issuer ? X509_get_subject_name(issuer) : name) == 1 &&
              X509_gmtime_adj(X509_getm_notBefore(one.get()), -kDay) &&
              X509_time_adj_ex(X509_getm_notAfter(one.get()), days, 0, nullptr),
          "a certificate");
  add_extension(*one, NID_basic_constraints,
                is_authority ? "critical,CA:TRUE" : "critical,CA:FALSE");
  add_extension(
      *one, NID_key_usage,
      is_authority ? "critical,keyCertSign,cRLSign,digitalSignature" : "critical,digitalSignature");
  require(X509_sign(one.get(), &signing, EVP_sha256()) > 0, "a certificate");
  return one;
}

}  // namespace

Key make_key() {
  Key key(EVP_EC_gen("prime256v1"));
  require(key != nullptr, "a key");
  return key;
}

std::string to_pem(EVP_PKEY& key) {
  return written("a key", [&](BIO* out) {
    return PEM_write_bio_PrivateKey(out, &key, nullptr, nullptr, 0, nullptr, nullptr);
  });
}
std::string to_pem(X509& certificate) {
  return written("a certificate", [&](BIO* out) { return PEM_write_bio_X509(out, &certificate); });
}
std::string to_pem(X509_CRL& list) {
  return written("a list", [&](BIO* out) { return PEM_write_bio_X509_CRL(out, &list); });
}

Key key_of(const std::string& pem, const std::filesystem::path& from) {
  return read<Key>(pem, from, "private key", PEM_read_bio_PrivateKey);
}
Certificate certificate_of(const std::string& pem, const std::filesystem::path& from) {
  return read<Certificate>(pem, from, "certificate", PEM_read_bio_X509);
}
RevocationList revocation_list_of(const std::string& pem, const std::filesystem::path& from) {
  return read<RevocationList>(pem, from, "list of revoked certificates", PEM_read_bio_X509_CRL);
}

Signer make_authority(const std::string& common_name, int days) {
  Signer made{nullptr, make_key()};
  made.certificate = certify(*made.key, common_name, days, true, nullptr, *made.key);
  return made;
}

Certificate issue(const Signer& authority, EVP_PKEY& key, const std::string& common_name,
                  int days) {
  return certify(key, common_name, days, false, authority.certificate.get(), *authority.key);
}

RevocationList make_revocation_list(const Signer& authority, X509_CRL* old, X509* revoked) {
  RevocationList list(old ? X509_CRL_dup(old) : X509_CRL_new());
  const std::unique_ptr<ASN1_TIME, Free<ASN1_TIME_free>> now(X509_gmtime_adj(nullptr, 0)),
      begin(X509_gmtime_adj(nullptr, -kDay));
  require(list && now && begin && X509_CRL_set_version(list.get(), X509_CRL_VERSION_2) == 1 &&
              X509_CRL_set_issuer_name(list.get(),
                                       X509_get_subject_name(authority.certificate.get())) == 1 &&
              X509_CRL_set1_lastUpdate(list.get(), begin.get()) == 1 &&
              X509_CRL_set1_nextUpdate(list.get(),
                                       X509_get0_notAfter(authority.certificate.get())) == 1,
          "a list of revoked certificates");
  if (revoked) {
    std::unique_ptr<X509_REVOKED, Free<X509_REVOKED_free>> entry(X509_REVOKED_new());
    require(entry &&
                X509_REVOKED_set_serialNumber(entry.get(), X509_get_serialNumber(revoked)) == 1 &&
                X509_REVOKED_set_revocationDate(entry.get(), now.get()) == 1 &&
                X509_CRL_add0_revoked(list.get(), entry.get()) == 1,
            "a list of revoked certificates");
    (void)entry.release();  // the list has it
  }
  require(X509_CRL_sort(list.get()) == 1 &&
              X509_CRL_sign(list.get(), authority.key.get(), EVP_sha256()) > 0,
          "a list of revoked certificates");
  return list;
}

bool is_revoked(X509_CRL& list, X509& certificate) {
  X509_REVOKED* found = nullptr;
  return X509_CRL_get0_by_cert(&list, &found, &certificate) == 1;
}

std::string sign(const Signer& authority, const std::string& text) {
  // Not detached: a participant shows its permissions to all others before they have a common key.
  // In this form they are not plain text.
  const Pkcs7 signed_text(PKCS7_sign(authority.certificate.get(), authority.key.get(), nullptr,
                                     reading(text).get(), PKCS7_TEXT));
  require(signed_text != nullptr, "a signature");
  return written("a signature", [&](BIO* out) {
    return SMIME_write_PKCS7(out, signed_text.get(), nullptr, PKCS7_TEXT);
  });
}

std::string verified(const std::string& smime, X509& authority, const std::filesystem::path& from) {
  BIO* content = nullptr;
  const Pkcs7 signed_text(SMIME_read_PKCS7(reading(smime).get(), &content));
  const Bio owned(content), out(BIO_new(BIO_s_mem()));
  const Stack signers(sk_X509_new_null());
  const bool is_good = signed_text && out && signers &&
                       sk_X509_push(signers.get(), &authority) == 1 &&
                       PKCS7_verify(signed_text.get(), signers.get(), nullptr, content, out.get(),
                                    PKCS7_TEXT | PKCS7_NOVERIFY | PKCS7_NOINTERN) == 1;
  ERR_clear_error();
  if (!is_good)
    throw Error(
        fmt::format("{} is not signed by the CA of ca.cert.pem in the same folder (mixed or "
                    "changed files). Copy all files again from the folder of `voxtouch keys`",
                    from.string()));
  std::string text = text_of(*out);
  std::erase(text, '\r');  // S/MIME ends lines as mail does
  return text;
}

std::string common_name_of(X509& certificate) {
  char name[256] = {};
  X509_NAME_get_text_by_NID(X509_get_subject_name(&certificate), NID_commonName, name, sizeof name);
  return name;
}

std::string to_text(const ASN1_TIME& time) {
  std::tm utc{};
  char text[32] = {};
  if (ASN1_TIME_to_tm(&time, &utc) == 1)
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

bool is_over(const ASN1_TIME& time) { return X509_cmp_current_time(&time) < 0; }

}  // namespace voxtouch::security
