#pragma once
/// Ctrl-C and SIGTERM become a flag that loops look at.
#include <atomic>

namespace voxtouch::runtime {

/// Set by SIGINT, SIGTERM, SIGHUP and SIGQUIT once `catch_signals` has been called: whatever ends a
/// program from a terminal must end it with the device at zero force. A second Ctrl-C does nothing
/// more: the way out is short.
std::atomic<bool>& stop_requested() noexcept;
/// Also lets SIGTERM through if the parent started this process with it blocked: what came
/// meanwhile counts.
void catch_signals();
/// Asks the kernel to send this process SIGTERM when `parent` dies, also by kill -9; at once if it
/// has died already.
void die_with_parent(int parent);

}  // namespace voxtouch::runtime
