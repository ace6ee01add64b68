#pragma once
/// Counts per participant, for messages that name participants.
#include <cstdint>
#include <map>
#include <string>

#include "nodes/runtime/node_registry.hpp"

namespace voxtouch::runtime {

/// One thread. Allocates.
class ParticipantCounts {
 public:
  static constexpr std::size_t kMaxNamed = 16;  ///< named participants; the rest share one count

  /// The count of `participant`, to be added to or set. The zero GUID holds the counts of departed
  /// participants.
  std::uint64_t& of(const bus::Guid& participant);
  /// Queries the current names. A name is kept after its participant leaves.
  void name(const NodeRegistry& registry);
  /// For example "721 of NAME and 3 of NAME"; empty without counts.
  std::string text() const;

 private:
  struct One {
    std::string name;
    std::uint64_t count = 0;
  };
  std::map<bus::Guid, One> all_;
  std::uint64_t further_ = 0;
};

}  // namespace voxtouch::runtime
