#include "nodes/rendering/change_line.hpp"

namespace voxtouch::rendering_node {

void ChangeLine::report(ChangeReport::What what, const Change& change, std::uint64_t sample) noexcept {
  reports_.push({what, change.ticket, sample, epoch_, change.scene});
}

void ChangeLine::retire(rendering::LiveScene& live) noexcept {
  // An update server that has not looked for long must not cost a scene's memory: it is asked for again when there is room.
  if (reports_.room() == 0) return;
  if (rendering::BuiltScene* scene = live.retired()) reports_.push({ChangeReport::What::kRetired, 0, 0, epoch_, scene});
}

void ChangeLine::rest(rendering::LiveScene& live) noexcept {
  if (!moving_ || reports_.room() == 0 || !live.effects().at_rest()) return;
  moving_ = false;
  reports_.push({ChangeReport::What::kAtRest, applied_, 0, epoch_, nullptr});
}

void ChangeLine::apply_due(rendering::LiveScene& live, std::uint64_t next, bool at_sample) noexcept {
  retire(live);
  rest(live);
  const bool judged = session_ == 0 || good_for_.load(std::memory_order_acquire) == session_;
  while (const Change* change = changes_.front()) {
    if (reports_.room() < 2) return;
    if (change->epoch != epoch_) {
      report(ChangeReport::What::kDropped, *change, next);
    } else if (change->session != 0 && change->session != session_) {
      ++epoch_;  // what is behind it was judged as if it had been applied
      report(ChangeReport::What::kDropped, *change, next);
    } else if (change->ticket <= cancelled_.load(std::memory_order_acquire)) {
      ++epoch_;
      report(ChangeReport::What::kDropped, *change, next);
    } else if (!judged || change->from_sample > next || (change->from_sample > 0 && !at_sample) ||
               (change->scene && live.fading())) {
      return;
    } else if (change->from_sample > 0 && change->from_sample < next) {
      ++epoch_;
      report(ChangeReport::What::kLate, *change, next);
    } else {
      if (change->scene)
        live.swap_to(*change->scene);
      else
        live.effects().carry_out(change->effect);
      moving_ |= !change->scene && change->effect.action == effects::EffectAction::kValue;
      applied_ = change->ticket;
      report(ChangeReport::What::kApplied, *change, next);
    }
    changes_.pop();
  }
}

void ChangeLine::begin_session(std::uint64_t session) noexcept {
  if (session_ != 0 && changes_.front()) ++epoch_;
  session_ = session;
  answering_.store(0, std::memory_order_seq_cst);
}

}  // namespace voxtouch::rendering_node
