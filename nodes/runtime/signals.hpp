#pragma once
/// SIGINT and SIGTERM set a flag that loops check.
#include <atomic>

namespace voxtouch::runtime {

/// Set by SIGINT, SIGTERM, SIGHUP and SIGQUIT after `catch_signals`. Every way to end a program
/// from a terminal must leave the device at zero force. A second SIGINT has no effect, since
/// shutdown is short.
std::atomic<bool>& stop_requested() noexcept;
/// Also unblocks SIGTERM if the parent blocked it at the start. A signal that arrived meanwhile is
/// delivered.
void catch_signals();
/// Requests SIGTERM from the kernel when `parent` ends, even by SIGKILL, and immediately if it has
/// already ended.
void die_with_parent(int parent);

}  // namespace voxtouch::runtime
