#include "tests/support/heap_count/heap_count.hpp"

#include <atomic>
#include <cstdlib>
#include <stdexcept>

namespace {

std::atomic<bool> all_threads{false};
thread_local bool this_thread = false;
std::atomic<long> calls{0};
std::atomic<std::size_t> bytes_asked{0};

[[maybe_unused]] void note(std::size_t bytes) noexcept {
  if (!this_thread && !all_threads.load(std::memory_order_relaxed))
    return;
  calls.fetch_add(1, std::memory_order_relaxed);
  bytes_asked.fetch_add(bytes, std::memory_order_relaxed);
}

}  // namespace

namespace voxtouch::test {

void heap_count::begin(HeapOf whose) {
  this_thread = true;
  calls = 0;
  void* volatile probe = std::malloc(16);
  std::free(probe);
  const bool seen = calls > 0;
  all_threads = whose == HeapOf::kAllThreads;
  this_thread = whose == HeapOf::kThisThread;
  calls = 0, bytes_asked = 0;
  if (!seen)
    throw std::logic_error("malloc is not counted");
}

HeapUse heap_count::end() noexcept {
  this_thread = false, all_threads = false;
  return {calls, bytes_asked};
}

}  // namespace voxtouch::test

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && defined(__GLIBC__)
bool voxtouch::test::heap_is_counted() noexcept { return true; }
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void* malloc(std::size_t size) { return note(size), __libc_malloc(size); }
void* calloc(std::size_t count, std::size_t size) {
  return note(count * size), __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) { return note(size), __libc_realloc(old, size); }
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return note(size), __libc_memalign(alignment, size);
}
}
#else
bool voxtouch::test::heap_is_counted() noexcept { return false; }
#endif
