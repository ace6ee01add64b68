#pragma once
/// Which samples of a stream a recording holds, by their own numbers: what never came is missed
/// too.
#include <cstdint>
#include <map>

namespace voxtouch::logger {

class SequenceCount {
 public:
  struct Count {
    std::uint64_t first = 0, next = 0, samples = 0;
    /// Numbers left out between the first and the last.
    std::uint64_t gaps() const noexcept { return next - first - samples; }
  };

  /// One that is to be written. Of what comes twice or late only the first counts.
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
  /// Zeros for a session that was not seen.
  Count of(std::uint64_t session) const {
    const auto found = sessions_.find(session);
    return found == sessions_.end() ? Count{} : found->second;
  }

 private:
  static constexpr std::size_t kMaxSessions =
      64;  ///< any participant may send any number: later ones are not counted
  std::map<std::uint64_t, Count> sessions_;
};

}  // namespace voxtouch::logger
