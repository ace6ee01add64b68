// voxtouch_unauthorised DOMAIN [KEYS ROLE [FILE [OTHER_KEYS]]]: writes on every topic of the loop
// and claims every role, plain or with a certificate, until it is ended. With FILE, which it
// writes, its own DDS permits everything (see lawless_tool).
#include <fstream>
#include <optional>
#include <thread>

#include "nodes/bus/reader.hpp"
#include "nodes/console/log.hpp"
#include "nodes/security/key_folder.hpp"
#include "nodes/security/make_keys.hpp"
#include "tests/support/adversary.hpp"
#include "tests/support/stand_in.hpp"

namespace voxtouch::test {
namespace {

constexpr char kRig[] = "haptic";

using namespace security;

Signer authority_of(const std::filesystem::path& keys) {
  return {certificate_of(read_file(keys / "ca.cert.pem"), "ca"),
          key_of(read_file(keys / kAuthorityKey), "key")};
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

/// A tool's certificate used against the rules: its own DDS permits every topic. Either its local
/// rules say so, or, with keys of another authority, permissions for everything signed by that
/// authority.
Properties lawless_tool(const std::filesystem::path& keys, const std::filesystem::path& file,
                        const std::filesystem::path& other) {
  const Signer authority = authority_of(keys);
  const auto text_of = [&](const char* name) {
    return verified(read_file(keys / name), *authority.certificate, name);
  };
  Properties properties = properties_of(keys, "tool", kRig);
  const auto set = [&](std::string_view end, const std::filesystem::path& value) {
    for (auto& [name, old] : properties)
      if (name.ends_with(end))
        old = "file:" + value.string();
  };
  if (other.empty()) {
    std::ofstream(file) << sign(
        authority, replaced(text_of("governance.p7s"), "<enable_write_access_control>true<",
                            "<enable_write_access_control>false<"));
    set(".governance", file);
  } else {
    std::ofstream(file) << sign(authority_of(other), replaced(text_of("tool/permissions.p7s"),
                                                              "rt/haptic/rendering/change", "*"));
    set(".permissions", file), set(".permissions_ca", other / "ca.cert.pem"),
        set(".governance", other / "governance.p7s");
  }
  return properties;
}

/// Skips what its own DDS refuses.
template <class Write>
void attempt(const Write& write) {
  try {
    write();
  } catch (const bus::Error&) {
  }
}

/// On each of the loop's topics, a sample that would be accepted from the authorised node.
void write_everything(Adversary& a, const msg::DeviceState& newest) {
  msg::DeviceState s = newest;
  ++s.sequence_number, s.sample_time_ns += 1'000'000;
  attempt([&] { a.write(s); });
  msg::ContactState c{};
  c.session_id = s.session_id, c.sequence_number = s.sequence_number,
  c.sample_time_ns = s.sample_time_ns, c.wrench.force.z = 8.0;
  attempt([&] { a.write(c); });
  msg::ForceCommand f{};
  f.session_id = s.session_id, f.sequence_number = s.sequence_number,
  f.sample_time_ns = s.sample_time_ns;
  f.valid_until_ns = s.sample_time_ns + 10'000'000, f.wrench.force.z = 8.0;
  attempt([&] { a.write(f); });
  attempt([&] { a.write(stylus(s.session_id)); });
  for (const char* node : {"up", "device", "rendering", "coupling"})
    attempt([&] { a.claim(node, s.session_id); });
}

}  // namespace

int run(const std::vector<std::string>& arguments) {
  Properties properties;
  if (arguments.size() == 3)
    properties = properties_of(arguments[1], arguments[2], kRig);
  if (arguments.size() > 3)
    properties = lawless_tool(arguments[1], arguments[3], arguments.size() > 4 ? arguments[4] : "");
  Adversary unauthorised({static_cast<std::uint32_t>(std::stoul(arguments[0])),
                          "lo",
                          "unauthorised",
                          {},
                          {},
                          properties},
                         kRig);
  std::optional<bus::Reader<msg::DeviceState>> states;
  attempt([&] {
    states.emplace(unauthorised.participant(), qos::kDeviceState, kRig,
                   qos::profile(qos::ProfileId::kTap));
  });
  msg::DeviceState newest{};
  write_everything(unauthorised, newest);
  console::log("writes\n");
  for (;;) {
    while (states && states->take(newest)) {
    }
    write_everything(unauthorised, newest);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

}  // namespace voxtouch::test

int main(int argc, char** argv) {
  try {
    return voxtouch::test::run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    voxtouch::console::log("error: {}\n", error.what());
    return 1;
  }
}
