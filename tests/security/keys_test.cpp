// Output of `voxtouch keys`, and refusal of incomplete folders: each fault is one sentence with the
// file and the remedy.
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <fstream>
#include <functional>

#include "nodes/security/documents.hpp"
#include "nodes/security/key_folder.hpp"
#include "nodes/security/make_keys.hpp"
#include "qos/services.hpp"
#include "tests/support/file_count.hpp"
#include "tests/support/process/process.hpp"

namespace voxtouch::security {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

fs::path fresh_keys(const TemporaryFolder& folder, const std::string& name = "keys",
                    const std::string& rig = "haptic") {
  make_keys(folder / name, rig, 30);
  return folder / name;
}

/// Why a role is refused; empty if it is not.
std::string refusal(const fs::path& folder, const std::string& role = "coupling",
                    const std::string& rig = "haptic") {
  try {
    properties_of(folder, role, rig);
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}

unsigned mode_of(const fs::path& file) {
  struct stat status {};
  return stat(file.c_str(), &status) == 0 ? status.st_mode & 0777U : 0;
}

void put(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::trunc) << text;
}

Signer authority_of(const fs::path& folder) {
  return {certificate_of(read_file(folder / "ca.cert.pem"), "ca"),
          key_of(read_file(folder / kAuthorityKey), "key")};
}

/// Names between <topic> and </topic> in one half of a permissions text.
std::string half(const std::string& text, const std::string& name) {
  const auto from = text.find("<" + name + ">");
  return text.substr(from, text.find("</" + name + ">") - from);
}

TEST(Keys, ArePrivateAndTakenForEveryRole) {
  const TemporaryFolder temporary;
  const fs::path folder = fresh_keys(temporary);
  EXPECT_EQ(mode_of(folder), 0700U);
  EXPECT_EQ(mode_of(folder / kAuthorityKey), 0600U);
  for (const std::string& role : roles()) {
    EXPECT_EQ(mode_of(folder / role / "key.pem"), 0600U) << role;
    EXPECT_EQ(refusal(folder, role), "") << role;
  }
  EXPECT_EQ(role_of("device"), "device");
  EXPECT_EQ(role_of("up"), "up");
  for (const char* reader : {"view", "status", "change", "doctor"})
    EXPECT_EQ(role_of(reader), kTool);
}

TEST(Keys, NeverOverwriteAndLeaveNothingOnFailure) {
  const TemporaryFolder temporary;
  const fs::path folder = fresh_keys(temporary);
  const std::string before = read_file(folder / "ca.cert.pem");
  EXPECT_THROW(make_keys(folder, "haptic", 30), Error);
  EXPECT_EQ(read_file(folder / "ca.cert.pem"), before);
  EXPECT_THROW(make_keys(temporary / "no" / "folder", "haptic", 30), Error);
  EXPECT_EQ(test::file_count(temporary.path()), 1U);
}

TEST(Permissions, AreThoseOfTheTableOfTopics) {
  const auto of = [](const std::string& role) { return permissions(role, "left", "a", "b"); };
  for (const qos::Topic& topic : qos::kTopics) {
    const std::string name = "<topic>" + qos::dds_name(topic, "left") + "</topic>";
    for (qos::Nodes bit = 1; bit & qos::kEveryNode; bit = static_cast<qos::Nodes>(bit << 1U)) {
      const std::string role = qos::names_of(bit).front(), text = of(role);
      EXPECT_EQ(half(text, "publish").contains(name), (topic.writers & bit) != 0) << role << name;
      EXPECT_TRUE((topic.readers & bit) == 0 || half(text, "subscribe").contains(name) ||
                  half(text, "subscribe").contains("<topic>*<"))
          << role << name;
    }
    EXPECT_EQ(half(of("tool"), "publish").contains(name), topic.path == "rendering/change" ||
                                                              topic.path == "recover" ||
                                                              topic.path == "external")
        << name;
    EXPECT_EQ(half(of("up"), "publish").contains(name),
              topic.path == "node_status" || topic.path == "rig_claim" ||
                  topic.path == "diagnostics" || topic.path == "rosout")
        << name;
  }
  const auto named = [](const std::string& name) { return "<topic>" + name + "</topic>"; };
  for (const qos::Service& service : qos::kServices)
    for (const std::string& node : qos::names_of(service.servers)) {
      const std::string asked = named(qos::request_name(service, "left", node)),
                        answered = named(qos::reply_name(service, "left", node));
      EXPECT_TRUE(half(of(node), "publish").contains(answered)) << answered;
      EXPECT_TRUE(half(of(node), "subscribe").contains(asked) ||
                  half(of(node), "subscribe").contains("<topic>*<"))
          << asked;
      EXPECT_TRUE(half(of("tool"), "publish").contains(asked)) << asked;
      for (const std::string& other : roles()) {
        if (other == node)
          continue;
        EXPECT_FALSE(half(of(other), "publish").contains(answered))
            << other << " answers as " << node;
        EXPECT_EQ(half(of(other), "publish").contains(asked), other == "tool") << other << asked;
      }
    }
  int commanding = 0;
  for (const std::string& role : roles())
    commanding += half(of(role), "publish").contains("coupling/command");
  EXPECT_EQ(commanding, 1) << "the coupling alone commands";
  EXPECT_FALSE(half(of("device"), "subscribe").contains("<topic>*<"));
  EXPECT_FALSE(half(of("coupling"), "subscribe").contains("coupling/command"));
  EXPECT_FALSE(half(of("rendering"), "subscribe").contains("rendering/contact"));
  EXPECT_FALSE(half(of("device"), "subscribe").contains("device/state"));
  EXPECT_FALSE(half(of("logger"), "publish").contains("device/state"));
}

TEST(KeyFolder, RefusesIncompleteKeys) {
  const TemporaryFolder temporary;
  const fs::path good = fresh_keys(temporary), other = fresh_keys(temporary, "other"),
                 folder = temporary / "spoiled";
  const Signer authority = authority_of(good);
  const auto spoiled = [&](const std::string& file, const std::string& words,
                           const std::function<void(const fs::path&)>& spoil) {
    fs::remove_all(folder);
    fs::copy(good, folder, fs::copy_options::recursive);
    ASSERT_EQ(refusal(folder), "");
    spoil(folder / file);
    const std::string why = refusal(folder);
    EXPECT_TRUE(why.contains((folder / file).string()) && why.contains(words))
        << file << ": " << why;
    EXPECT_FALSE(why.contains('\n')) << why;
  };
  const auto gone = [](const fs::path& file) { fs::remove(file); };
  const auto broken = [](const fs::path& file) { put(file, "nothing of use"); };
  const auto no_file = [](const fs::path& file) { fs::remove(file), fs::create_directory(file); };
  const auto swapped = [&](const fs::path& file) {
    fs::copy_file(other / fs::relative(file, folder), file, fs::copy_options::overwrite_existing);
  };
  for (const char* file : {"ca.cert.pem", "governance.p7s", "crl.pem", "coupling/cert.pem",
                           "coupling/key.pem", "coupling/permissions.p7s"}) {
    spoiled(file, "is missing", gone);
    spoiled(file, "read", no_file);
  }
  for (const char* file : {"ca.cert.pem", "crl.pem", "coupling/cert.pem", "coupling/key.pem"})
    spoiled(file, "No ", broken);
  for (const char* file : {"governance.p7s", "coupling/permissions.p7s"})
    spoiled(file, "signed", broken);
  spoiled("governance.p7s", "signed", swapped);
  spoiled("crl.pem", "signed", swapped);
  spoiled("coupling/permissions.p7s", "signed", swapped);
  spoiled("coupling/cert.pem", "signed by the CA", swapped);
  spoiled("coupling/key.pem", "does not match", swapped);
  spoiled("coupling/key.pem", "readable by other users", [](const fs::path& file) {
    fs::permissions(file, fs::perms::group_read, fs::perm_options::add);
  });
  spoiled("coupling/cert.pem", "'haptic.device'", [&](const fs::path& file) {
    fs::copy_file(good / "device/cert.pem", file, fs::copy_options::overwrite_existing);
  });
  spoiled("coupling/permissions.p7s", "does not match", [&](const fs::path& file) {
    fs::copy_file(good / "device/permissions.p7s", file, fs::copy_options::overwrite_existing);
  });
  spoiled("governance.p7s", "does not match",
          [&](const fs::path& file) {  // of the right authority, and too weak
            std::string weak = governance();
            for (std::size_t at; (at = weak.find("ENCRYPT")) != std::string::npos;)
              weak.replace(at, 7, "NONE");
            put(file, sign(authority, weak));
          });
  spoiled("coupling/cert.pem", "expired on", [&](const fs::path& file) {
    put(file, to_pem(*issue(authority, *key_of(read_file(good / "coupling/key.pem"), "key"),
                            "haptic.coupling", -1)));
  });
  spoiled("ca.cert.pem", "expired on", [](const fs::path& file) {
    put(file, to_pem(*make_authority("haptic.authority", -1).certificate));
  });
  EXPECT_TRUE(refusal(good, "coupling", "left").contains("'left.coupling'"))
      << refusal(good, "coupling", "left");
  EXPECT_TRUE(refusal(temporary / "nowhere").contains("nowhere"));
}

TEST(Keys, AreRevokedAndRenewed) {
  const TemporaryFolder temporary;
  const fs::path folder = fresh_keys(temporary, "keys", "left");
  const std::string lost = read_file(folder / "coupling/cert.pem");
  revoke_keys(folder, "coupling");
  EXPECT_TRUE(refusal(folder, "coupling", "left").contains("is revoked"))
      << refusal(folder, "coupling", "left");
  EXPECT_EQ(refusal(folder, "device", "left"), "");
  EXPECT_THROW(revoke_keys(folder, "coupling"), Error);
  EXPECT_EQ(renew_keys(folder, "coupling", 30), "left");
  EXPECT_EQ(refusal(folder, "coupling", "left"), "");
  revoke_keys(folder, "device");
  put(folder / "coupling/cert.pem", lost);
  EXPECT_TRUE(refusal(folder, "coupling", "left").contains("is revoked"))
      << "an earlier one stays revoked";
  renew_keys(folder, "all", 30);
  for (const std::string& role : roles())
    EXPECT_EQ(refusal(folder, role, "left"), "") << role;
  fs::remove_all(folder / "authority");
  EXPECT_THROW(renew_keys(folder, "all", 30), Error);
}

}  // namespace
}  // namespace voxtouch::security
