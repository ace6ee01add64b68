#pragma once
/// The command line of this process, as values of its status, so that a bag states how to repeat
/// its run.
#include <map>
#include <string>
#include <vector>

namespace voxtouch::cli {

/// `words` quoted for a shell, in pieces that fit a status: "command_00", "command_01", ... and the
/// working directory as "folder". A command of more than 64 pieces is omitted.
std::map<std::string, std::string> command_words(const std::vector<std::string>& words,
                                                 const std::string& folder);

/// The words of this process.
std::vector<std::string> own_words();

}  // namespace voxtouch::cli
