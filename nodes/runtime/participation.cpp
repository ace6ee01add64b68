#include "nodes/runtime/participation.hpp"

#include <algorithm>

namespace voxtouch::runtime {

std::vector<std::string> taking_part(const NodeOptions& options, std::vector<std::string> nodes) {
  std::erase_if(nodes, [&](const std::string& node) { return node != "device" && !options.has_peer(node); });
  return nodes;
}

bool all_linked(const NodeOptions& options, const Roster& roster, const std::vector<Link>& links) {
  if (!options.lockstep) return true;
  return std::all_of(links.begin(), links.end(), [&](const Link& link) {
    return has_matched(roster, link.matched(), taking_part(options, link.nodes));
  });
}

}  // namespace voxtouch::runtime
