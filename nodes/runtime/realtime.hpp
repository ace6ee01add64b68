#pragma once
/// What a process asks of the kernel before it joins the ring.
#include <optional>
#include <string>
#include <vector>

namespace voxtouch::runtime {

enum class Realtime {
  kOff,      ///< do not ask: a tap must never take time from the ring
  kIgnore,   ///< try; what was refused becomes a recorded warning
  kEnforce,  ///< try; what was refused is an error
};

struct RealtimeOptions {
  Realtime mode = Realtime::kIgnore;
  int priority = 50;              ///< SCHED_FIFO; 0: ordinary, and memory stays unlocked
  std::optional<int> cpu{};       ///< pins the process; absent: the kernel chooses
  std::optional<int> loop_cpu{};  ///< where `enter_loop` pins a loop's thread, and nothing else:
                                  ///< loops of one process, which take turns
};

/// SCHED_FIFO, affinity, locked memory for the calling thread and all it starts (Cyclone DDS's
/// threads inherit): call before the participant is made. Not for taps (logger, validator). Returns
/// one sentence for each thing refused, with what would allow it. Throws std::runtime_error under
/// kEnforce.
std::vector<std::string> enter_realtime(const RealtimeOptions& options);

/// The same sentences, for the calling thread alone and without locking the process's memory: what
/// a node started by it would be refused. Never throws for a refusal.
std::vector<std::string> refused_rights(const RealtimeOptions& options);

/// Ordinary priority for the calling thread: whoever started it may run under SCHED_FIFO, which
/// threads inherit.
void ordinary_priority() noexcept;

/// Ordinary priority for the calling thread and all that it starts meanwhile, and then what the
/// thread had: for what takes long and no sample waits for. Under SCHED_FIFO it would keep the
/// loops of other rigs on this machine waiting.
class AtOrdinaryPriority {
 public:
  AtOrdinaryPriority() noexcept;
  ~AtOrdinaryPriority();
  AtOrdinaryPriority(const AtOrdinaryPriority&) = delete;
  AtOrdinaryPriority& operator=(const AtOrdinaryPriority&) = delete;

 private:
  int policy_, priority_;
};

/// Flush denormals to zero in the calling thread: they cost a hundred times a normal operation.
/// Call first in each loop thread.
void flush_denormals() noexcept;

/// The calling thread runs a loop from now on: stays on `loop_cpu`, where there is one and the
/// thread has SCHED_FIFO. An ordinary thread keeps its choice, for it would wait there behind
/// others. What the thread started before stays free.
void enter_loop(const RealtimeOptions& options) noexcept;

}  // namespace voxtouch::runtime
