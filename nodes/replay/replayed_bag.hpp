#pragma once
/// A copy of a recording with this build's answers, for the comparison with another build.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::replay {

/// Results of a replay, by session and sample; as many of each command as in the bag.
struct Answers {
  using Key = std::pair<std::uint64_t, std::uint64_t>;
  std::map<Key, msg::ContactState> contacts;
  std::map<Key, std::vector<msg::ForceCommand>> commands;
};

/// Copies `bag` to the new folder `folder`, with each contact and command of `rig` replaced by that
/// of `answers`. Contacts and commands without an answer are omitted; all other messages are
/// copied. Throws std::runtime_error: the folder exists, or the disk refuses.
void write_replayed(const std::filesystem::path& bag, const std::string& rig,
                    const Answers& answers, const std::filesystem::path& folder);

}  // namespace voxtouch::replay
