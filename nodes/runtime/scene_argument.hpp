#pragma once
/// Scenes on a command line: a file, or the name of a shipped scene, independent of the working
/// directory.
#include <string>
#include <vector>

namespace CLI {
class Validator;
}

namespace voxtouch::runtime {

/// Names of the shipped scenes, sorted; empty if their folder is missing.
std::vector<std::string> shipped_scenes();

/// A transformation for CLI11. It keeps the path of a file and replaces the name of a shipped scene
/// ("cup") by its path. Refuses other texts with a sentence that lists the names.
CLI::Validator scene_argument();

}  // namespace voxtouch::runtime
