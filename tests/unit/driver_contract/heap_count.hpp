#pragma once
/// Counts what this thread asks of the heap, beneath `operator new` too.
namespace voxtouch::contract {

bool heap_is_counted() noexcept;  ///< not under a sanitiser, which owns malloc
void count_heap(bool on) noexcept;
long heap_count() noexcept;

template <class Body>
long heap_count_of(Body body) {
  const long before = heap_count();
  count_heap(true);
  body();
  count_heap(false);
  return heap_count() - before;
}

}  // namespace voxtouch::contract
