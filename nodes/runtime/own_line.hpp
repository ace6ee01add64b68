#pragma once
/// What a node that was started by hand says once a second: rate and force, as `voxtouch up` says
/// them of the whole ring.
#include <string>

#include "nodes/runtime/figure.hpp"

namespace voxtouch::runtime {

/// One line from the node's figures now and `seconds` before; empty where it counts nothing yet.
std::string own_line(const std::string& node, const Figures& now, const Figures& before,
                     double seconds);

}  // namespace voxtouch::runtime
