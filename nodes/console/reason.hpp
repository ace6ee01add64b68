#pragma once
/// The sentence for an exception that ends a program or a request.
#include <exception>
#include <string>

namespace voxtouch::console {

/// For faults of the file system: the path, shortened, and the reason. For a thread that cannot be
/// created: the limits to check. Otherwise what().
std::string reason_of(const std::exception& error);

}  // namespace voxtouch::console
