#include "nodes/rendering/pending_changes.hpp"

#include <algorithm>

namespace voxtouch::rendering_node {

bool PendingChanges::contains(std::uint64_t id) const {
  return std::ranges::any_of(
      all_, [&](const PendingChange& pending) { return pending.request.id == id; });
}

bool PendingChanges::hand_over(std::vector<PendingChange> requested, ChangeQueue& line) {
  std::vector<Change> changes;
  for (PendingChange& one : requested) {
    one.change.ticket = ticket_ + 1 + changes.size();
    one.change.epoch = epoch_;
    one.change.session = one.request.session;
    one.change.from_sample = one.request.from_sample;
    one.change.following = static_cast<std::uint32_t>(requested.size() - 1 - changes.size());
    changes.push_back(one.change);
  }
  if (!line.push(changes))
    return false;
  ticket_ += changes.size();
  for (PendingChange& one : requested) {
    // A change without a sample is applied after the waiting ones. Its report then names the same
    // sample.
    if (one.change.from_sample == 0)
      one.change.from_sample = last_sample();
    all_.push_back(std::move(one));
  }
  return true;
}

void PendingChanges::cancel(const std::string& refusal, ChangeQueue& line) {
  for (PendingChange& pending : all_)
    pending.refusal = refusal;
  line.cancel(ticket_);
}

PendingChange PendingChanges::take() {
  PendingChange oldest = std::move(all_.front());
  all_.pop_front();
  return oldest;
}

}  // namespace voxtouch::rendering_node
