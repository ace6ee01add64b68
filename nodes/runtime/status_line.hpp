#pragma once
/// What a node that was started by hand prints once a second: rate and force, as `voxtouch up`
/// prints them of the whole ring.
#include <cstdint>
#include <string>

#include "nodes/runtime/figure.hpp"

namespace voxtouch::runtime {

/// One line from the node's figures now and `seconds` before; empty where it counts nothing yet.
std::string status_line(const std::string& node, const Figures& now, const Figures& before,
                        double seconds);

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
