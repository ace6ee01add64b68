#pragma once
/// The page of `up --view`: `voxtouch view` as a process of its own, whose end the ring does not notice.
#include <sys/types.h>

#include "nodes/runtime/options.hpp"

namespace voxtouch::cli {

class PageProcess {
 public:
  /// Shows the ring of `options` and the meshes of its scene. It tells its address on stderr. Throws std::runtime_error where it cannot be
  /// started.
  explicit PageProcess(const runtime::NodeOptions& options);
  /// Ends it.
  ~PageProcess();
  PageProcess(const PageProcess&) = delete;
  PageProcess& operator=(const PageProcess&) = delete;

 private:
  pid_t pid_ = 0;
};

}  // namespace voxtouch::cli
