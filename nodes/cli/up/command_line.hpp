#pragma once
/// The command line of this process as words of its status, so that a bag states how its run is
/// repeated.
#include <map>
#include <string>
#include <vector>

namespace voxtouch::cli {

/// `words` as a shell reads them again, in pieces that fit a status: "command_00", "command_01",
/// ... and the folder that it was typed in as "folder". What would need more than 64 pieces is left
/// out: half a command is none.
std::map<std::string, std::string> command_words(const std::vector<std::string>& words,
                                                 const std::string& folder);

/// The words of this process.
std::vector<std::string> own_words();

}  // namespace voxtouch::cli
