#pragma once
/// Files and processes that a ring may leave on a machine.
#include <sys/types.h>

#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace voxtouch::attack {

/// The names that a ring could have left: shared memory, lock files and sockets of ours or of the
/// middleware, in the folders for such.
std::set<std::string> shared_names();

/// UDP ports of a DDS domain that a process other than this one holds.
std::vector<int> bound_ports(std::uint32_t domain);

/// The name of the program that runs as `pid`; empty if none.
std::string program_of(pid_t pid);

}  // namespace voxtouch::attack
