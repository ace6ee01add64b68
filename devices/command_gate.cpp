#include "devices/command_gate.hpp"

namespace voxtouch {

std::string_view name_of(GateVerdict verdict) noexcept {
  switch (verdict) {
    case GateVerdict::kAccepted: return "accepted";
    case GateVerdict::kForeignWriter: return "foreign_writer";
    case GateVerdict::kForeignSession: return "foreign_session";
    case GateVerdict::kOldSequence: return "old_sequence";
    case GateVerdict::kFutureSequence: return "future_sequence";
  }
  return "unknown";
}

GateVerdict CommandGate::accept(std::uint64_t writer, std::uint64_t session, std::uint64_t sequence,
                                std::uint64_t newest_sample) noexcept {
  // The writer last of the three: one that only answers foreign sessions must not take the place.
  if (session != session_) return GateVerdict::kForeignSession;
  if (writer_ && *writer_ != writer) return GateVerdict::kForeignWriter;
  if (sequence > newest_sample) return GateVerdict::kFutureSequence;
  if (last_ && sequence <= *last_) return GateVerdict::kOldSequence;
  writer_ = writer;
  last_ = sequence;
  return GateVerdict::kAccepted;
}

}  // namespace voxtouch
