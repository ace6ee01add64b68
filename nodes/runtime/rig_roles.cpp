#include "nodes/runtime/rig_roles.hpp"

#include <string.h>

#include <algorithm>
#include <charconv>
#include <cstring>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace voxtouch::runtime {

RigRoles::RigRoles(const bus::Participant& participant, const std::string& rig, const bus::Guid& up)
    : up_(up),
      writers_(std::make_unique<bus::Following>(bus::Following::WhileUnbound::kTakeAll)),
      reader_(participant, qos::kRigClaim, rig, qos::profile(qos::ProfileId::kStatus),
              writers_.get()) {}

void RigRoles::update() {
  constexpr int kMaxTakes = 64;
  constexpr std::size_t kMaxName = 64;
  if (!writers_->has_writer())
    writers_->follow(up_);
  reader_.take_each(
      [this](const msg::RigClaim& claim, dds_instance_handle_t writer) {
        if (bus::participant_of_writer(reader_.get(), writer) != up_)
          return;
        roles_.clear();
        for (std::uint32_t i = 0; i < claim.roles._length; ++i) {
          const msg::RigRole& role = claim.roles._buffer[i];
          bus::Guid plays{};
          std::memcpy(plays.data(), role.participant, plays.size());
          if (role.node && ::strnlen(role.node, kMaxName) < kMaxName)
            roles_[role.node].insert(plays);
        }
      },
      kMaxTakes);
}

bool RigRoles::names(const std::string& node, const bus::Guid& participant) const {
  const auto found = roles_.find(node);
  return found != roles_.end() && found->second.contains(participant);
}

std::string to_text(const bus::Guid& guid) { return fmt::format("{:02x}", fmt::join(guid, "")); }

bus::Guid to_guid(const std::string& text) {
  bus::Guid guid{};
  if (text.size() != 2 * guid.size())
    return guid;
  for (std::size_t i = 0; i < guid.size(); ++i) {
    const char* const digits = text.data() + 2 * i;
    if (std::from_chars(digits, digits + 2, guid[i], 16).ptr != digits + 2)
      return {};
  }
  return guid;
}

}  // namespace voxtouch::runtime
