#pragma once
/// The table of topics as Python text: the one file of the package of `voxtouch types` that the messages alone do not tell.
#include <string>

namespace voxtouch::cli {

/// `topics.py`: every row of qos/topics.hpp with its type and policies, and the network that the ring runs on.
std::string python_topics();

}  // namespace voxtouch::cli
