#include "nodes/rendering/change_queue.hpp"

namespace voxtouch::rendering_node {

void ChangeQueue::report(ChangeReport::What what, const Change& change,
                         std::uint64_t sample) noexcept {
  reports_.push({what, change.ticket, sample, epoch_, change.scene, session_});
}

void ChangeQueue::retire(rendering::LiveScene& live) noexcept {
  // Without room for a report the scene is retired in a later cycle, so no report is lost.
  if (reports_.room() == 0)
    return;
  if (rendering::BuiltScene* scene = live.retired())
    reports_.push({ChangeReport::What::kRetired, 0, 0, epoch_, scene, session_});
}

void ChangeQueue::rest(rendering::LiveScene& live) noexcept {
  if (!ramping_ || reports_.room() == 0 || !live.effects().at_rest())
    return;
  ramping_ = false;
  reports_.push({ChangeReport::What::kAtRest, applied_, 0, epoch_, nullptr, session_});
}

/// Returns nothing while the change must wait. A change that is not applied ends the epoch, because
/// the changes queued behind it were validated as if it had been applied.
std::optional<ChangeReport::What> ChangeQueue::outcome_of(const Change& change,
                                                          const rendering::LiveScene& live,
                                                          std::uint64_t next,
                                                          bool at_sample) const noexcept {
  using What = ChangeReport::What;
  const bool judged =
      session_ == 0 || approved_session_.load(std::memory_order_acquire) == session_;
  if (change.epoch != epoch_ || (change.session != 0 && change.session != session_))
    return What::kDropped;
  if (change.ticket <= cancelled_.load(std::memory_order_acquire))
    return What::kDropped;
  if (!judged || change.from_sample > next || (change.from_sample > 0 && !at_sample) ||
      (change.scene && live.fading()))
    return {};
  return change.from_sample > 0 && change.from_sample < next ? What::kLate : What::kApplied;
}

void ChangeQueue::apply(const Change& change, rendering::LiveScene& live) noexcept {
  if (change.scene)
    live.swap_to(*change.scene);
  else
    live.effects().carry_out(change.effect);
  ramping_ |= !change.scene && change.effect.action == effects::EffectAction::kValue;
  applied_ = change.ticket;
}

void ChangeQueue::apply_due(rendering::LiveScene& live, std::uint64_t next,
                            bool at_sample) noexcept {
  retire(live);
  rest(live);
  while (const Change* change = changes_.front()) {
    const std::uint32_t count = 1 + change->following;
    if (reports_.room() < 1 + count)
      return;
    const std::optional<ChangeReport::What> fate = outcome_of(*change, live, next, at_sample);
    if (!fate)
      return;
    if (*fate != ChangeReport::What::kApplied && change->epoch == epoch_)
      ++epoch_;
    for (std::uint32_t n = 0; n < count; ++n) {
      change = changes_.front();
      if (*fate == ChangeReport::What::kApplied)
        apply(*change, live);
      report(*fate, *change, next);
      changes_.pop();
    }
  }
}

void ChangeQueue::begin_session(std::uint64_t session) noexcept {
  if (session_ != 0 && changes_.front())
    ++epoch_;
  session_ = session;
  answering_.store(0, std::memory_order_seq_cst);
}

}  // namespace voxtouch::rendering_node
