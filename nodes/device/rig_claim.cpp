#include "nodes/device/rig_claim.hpp"

namespace voxtouch::device_node {
namespace {

constexpr char kClaim[] = "answered_before_conflict";

}  // namespace

bool RigClaim::update(const runtime::NodeRegistry& registry, const bus::Guid& own,
                      std::uint64_t answered) {
  bool lost = false;
  conflicting_.clear();
  for (const runtime::NodeReport& other : registry.reports()) {
    if (other.node != "device" || other.participant == own || other.final())
      continue;
    conflicting_ = registry.name_of(other.participant);
    if (!claim_)
      claim_ = answered;
    const auto theirs = other.figures.find(kClaim);
    if (theirs == other.figures.end())
      continue;  // it has not seen this node yet
    const std::uint64_t count = runtime::as_count(theirs->second.value);
    lost |= count != *claim_ ? count > *claim_ : other.participant < own;
  }
  if (conflicting_.empty())
    claim_.reset();
  return lost;
}

void RigClaim::report_to(runtime::NodeReport& report) const {
  if (claim_)
    report.figures[kClaim] = {*claim_, "samples"};
}

}  // namespace voxtouch::device_node
