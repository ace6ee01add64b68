#include "nodes/runtime/realtime.hpp"

#include <dlfcn.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

namespace voxtouch::runtime {
namespace {

/// Returns 0 or errno: whether all memory may be locked.
int may_lock_memory() {
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  return limit.rlim_cur != RLIM_INFINITY && geteuid() != 0 ? EPERM : 0;
}

constexpr std::size_t kStackBytes = 1 << 20;

/// Locked memory is allocated in full at once. With the usual stack of 8 MB, ten DDS threads would
/// allocate 80 MB at the loop's priority.
void start_threads_with_small_stacks() {
  pthread_attr_t usual;
  if (pthread_getattr_default_np(&usual) != 0)
    return;
  pthread_attr_setstacksize(&usual, kStackBytes);
  pthread_setattr_default_np(&usual);
  pthread_attr_destroy(&usual);
}

/// Returns 0 or errno. Under a limit the lock is not attempted: with MCL_FUTURE, every later
/// allocation beyond the limit would fail.
int lock_memory() {
  if (const int error = may_lock_memory(); error != 0)
    return error;
  start_threads_with_small_stacks();
  return mlockall(MCL_CURRENT | MCL_FUTURE) == 0 ? 0 : errno;
}

/// Pins the calling thread and the threads that it starts later. Returns false with errno set on
/// failure.
bool stay_on(int cpu) noexcept {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<std::size_t>(cpu), &set);
  return sched_setaffinity(0, sizeof set, &set) == 0;
}

std::vector<std::string> take_rights(const RealtimeOptions& options, int (*lock)()) {
  std::vector<std::string> refused;
  // Locked first, at ordinary priority: it maps all memory, about 30 ms in which no loop of another
  // rig could run.
  if (const int error = options.priority > 0 ? lock() : 0; error != 0)
    refused.push_back(
        fmt::format("Cannot lock memory ({}): page faults may delay samples. Allow memlock in "
                    "/etc/security/limits.d (deploy/services/99-voxtouch-realtime.conf).",
                    std::strerror(error)));
  sched_param parameters{};
  parameters.sched_priority = options.priority;
  if (options.priority > 0 && sched_setscheduler(0, SCHED_FIFO, &parameters) != 0)
    refused.push_back(
        fmt::format("SCHED_FIFO priority {} refused ({}): samples may be late under load. Allow "
                    "rtprio in /etc/security/limits.d (deploy/services/99-voxtouch-realtime.conf).",
                    options.priority, std::strerror(errno)));
  if (options.cpu && !stay_on(*options.cpu))
    refused.push_back(fmt::format("Cannot pin to CPU {} ({}). `nproc` prints the number of CPUs.",
                                  *options.cpu, std::strerror(errno)));
  return refused;
}

}  // namespace

std::vector<std::string> refused_rights(const RealtimeOptions& options) {
  return take_rights(options, may_lock_memory);
}

std::vector<std::string> enter_realtime(const RealtimeOptions& options) {
  if (options.mode == Realtime::kOff)
    return {};
  std::vector<std::string> refused = take_rights(options, lock_memory);
  if (options.mode == Realtime::kEnforce && !refused.empty())
    throw std::runtime_error("--realtime enforce: " + refused.front());
  return refused;
}

void ordinary_priority() noexcept {
  const sched_param ordinary{};
  sched_setscheduler(0, SCHED_OTHER, &ordinary);
}

AtOrdinaryPriority::AtOrdinaryPriority() noexcept : policy_(sched_getscheduler(0)), priority_(0) {
  sched_param had{};
  if (sched_getparam(0, &had) == 0)
    priority_ = had.sched_priority;
  ordinary_priority();
}

AtOrdinaryPriority::~AtOrdinaryPriority() {
  sched_param had{};
  had.sched_priority = priority_;
  if (policy_ >= 0)
    sched_setscheduler(0, policy_, &had);
}

void flush_denormals() noexcept {
#if defined(__SSE2__)
  _mm_setcsr(_mm_getcsr() | 0x8040U);  // FTZ and DAZ
#endif
}

void enter_loop(const RealtimeOptions& options) noexcept {
  if (options.loop_cpu && sched_getscheduler(0) == SCHED_FIFO)
    stay_on(*options.loop_cpu);
}

}  // namespace voxtouch::runtime

// Cyclone DDS protects its handle table, its event queue and each writer by mutexes without
// attributes. A preempted thread of ordinary priority that holds one delays the loop: silences of
// 40 to 340 ms were measured while compilers ran. Mutexes created here inherit the priority of
// their waiters, so only threads of the ring can delay it. Sanitizers define their own
// pthread_mutex_init.
#if !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
extern "C" __attribute__((visibility("default"))) int pthread_mutex_init(
    pthread_mutex_t* mutex, const pthread_mutexattr_t* attributes) noexcept {
  using Init = int (*)(pthread_mutex_t*, const pthread_mutexattr_t*);
  static const Init init = reinterpret_cast<Init>(dlsym(RTLD_NEXT, "pthread_mutex_init"));
  if (attributes != nullptr)
    return init(mutex, attributes);
  pthread_mutexattr_t lending;
  pthread_mutexattr_init(&lending);
  pthread_mutexattr_setprotocol(&lending, PTHREAD_PRIO_INHERIT);
  const int error = init(mutex, &lending);
  pthread_mutexattr_destroy(&lending);
  return error;
}
#endif
