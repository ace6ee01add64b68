#pragma once
/// Counts heap allocations, beneath `operator new` too: Eigen calls malloc itself. Linking
/// `voxtouch_heap_count` replaces malloc, calloc, realloc and aligned_alloc for the whole program.
#include <cstddef>

namespace voxtouch::test {

struct HeapUse {
  long calls = 0;
  std::size_t bytes = 0;  ///< requested, including freed ones
};
enum class HeapOf { kThisThread, kAllThreads };

/// False under a sanitiser, which owns malloc: nothing can be counted then.
bool heap_is_counted() noexcept;

namespace heap_count {
/// Starts counting. Throws std::logic_error if a call of malloc is not observed.
void begin(HeapOf whose);
HeapUse end() noexcept;
}  // namespace heap_count

/// While `body` runs. One at a time.
template <class Body>
HeapUse heap_use_of(Body body, HeapOf whose = HeapOf::kThisThread) {
  heap_count::begin(whose);
  body();
  return heap_count::end();
}
template <class Body>
long heap_count_of(Body body, HeapOf whose = HeapOf::kThisThread) {
  return heap_use_of(body, whose).calls;
}

}  // namespace voxtouch::test
