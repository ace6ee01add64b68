#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "nodes/cli/verbs.hpp"
#include "nodes/console/log.hpp"
#include "nodes/runtime/options.hpp"
#include "nodes/security/documents.hpp"
#include "nodes/security/make_keys.hpp"

namespace voxtouch::cli {
namespace {

struct KeysOptions {
  std::filesystem::path folder;
  std::string rig = "haptic", renewed, revoked;
  int days = 365;
};

std::string new_keys_text(const KeysOptions& o) {
  const std::string folder = o.folder.string();
  return fmt::format(
      "Keys of rig {} are in {}, valid for {} days.\n"
      "  one host:       voxtouch up SCENE --security {}\n"
      "  several hosts:  copy ca.cert.pem, governance.p7s, crl.pem and the folders of the host's "
      "roles to each host.\n"
      "                  Roles: {} (`up`: voxtouch up; `tool`: every other verb)\n"
      "  keep private:   {} (CA key). Its holder can impersonate any node. Store this folder away "
      "from the nodes.\n",
      o.rig, folder, o.days, folder, fmt::join(security::roles(), ", "), security::kAuthorityKey);
}

int keys(const KeysOptions& o) {
  if (!o.revoked.empty()) {
    security::revoke_keys(o.folder, o.revoked);
    console::print_result(
        "The certificate of {} is revoked. Copy {} to each host's folder and restart the ring.\n",
        o.revoked, (o.folder / "crl.pem").string());
  }
  if (!o.renewed.empty()) {
    const std::string rig = security::renew_keys(o.folder, o.renewed, o.days);
    console::print_result(
        "New keys of {} of rig {} are valid for {} days. Copy governance.p7s and the role's folder "
        "from {} to its host,\n"
        "and restart its nodes. The previous certificate stays valid until it expires or is "
        "revoked.\n",
        o.renewed, rig, o.days, o.folder.string());
  }
  if (o.revoked.empty() && o.renewed.empty()) {
    security::make_keys(o.folder, o.rig, o.days);
    console::print_result("{}", new_keys_text(o));
  }
  return 0;
}

}  // namespace

void add_keys(CLI::App& app, Action& action) {
  auto o = std::make_shared<KeysOptions>();
  CLI::App* verb = app.add_subcommand("keys");
  std::vector<std::string> one_or_all = security::roles();
  one_or_all.emplace_back("all");
  verb->add_option("--out", o->folder, "Folder of the keys")->required()->option_text("DIR");
  verb->add_option("--rig", o->rig, "Rig of the keys")
      ->capture_default_str()
      ->check(runtime::check_rig);
  verb->add_option("--days", o->days,
                   "Validity of the certificates [days]; the CA's is ten times as long")
      ->capture_default_str()
      ->check(CLI::Range(1, 3650));
  verb->add_option("--renew", o->renewed,
                   fmt::format("Makes a new key, certificate and permissions for a role: {}",
                               fmt::join(one_or_all, ", ")))
      ->check(CLI::IsMember(one_or_all))
      ->option_text("ROLE");
  verb->add_option("--revoke", o->revoked,
                   "Revokes the role's current certificate (adds it to crl.pem)")
      ->check(CLI::IsMember(security::roles()))
      ->option_text("ROLE");
  verb->callback([o, &action] { action = [o] { return keys(*o); }; });
}

}  // namespace voxtouch::cli
