#pragma once
/// Threads for the builders in core, which create none.
#include "core/types/parallel.hpp"

namespace voxtouch::runtime {

/// Number of online processors, at least 1. An affinity mask is ignored.
std::size_t processors() noexcept;

/// A loop on `threads` threads; 1 uses the calling thread. The threads have ordinary priority, even
/// if the caller runs under SCHED_FIFO, and end with the loop. If bodies throw, the caller receives
/// the exception of the lowest index, as from a serial loop. Higher indices may then be skipped.
/// If no thread can be started, the calling thread does the work.
ParallelFor threaded_for(std::size_t threads = processors());

}  // namespace voxtouch::runtime
