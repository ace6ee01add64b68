#pragma once
/// Ctrl-C and SIGTERM become a flag that loops look at.
#include <atomic>

namespace voxtouch::runtime {

/// Set by SIGINT and SIGTERM once `catch_signals` has been called. A second Ctrl-C does nothing more: the way out is short.
std::atomic<bool>& stop_requested() noexcept;
void catch_signals();
/// Asks the kernel to send this process SIGTERM when its parent dies, also by kill -9.
void die_with_parent();

}  // namespace voxtouch::runtime
