#include "tests/attack/kills/leftovers.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace voxtouch::attack {

std::set<std::string> shared_names() {
  std::set<std::string> names;
  std::vector<std::filesystem::path> folders{"/dev/shm", "/run/lock",
                                             std::filesystem::temp_directory_path()};
  if (const char* own = std::getenv("XDG_RUNTIME_DIR"))
    folders.emplace_back(own);
  for (const auto& folder : folders) {
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
      const std::string name = entry.path().filename().string();
      const bool ours = name.find("voxtouch") != std::string::npos ||
                        name.find("cyclone") != std::string::npos ||
                        name.find("iceoryx") != std::string::npos;
      if (ours && name.find("voxtouch_test_") == std::string::npos)
        names.insert(entry.path().string());
    }
  }
  std::ifstream sockets("/proc/net/unix");
  for (std::string line; std::getline(sockets, line);)
    if (const auto at = line.find("@voxtouch");
        at != std::string::npos && line.find("voxtouch test domain") == std::string::npos)
      names.insert(line.substr(at));
  return names;
}

namespace {

/// The sockets of this very process, by inode.
std::set<std::string> own_sockets() {
  std::set<std::string> inodes;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code error;
    const std::string target = std::filesystem::read_symlink(entry.path(), error).string();
    if (target.starts_with("socket:["))
      inodes.insert(target.substr(8, target.size() - 9));
  }
  return inodes;
}

}  // namespace

std::vector<int> bound_ports(std::uint32_t domain) {
  std::vector<int> bound;
  const std::set<std::string> own = own_sockets();
  const int first = 7400 + 250 * static_cast<int>(domain);
  std::ifstream sockets("/proc/net/udp");
  std::string line;
  std::getline(sockets, line);
  while (std::getline(sockets, line)) {
    const auto colon = line.find(':', line.find(':') + 1);
    const int port = static_cast<int>(std::strtol(line.substr(colon + 1, 4).c_str(), nullptr, 16));
    std::istringstream fields(line);
    std::string inode;
    for (int n = 0; n < 10; ++n)
      fields >> inode;
    if (port >= first && port < first + 250 && !own.contains(inode))
      bound.push_back(port);
  }
  return bound;
}

std::string program_of(pid_t pid) {
  std::ifstream command("/proc/" + std::to_string(pid) + "/cmdline");
  std::string program;
  std::getline(command, program, '\0');
  return std::filesystem::path(program).filename().string();
}

}  // namespace voxtouch::attack
