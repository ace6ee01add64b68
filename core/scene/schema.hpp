#pragma once
/// JSON schema of scene files, for editors. It is generated from keys.hpp and the table of effect
/// kinds; a test compares it with the reader.
#include <string>

namespace voxtouch::scene {

/// JSON Schema, draft 2020-12, indented, with a line break at its end; deterministic. It cannot
/// express some rules of the reader: existing files, quaternions of unit length, distinct names.
std::string scene_schema();

}  // namespace voxtouch::scene
