#pragma once
/// Lockstep: who must have matched whom before sample 0, and who is still there.
#include <functional>
#include <string>
#include <vector>

#include "nodes/runtime/options.hpp"
#include "nodes/runtime/roster.hpp"

namespace voxtouch::runtime {

/// One endpoint of this node and the nodes that must be at its other end.
struct Link {
  std::string what;  ///< the topic, for people
  std::function<std::vector<bus::Guid>()> matched;
  std::vector<std::string> nodes;
};

/// Keeps only the nodes that take part in this run ("device" always does).
std::vector<std::string> taking_part(const NodeOptions& options, std::vector<std::string> nodes);

/// What is still missing, for people: "validator on rendering/contact". Empty when every link has matched all its nodes; in real
/// time nobody is waited for, so it is always empty there.
std::string missing_links(const NodeOptions& options, const Roster& roster, const std::vector<Link>& links);

}  // namespace voxtouch::runtime
