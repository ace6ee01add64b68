#include "nodes/runtime/participant_counts.hpp"

#include <fmt/format.h>

namespace voxtouch::runtime {

std::uint64_t& ParticipantCounts::of(const bus::Guid& participant) {
  if (all_.size() >= kMaxNamed && !all_.contains(participant))
    return further_;
  return all_[participant].count;
}

void ParticipantCounts::name(const NodeRegistry& registry) {
  for (auto& [participant, one] : all_) {
    if (participant == bus::Guid{})
      one.name = "a participant that has left";
    else if (one.name.empty() || !registry.known_name_of(participant).empty())
      one.name = registry.name_of(participant);
  }
}

std::string ParticipantCounts::text() const {
  std::string text;
  const auto add = [&](std::uint64_t count, const std::string& name) {
    if (count > 0)
      text += fmt::format("{}{} of {}", text.empty() ? "" : " and ", count, name);
  };
  for (const auto& [participant, one] : all_)
    add(one.count, one.name);
  add(further_, "further participants");
  return text;
}

}  // namespace voxtouch::runtime
