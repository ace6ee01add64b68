#pragma once
/// What `up` says of a scene and a machine before it starts: little, so that what matters is read.
#include <string>
#include <vector>

#include "nodes/runtime/realtime.hpp"

namespace voxtouch::cli {

/// How many warnings a start says in full.
inline constexpr std::size_t kWarningsAtStart = 2;

/// The lines to be said: the first warnings, and one that counts the others and names the verbs
/// that tell them.
std::vector<std::string> few_warnings(const std::vector<std::string>& warnings,
                                      const std::string& scene);

/// What the nodes will be refused, in one warning that names `voxtouch doctor`; empty where nothing
/// is. They keep each sentence in their statuses and say nothing themselves.
std::vector<std::string> warnings_of_machine(const runtime::RealtimeOptions& options);

}  // namespace voxtouch::cli
