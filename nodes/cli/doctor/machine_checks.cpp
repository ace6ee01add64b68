#include "nodes/cli/doctor/machine_checks.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "nodes/runtime/realtime.hpp"

namespace voxtouch::cli {
namespace {

namespace fs = std::filesystem;

/// The first line of a small file; empty if it does not exist.
std::string line_of(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> all;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    all.push_back(entry.path());
  std::ranges::sort(all);
  return all;
}

std::string text_of(rlim_t limit) {
  return limit == RLIM_INFINITY ? "unlimited" : fmt::to_string(limit);
}

struct UsbDevice {
  const char* vendor;
  const char* product;  ///< empty: any of this vendor
  const char* name;
};
/// Public drivers of the Touch have 2988 and, for older devices, 0301:2988; those of the Falcon
/// have 0403:cb48. 1451 is unconfirmed.
constexpr std::array kKnown{UsbDevice{"2988", "", "a 3D Systems Touch"},
                            UsbDevice{"0301", "2988", "a 3D Systems Touch"},
                            UsbDevice{"0403", "cb48", "a Novint Falcon"},
                            UsbDevice{"1451", "", "a Force Dimension device"}};

Finding found(const UsbDevice& known, const fs::path& device, const fs::path& root) {
  const std::string bus = line_of(device / "busnum"), number = line_of(device / "devnum");
  const fs::path node =
      root / "dev/bus/usb" / fmt::format("{:0>3}", bus) / fmt::format("{:0>3}", number);
  if (access(node.c_str(), R_OK | W_OK) == 0)
    return {Health::kGood, fmt::format("{} is on USB and accessible", known.name)};
  return {
      Health::kWarning,
      fmt::format("{} is on USB, but this user cannot open {}. Install "
                  "deploy/devices/99-voxtouch-phantom.rules, join group 'haptic' and reconnect it",
                  known.name, node.string())};
}

}  // namespace

Finding check_kernel(const fs::path& root) {
  const std::string release = line_of(root / "proc/sys/kernel/osrelease"),
                    version = line_of(root / "proc/version");
  if (line_of(root / "sys/kernel/realtime") == "1" || version.contains("PREEMPT_RT"))
    return {Health::kGood, fmt::format("kernel {} is a real-time kernel", release)};
  return {Health::kWarning,
          fmt::format("Kernel {} is not a real-time kernel: samples may be late by milliseconds. "
                      "On Debian, install linux-image-rt-amd64 and reboot",
                      release)};
}

Finding check_limits() {
  rlimit priority{}, memory{};
  getrlimit(RLIMIT_RTPRIO, &priority);
  getrlimit(RLIMIT_MEMLOCK, &memory);
  const std::string text = fmt::format("limits of this user: rtprio {}, memlock {} bytes",
                                       text_of(priority.rlim_cur), text_of(memory.rlim_cur));
  const bool enough =
      priority.rlim_cur >= static_cast<rlim_t>(runtime::RealtimeOptions{}.priority) &&
      memory.rlim_cur == RLIM_INFINITY;
  if (enough || geteuid() == 0)
    return {Health::kGood, text};
  return {Health::kWarning,
          text + fmt::format("; required: rtprio {}, memlock unlimited. Copy "
                             "deploy/services/99-voxtouch-realtime.conf to /etc/security/limits.d, "
                             "join its group and log in again",
                             runtime::RealtimeOptions{}.priority)};
}

Finding check_governors(const fs::path& root) {
  std::set<std::string> governors;
  for (const fs::path& cpu : entries_of(root / "sys/devices/system/cpu"))
    if (const std::string governor = line_of(cpu / "cpufreq/scaling_governor"); !governor.empty())
      governors.insert(governor);
  if (governors.empty())
    return {Health::kGood, "CPU governor: not available (usual in a virtual machine)"};
  if (governors == std::set<std::string>{"performance"})
    return {Health::kGood, "CPU governor: performance"};
  return {Health::kWarning, fmt::format("CPU governor: {}; frequency scaling delays samples. Run "
                                        "`cpupower frequency-set -g performance`",
                                        fmt::join(governors, ", "))};
}

std::vector<Finding> check_link(std::string_view card, const fs::path& root) {
  const fs::path folder = root / "sys/class/net" / card;
  std::error_code error;
  if (fs::exists(folder / "wireless", error))
    return {
        {Health::kWarning, fmt::format("Card {} is wireless: samples may be late by tens of "
                                       "milliseconds. Use a cable for a ring over several hosts",
                                       card)}};
  const std::string text = line_of(folder / "speed");
  const long speed = std::strtol(text.c_str(), nullptr, 10);
  if (speed > 0 && speed < 100)
    return {{Health::kWarning, fmt::format("Card {} runs at {} Mbit/s; a ring over several hosts "
                                           "needs 100 or more. Check cable and switch",
                                           card, speed)}};
  return {};
}

std::vector<Finding> check_devices(const fs::path& root) {
  std::vector<Finding> findings;
  for (const fs::path& device : entries_of(root / "sys/bus/usb/devices")) {
    const std::string vendor = line_of(device / "idVendor"),
                      product = line_of(device / "idProduct");
    const auto known = std::ranges::find_if(kKnown, [&](const UsbDevice& d) {
      return vendor == d.vendor && (*d.product == '\0' || product == d.product);
    });
    if (known != kKnown.end())
      findings.push_back(found(*known, device, root));
  }
  const auto has_library = [&](const char* folder) {
    return std::ranges::any_of(entries_of(root / folder), [](const fs::path& file) {
      return file.filename().string().starts_with("libHD.so");
    });
  };
  const bool library = std::ranges::any_of(
      std::array{"usr/lib", "usr/lib64", "usr/local/lib", "usr/lib/x86_64-linux-gnu"}, has_library);
  if (!findings.empty() && !library)
    findings.push_back({Health::kWarning,
                        "libHD.so not found in the usual folders: `--device phantom` needs "
                        "OpenHaptics (deploy/devices/phantom.md)"});
  if (findings.empty())
    findings.push_back({Health::kGood,
                        "no haptic device on USB (other connections are not checked; simulated "
                        "devices need none)"});
  return findings;
}

}  // namespace voxtouch::cli
