#pragma once
/// Scenes on a command line: a file, or the name of one that comes with voxtouch, found from any
/// folder.
#include <string>
#include <vector>

namespace CLI {
class Validator;
}

namespace voxtouch::runtime {

/// Names of the scenes that come with voxtouch, sorted; empty where their folder is missing.
std::vector<std::string> shipped_scenes();

/// For CLI11: leaves the path of a file as it is and makes the path of a shipped scene of its name
/// ("cup"). Refuses all else with a sentence that lists the names.
CLI::Validator scene_argument();

}  // namespace voxtouch::runtime
