#pragma once
/// Accepts or refuses commands by writer, session and sequence. ForceGuard checks their content.
#include <cstdint>
#include <optional>

namespace voxtouch::devices {

enum class GateVerdict : std::uint8_t {
  kAccepted,
  kForeignWriter,   ///< another writer is followed and has not left
  kForeignSession,  ///< answers a sample of another device session
  kOldSequence,     ///< as old as the last accepted command, or older
  kFutureSequence,  ///< answers a sample that has not been given out yet; would lock out every
                    ///< command after it
};

/// A device session follows one writer: the first whose command is accepted. Each answer is taken
/// once and in order. Real-time safe.
class CommandGate {
 public:
  /// `session`: id of the device session.
  explicit CommandGate(std::uint64_t session) noexcept : session_(session) {}

  /// `writer`: whatever identifies the sender (a publication handle). `newest_sample`: the last
  /// sequence number that the device has given out. A refused command changes nothing.
  GateVerdict accept(std::uint64_t writer, std::uint64_t session, std::uint64_t sequence,
                     std::uint64_t newest_sample) noexcept;

  /// The writer has left: the next accepted command of any writer takes its place. Sequence numbers
  /// continue.
  void release_writer() noexcept { writer_.reset(); }
  std::optional<std::uint64_t> writer() const noexcept { return writer_; }
  std::optional<std::uint64_t> last_sequence() const noexcept { return last_; }

 private:
  std::uint64_t session_;
  std::optional<std::uint64_t> writer_, last_;
};

}  // namespace voxtouch::devices
