#pragma once
/// Status line of a node that was started by hand, once a second: rate and force, in the format of
/// `voxtouch up`.
#include <cstdint>
#include <string>

#include "nodes/runtime/figure.hpp"

namespace voxtouch::runtime {

/// One line from the current figures and those of `seconds` earlier; empty while the node has
/// counted no sample.
std::string status_line(const std::string& node, const Figures& now, const Figures& before,
                        double seconds);

/// Prints the status line of a node at most once a second. Used by one thread.
class RateLine {
 public:
  RateLine(std::string node, bool enabled) : node_(std::move(node)), enabled_(enabled) {}
  void print(std::int64_t now_ns, const Figures& figures);

 private:
  const std::string node_;
  const bool enabled_;
  Figures last_;
  std::int64_t last_ns_ = 0;
};

}  // namespace voxtouch::runtime
