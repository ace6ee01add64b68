#pragma once
/// A recording with this build's answers in place of the recorded ones: what another build, or a
/// later one, is compared with.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::replay {

/// What a replay made, by session and sample: of each command as many as the bag has of it.
struct Answers {
  using Key = std::pair<std::uint64_t, std::uint64_t>;
  std::map<Key, msg::ContactState> contacts;
  std::map<Key, std::vector<msg::ForceCommand>> commands;
};

/// Copies `bag` to the new folder `folder`, with each contact and command of `rig` as `answers` has
/// it; those that were not made again are left out, all else stays as it was recorded. Throws
/// std::runtime_error, a sentence: the folder exists, or the disk refuses.
void write_replayed(const std::filesystem::path& bag, const std::string& rig,
                    const Answers& answers, const std::filesystem::path& folder);

}  // namespace voxtouch::replay
