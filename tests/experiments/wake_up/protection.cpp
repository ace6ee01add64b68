#include "tests/experiments/wake_up/protection.hpp"

#include <array>
#include <fstream>

#include "nodes/security/credentials.hpp"
#include "nodes/security/make_keys.hpp"

namespace voxtouch::wake_up {
namespace {

constexpr char kRole[] = "tool", kRig[] = "haptic";

struct Protection {
  const char *name, *message, *submessage, *payload;
};
constexpr std::array kProtections{
    Protection{"none", "NONE", "NONE", "NONE"},
    Protection{"payload", "NONE", "NONE", "ENCRYPT"},
    Protection{"submessage_signed", "NONE", "SIGN", "NONE"},
    Protection{"submessage", "NONE", "ENCRYPT", "NONE"},
    Protection{"message", "ENCRYPT", "NONE", "NONE"},
    Protection{"submessage_and_payload", "NONE", "ENCRYPT", "ENCRYPT"}};

void set(std::string& text, const std::string& element, const std::string& value) {
  const std::string open = "<" + element + ">";
  const auto from = text.find(open) + open.size();
  text.replace(from, text.find('<', from) - from, value);
}

void write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::trunc) << text;
}

}  // namespace

std::vector<std::string> protections() {
  std::vector<std::string> names;
  for (const Protection& one : kProtections)
    names.emplace_back(one.name);
  return names;
}

void make_keys_of(const std::string& protection, const std::filesystem::path& folder) {
  using namespace security;
  make_keys(folder, kRig, 2);
  const Signer authority{certificate_of(read_file(folder / "ca.cert.pem"), "ca"),
                         key_of(read_file(folder / kAuthorityKey), "key")};
  std::string rules =
      verified(read_file(folder / "governance.p7s"), *authority.certificate, "governance");
  std::string may = verified(read_file(folder / kRole / "permissions.p7s"), *authority.certificate,
                             "permissions");
  for (const Protection& one : kProtections) {
    if (one.name != protection)
      continue;
    set(rules, "rtps_protection_kind", one.message);
    set(rules, "metadata_protection_kind", one.submessage);
    set(rules, "data_protection_kind", one.payload);
  }
  set(may, "default", "ALLOW");
  write(folder / "own_rules.p7s", sign(authority, rules));
  write(folder / "own_permissions.p7s", sign(authority, may));
}

security::Properties protected_by(const std::filesystem::path& folder) {
  security::Properties properties = security::properties_of(folder, kRole, kRig);
  for (auto& [name, value] : properties) {
    if (name == "dds.sec.access.governance")
      value = "file:" + (folder / "own_rules.p7s").string();
    if (name == "dds.sec.access.permissions")
      value = "file:" + (folder / "own_permissions.p7s").string();
  }
  return properties;
}

}  // namespace voxtouch::wake_up
