#pragma once
/// What a scene file may say, for editors: a JSON schema. Keys come from keys.hpp and effects from
/// the table of their kinds, so one that is added is in it without a further word; a test compares
/// it with what the reader allows.
#include <string>

namespace voxtouch::scene {

/// JSON Schema, draft 2020-12, indented, with a line break at its end; the same bytes each time. It
/// says less than the reader where a schema cannot: that files are there, that quaternions have
/// unit length, that names differ.
std::string scene_schema();

}  // namespace voxtouch::scene
