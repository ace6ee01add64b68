#pragma once
/// Participants outside a ring that write on its own topics.
#include <map>
#include <set>
#include <vector>

#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer_discovery.hpp"
#include "nodes/cli/up/run_record.hpp"

namespace voxtouch::cli {

class ForeignWriters {
 public:
  ForeignWriters(const bus::Participant& participant, const std::string& rig);
  /// Stores all writers on the ring's topics, and their names while they are present.
  void poll(const runtime::NodeRegistry& registry);
  /// Those of participants that are not among `own`.
  std::vector<UnauthorisedWriter> found(const std::set<bus::Guid>& own) const;

 private:
  static constexpr std::size_t kMaxRemembered = 64;
  std::map<std::string, std::string> topics_;  ///< topics of the ring, by their DDS names
  bus::WriterDiscovery discovery_;
  bus::Reader<msg::Recover> recovers_;
  std::map<bus::Guid, UnauthorisedWriter> writers_;
};

}  // namespace voxtouch::cli
