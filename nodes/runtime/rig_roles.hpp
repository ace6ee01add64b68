#pragma once
/// Roles in a ring that `voxtouch up` started: only the participants that its RigClaim names may
/// take them.
#include <map>
#include <memory>
#include <set>
#include <string>

#include "nodes/bus/reader.hpp"

namespace voxtouch::runtime {

/// Used by one thread.
class RigRoles {
 public:
  /// Follows only the claims of the participant `up`.
  RigRoles(const bus::Participant& participant, const std::string& rig, const bus::Guid& up);
  /// Reads the new claims.
  void update();
  /// Whether the last claim gives the role `node` to `participant`.
  bool names(const std::string& node, const bus::Guid& participant) const;

 private:
  bus::Guid up_;
  std::unique_ptr<bus::Following> writers_;  // outlives the reader, which calls it
  bus::Reader<msg::RigClaim> reader_;
  std::map<std::string, std::set<bus::Guid>> roles_;
};

/// Converts a GUID to 32 hexadecimal digits and back; all zero for an invalid text.
std::string to_text(const bus::Guid& guid);
bus::Guid to_guid(const std::string& text);

}  // namespace voxtouch::runtime
