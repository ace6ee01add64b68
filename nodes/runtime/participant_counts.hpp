#pragma once
/// What each of several participants did, for sentences that name them.
#include <cstdint>
#include <map>
#include <string>

#include "nodes/runtime/node_registry.hpp"

namespace voxtouch::runtime {

/// One thread. Allocates.
class ParticipantCounts {
 public:
  static constexpr std::size_t kMaxNamed = 16;  ///< the first ones; the rest is counted as one

  /// The count of `participant`, to be added to or set; all zero: of those that have gone.
  std::uint64_t& of(const bus::Guid& participant);
  /// Takes the names that are known now; a name once known stays when its participant goes.
  void name(const NodeRegistry& registry);
  /// "721 of NAME and 3 of NAME"; empty if nothing was counted.
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
