#pragma once
/// Memory for large arrays with random access.
#include <cstddef>
#include <limits>
#include <new>
#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace voxtouch {

/// Requests pages of 2 MB for arrays of `kMinBytes` and more. With 4 kB pages, a random access
/// waits for page tables as long as for the memory. Without huge pages only the time changes.
/// Throws std::bad_alloc.
template <class T>
struct HugePages {
  using value_type = T;
  static constexpr std::size_t kPageBytes = std::size_t{1} << 21, kMinBytes = std::size_t{1} << 23;

  HugePages() = default;
  template <class U>
  HugePages(const HugePages<U>&) noexcept {}

  T* allocate(std::size_t count) {
    if (count > std::numeric_limits<std::size_t>::max() / sizeof(T))
      throw std::bad_array_new_length();
    const std::size_t bytes = count * sizeof(T);
    void* const memory = ::operator new(bytes, alignment(bytes));
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    if (bytes >= kMinBytes)
      static_cast<void>(::madvise(memory, bytes / kPageBytes * kPageBytes, MADV_HUGEPAGE));
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) noexcept {
    ::operator delete(memory, alignment(count * sizeof(T)));
  }

  friend bool operator==(const HugePages&, const HugePages&) noexcept { return true; }

 private:
  static std::align_val_t alignment(std::size_t bytes) noexcept {
    return std::align_val_t{bytes >= kMinBytes ? kPageBytes : std::size_t{64}};
  }
};

}  // namespace voxtouch
