#include "tests/unit/driver_contract/heap_count.hpp"

#include <cstddef>
#include <cstdlib>

namespace {
thread_local bool t_counting = false;
thread_local long t_asked = 0;
}  // namespace

namespace voxtouch::contract {
void count_heap(bool on) noexcept { t_counting = on; }
long heap_count() noexcept { return t_asked; }
}  // namespace voxtouch::contract

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && defined(__GLIBC__)
bool voxtouch::contract::heap_is_counted() noexcept { return true; }
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* malloc(std::size_t size) {
  t_asked += t_counting;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  t_asked += t_counting;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  t_asked += t_counting;
  return __libc_realloc(old, size);
}
}
#else
bool voxtouch::contract::heap_is_counted() noexcept { return false; }
#endif
