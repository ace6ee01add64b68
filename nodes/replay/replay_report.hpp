#pragma once
/// What a replay has shown, for people and as JSON.
#include <string>

#include <nlohmann/json.hpp>

#include "nodes/replay/replay.hpp"

namespace voxtouch::replay {

/// For a person, and for a machine.
std::string to_text(const Replayed& replayed);
nlohmann::ordered_json to_json(const Replayed& replayed);
/// What the plotting tool draws: the curves, and what stands next to them.
nlohmann::ordered_json to_plot(const Replayed& replayed);

}  // namespace voxtouch::replay
