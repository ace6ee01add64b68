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
      "Keys of rig {} are in {} and hold for {} days.\n"
      "  one host:       voxtouch up SCENE --security {}\n"
      "  several hosts:  copy ca.cert.pem, governance.p7s and crl.pem to a folder on each, and the "
      "folders of the roles that run there:\n"
      "                  {}; up is `voxtouch up`, tool every other verb\n"
      "  never copied:   {}, which signs all of it: who has it can be any node. Keep it and this "
      "folder where no node runs.\n",
      o.rig, folder, o.days, folder, fmt::join(security::roles(), ", "), security::kAuthorityKey);
}

int keys(const KeysOptions& o) {
  if (!o.revoked.empty()) {
    security::revoke_keys(o.folder, o.revoked);
    console::print_result(
        "The certificate of {} is revoked. Copy {} to the folder of every host and start the ring "
        "again there: it is read at the start.\n",
        o.revoked, (o.folder / "crl.pem").string());
  }
  if (!o.renewed.empty()) {
    const std::string rig = security::renew_keys(o.folder, o.renewed, o.days);
    console::print_result(
        "New keys of {} of rig {} hold for {} days. Copy governance.p7s and the folder of the role "
        "from {} to its host, and start what runs there "
        "again. The certificate of before holds until its end where it was not revoked.\n",
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
  verb->add_option("--rig", o->rig, "Rig whose topics the keys are for")
      ->capture_default_str()
      ->check(runtime::check_rig);
  verb->add_option("--days", o->days,
                   "How long certificates hold; the authority holds ten times as long")
      ->capture_default_str()
      ->check(CLI::Range(1, 3650));
  verb->add_option("--renew", o->renewed,
                   fmt::format("Makes a new key, certificate and permissions: {}",
                               fmt::join(one_or_all, ", ")))
      ->check(CLI::IsMember(one_or_all))
      ->option_text("ROLE");
  verb->add_option("--revoke", o->revoked,
                   "Puts the certificate that this role has now into crl.pem")
      ->check(CLI::IsMember(security::roles()))
      ->option_text("ROLE");
  verb->callback([o, &action] { action = [o] { return keys(*o); }; });
}

}  // namespace voxtouch::cli
