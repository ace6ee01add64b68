#pragma once
/// Real-time scheduling of a process and its threads.
#include <optional>
#include <string>
#include <vector>

namespace voxtouch::runtime {

enum class Realtime {
  kOff,      ///< a tap must never delay the ring
  kIgnore,   ///< a refusal is recorded as a warning
  kEnforce,  ///< a refusal is an error
};

struct RealtimeOptions {
  Realtime mode = Realtime::kIgnore;
  int priority = 50;         ///< SCHED_FIFO; 0: ordinary priority, memory not locked
  std::optional<int> cpu{};  ///< pins the process
  /// Pins the threads that call `enter_loop`: loops of one process, which run in turn.
  std::optional<int> loop_cpu{};
};

/// Sets SCHED_FIFO, affinity and locked memory for the calling thread and all threads that it
/// starts. Call it first: the threads of a DDS participant inherit these settings. Not for taps.
/// Returns a sentence for each refusal, with its remedy. Throws std::runtime_error under kEnforce.
std::vector<std::string> enter_realtime(const RealtimeOptions& options);

/// The same sentences for a node that this process would start. Locks no memory and throws for no
/// refusal.
std::vector<std::string> refused_rights(const RealtimeOptions& options);

/// Sets the calling thread, which may have inherited SCHED_FIFO, to ordinary priority.
void ordinary_priority() noexcept;

/// Ordinary priority for a scope and all threads started in it. Used for long work that no sample
/// waits for and that would delay other loops on this machine.
class AtOrdinaryPriority {
 public:
  AtOrdinaryPriority() noexcept;
  ~AtOrdinaryPriority();
  AtOrdinaryPriority(const AtOrdinaryPriority&) = delete;
  AtOrdinaryPriority& operator=(const AtOrdinaryPriority&) = delete;

 private:
  int policy_, priority_;
};

/// For the calling thread. Operations on denormals take a hundred times longer than others.
void flush_denormals() noexcept;

/// Declares the calling thread a loop: it is pinned to `loop_cpu` if that is set and the thread has
/// SCHED_FIFO. A thread of ordinary priority would wait behind others there. Threads that it
/// started earlier are not pinned.
void enter_loop(const RealtimeOptions& options) noexcept;

}  // namespace voxtouch::runtime
