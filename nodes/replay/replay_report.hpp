#pragma once
/// The result of a replay, as text and as JSON.
#include <string>

#include <nlohmann/json.hpp>

#include "nodes/replay/replay.hpp"

namespace voxtouch::replay {

/// As text, and as JSON.
std::string to_text(const Replayed& replayed);
nlohmann::ordered_json to_json(const Replayed& replayed);
/// Input of the plotting tool: the curves with their texts.
nlohmann::ordered_json to_plot(const Replayed& replayed);

}  // namespace voxtouch::replay
