#pragma once
/// Counts the samples of a stream in a recording by their sequence numbers, so that samples that
/// never arrived count as missing.
#include <cstdint>
#include <map>

namespace voxtouch::logger {

class SequenceCount {
 public:
  struct Count {
    std::uint64_t first = 0, next = 0, samples = 0;
    /// Missing numbers between the first and the last.
    std::uint64_t gaps() const noexcept { return next - first - samples; }
  };

  /// Adds a recorded sample. Of repeated or late samples only the first counts.
  void add(std::uint64_t session, std::uint64_t sequence) {
    const auto [found, made] = sessions_.size() < kMaxSessions
                                   ? sessions_.try_emplace(session)
                                   : std::pair{sessions_.find(session), false};
    if (found == sessions_.end())
      return;
    Count& count = found->second;
    if (made)
      count.first = sequence;
    if (!made && sequence < count.next)
      return;
    count.next = sequence + 1;
    ++count.samples;
  }
  /// Zeros for an unknown session.
  Count of(std::uint64_t session) const {
    const auto found = sessions_.find(session);
    return found == sessions_.end() ? Count{} : found->second;
  }

 private:
  static constexpr std::size_t kMaxSessions =
      64;  ///< any participant may send any number; later sessions are not counted
  std::map<std::uint64_t, Count> sessions_;
};

}  // namespace voxtouch::logger
