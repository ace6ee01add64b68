#include "tests/hard/geometry/allocated.hpp"

#include <cstdlib>
#include <new>

namespace {
thread_local std::size_t bytes_so_far = 0;
}

std::size_t voxtouch::hard::allocated_here() noexcept { return bytes_so_far; }

void* operator new(std::size_t bytes) {
  bytes_so_far += bytes;
  if (void* memory = std::malloc(bytes ? bytes : 1)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
