#pragma once
/// Threads for the builders in core, which know of none.
#include "core/types/parallel.hpp"

namespace voxtouch::runtime {

/// Processors that the calling thread may run on, at least 1.
std::size_t processors() noexcept;

/// A loop on so many threads (1: the caller's own). The threads are of ordinary priority, also
/// where the caller runs under SCHED_FIFO, and end with the loop. Where bodies throw, what the
/// lowest index threw reaches the caller, as from a loop without threads; indices above it may then
/// be left out. Throws std::system_error where no thread can be made.
ParallelFor threaded_for(std::size_t threads = processors());

}  // namespace voxtouch::runtime
