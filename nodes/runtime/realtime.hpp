#pragma once
/// Real-time scheduling of a process and its threads.
#include <optional>
#include <string>
#include <vector>

namespace voxtouch::runtime {

enum class Realtime {
  kOff,      ///< a tap must never take time from the ring
  kIgnore,   ///< a refusal is a recorded warning
  kEnforce,  ///< a refusal is an error
};

struct RealtimeOptions {
  Realtime mode = Realtime::kIgnore;
  int priority = 50;              ///< SCHED_FIFO; 0: ordinary, and memory stays unlocked
  std::optional<int> cpu{};       ///< pins the process
  std::optional<int> loop_cpu{};  ///< pins the threads that call `enter_loop`: loops of one
                                  ///< process, which take turns
};

/// SCHED_FIFO, affinity, locked memory for the calling thread and all it starts: call before the
/// participant is made, whose threads inherit. Not for taps. Returns a sentence for each refusal,
/// with what would allow it. Throws std::runtime_error under kEnforce.
std::vector<std::string> enter_realtime(const RealtimeOptions& options);

/// The same sentences for what a node would be refused that this process starts; locks no memory,
/// throws for no refusal.
std::vector<std::string> refused_rights(const RealtimeOptions& options);

/// For the calling thread, which may have inherited SCHED_FIFO.
void ordinary_priority() noexcept;

/// Ordinary priority for a scope, and for all threads started in it: for long work that no sample
/// waits for, which would delay the loops of other rigs on this machine.
class AtOrdinaryPriority {
 public:
  AtOrdinaryPriority() noexcept;
  ~AtOrdinaryPriority();
  AtOrdinaryPriority(const AtOrdinaryPriority&) = delete;
  AtOrdinaryPriority& operator=(const AtOrdinaryPriority&) = delete;

 private:
  int policy_, priority_;
};

/// In the calling thread: denormals cost a hundred times a normal operation.
void flush_denormals() noexcept;

/// The calling thread runs a loop from now on: it stays on `loop_cpu`, where there is one and it
/// has SCHED_FIFO. An ordinary thread would wait there behind others. Threads that it started
/// before stay free.
void enter_loop(const RealtimeOptions& options) noexcept;

}  // namespace voxtouch::runtime
