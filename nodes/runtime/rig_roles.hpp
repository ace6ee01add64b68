#pragma once
/// Who plays which role in a ring that `voxtouch up` started: the participants that its RigClaim
/// names, and no others.
#include <map>
#include <memory>
#include <set>
#include <string>

#include "nodes/bus/reader.hpp"

namespace voxtouch::runtime {

/// Of one thread.
class RigRoles {
 public:
  /// Follows the claims of the participant `up` alone.
  RigRoles(const bus::Participant& participant, const std::string& rig, const bus::Guid& up);
  void update();
  bool names(const std::string& node, const bus::Guid& participant) const;

 private:
  bus::Guid up_;
  std::unique_ptr<bus::Following> writers_;  // outlives the reader, which asks it
  bus::Reader<msg::RigClaim> reader_;
  std::map<std::string, std::set<bus::Guid>> roles_;
};

/// A GUID as 32 hexadecimal digits, and back; all zero if `text` is none.
std::string to_text(const bus::Guid& guid);
bus::Guid to_guid(const std::string& text);

}  // namespace voxtouch::runtime
