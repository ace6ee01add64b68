#include "devices/command_gate.hpp"

namespace voxtouch::devices {

GateVerdict CommandGate::accept(std::uint64_t writer, std::uint64_t session, std::uint64_t sequence,
                                std::uint64_t newest_sample) noexcept {
  // The session is checked first, so a writer that only answers foreign sessions is not followed.
  if (session != session_)
    return GateVerdict::kForeignSession;
  if (writer_ && *writer_ != writer)
    return GateVerdict::kForeignWriter;
  if (sequence > newest_sample)
    return GateVerdict::kFutureSequence;
  if (last_ && sequence <= *last_)
    return GateVerdict::kOldSequence;
  writer_ = writer;
  last_ = sequence;
  return GateVerdict::kAccepted;
}

}  // namespace voxtouch::devices
