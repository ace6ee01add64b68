#pragma once
/// What the loop is asked to change, and what it says of it: plain numbers through queues without
/// locks.
#include <atomic>
#include <cstdint>
#include <optional>
#include <span>

#include "core/effects/effect_change.hpp"
#include "core/rendering/live_scene.hpp"
#include "nodes/runtime/spsc_queue.hpp"

namespace voxtouch::rendering_node {

/// One change that has been judged.
struct Change {
  std::uint64_t ticket = 0;       ///< counts from 1
  std::uint64_t session = 0;      ///< 0: whichever runs
  std::uint64_t from_sample = 0;  ///< 0: at once
  std::uint64_t epoch = 0;        ///< as the loop last said; a change of an older one is dropped
  std::uint32_t following = 0;  ///< so many behind it are made in the same sample as it, or none of
                                ///< all; of the last of them 0
  effects::EffectCommand effect;
  rendering::BuiltScene* scene =
      nullptr;  ///< takes the place of the one that runs; `effect` is not looked at then
};

struct ChangeReport {
  enum class What : std::uint8_t {
    kApplied,  ///< holds from `sample` on
    kLate,     ///< its sample had passed: not applied
    kDropped,  ///< what it was judged by is no more: a change before it was not applied, or another
               ///< session has begun
    kRetired,  ///< `scene` is not rendered any more
    kAtRest,   ///< all numbers of the effects have come to where they were to go
  } what = What::kApplied;
  std::uint64_t ticket = 0, sample = 0;
  std::uint64_t epoch = 0;  ///< from now on
  rendering::BuiltScene* scene = nullptr;
  std::uint64_t session = 0;  ///< of `sample`; 0: before any
};

/// Between the update server, which judges, and the loop, which applies. Changes are taken in the
/// order they were asked for, one that waits for its sample holds up those behind it: so each runs
/// on the values that it was judged by. In a session none is made before the update server has
/// judged, for its device, what was asked for before that device was known.
class ChangeLine {
 public:
  static constexpr std::size_t kCapacity = 64;

  // Of the update server.
  bool ask(const Change& change) noexcept { return changes_.push(change); }
  /// Several that the first one's `following` binds together.
  bool ask(std::span<const Change> changes) noexcept { return changes_.push(changes); }
  /// The oldest report that has not been fetched; false: there is none.
  bool next_report(ChangeReport& report) noexcept {
    const ChangeReport* oldest = reports_.front();
    if (!oldest)
      return false;
    report = *oldest;
    reports_.pop();
    return true;
  }
  void settle(std::uint64_t ticket) noexcept { settled_.store(ticket, std::memory_order_release); }
  /// All that has been asked for holds on the device of this session.
  void found_good_for(std::uint64_t session) noexcept {
    good_for_.store(session, std::memory_order_release);
  }
  /// What waits with a ticket up to this one is dropped.
  void cancel(std::uint64_t ticket) noexcept {
    cancelled_.store(ticket, std::memory_order_release);
  }
  /// Lockstep: the loop answers no sample from this one on before it is resumed.
  void pause_before(std::uint64_t sample) noexcept {
    pause_.store(sample, std::memory_order_seq_cst);
  }
  void resume() noexcept { pause_.store(kNoPause, std::memory_order_seq_cst); }
  /// The sample that is being answered, or was last.
  std::uint64_t answering() const noexcept { return answering_.load(std::memory_order_seq_cst); }

  // Of the loop. All real-time safe.
  /// Between two samples; the next has the number `next`. Only `at_sample` is it there, and what
  /// waits for a sample may be taken.
  void apply_due(rendering::LiveScene& live, std::uint64_t next, bool at_sample) noexcept;
  /// Another session: what waits for a sample of the last one is dropped, what was asked for before
  /// any session stays.
  void begin_session(std::uint64_t session) noexcept;
  /// Ticket of the last change that was applied; 0: none.
  std::uint64_t applied() const noexcept { return applied_; }
  /// Whether the update server is done with this ticket and all before it. Real-time safe.
  bool settled(std::uint64_t ticket) const noexcept {
    return settled_.load(std::memory_order_acquire) >= ticket;
  }
  bool pauses_before(std::uint64_t sample) noexcept {
    answering_.store(sample, std::memory_order_seq_cst);
    return sample >= pause_.load(std::memory_order_seq_cst);
  }

 private:
  void retire(rendering::LiveScene& live) noexcept;
  void rest(rendering::LiveScene& live) noexcept;
  static constexpr std::uint64_t kNoPause = ~std::uint64_t{0};
  void report(ChangeReport::What what, const Change& change, std::uint64_t sample) noexcept;
  std::optional<ChangeReport::What> fate_of(const Change& change, const rendering::LiveScene& live,
                                            std::uint64_t next, bool at_sample) const noexcept;
  void make(const Change& change, rendering::LiveScene& live) noexcept;

  runtime::SpscQueue<Change, kCapacity> changes_;
  runtime::SpscQueue<ChangeReport, 4 * kCapacity> reports_;
  std::atomic<std::uint64_t> settled_{0}, pause_{kNoPause}, answering_{0}, good_for_{0},
      cancelled_{0};
  std::uint64_t applied_ = 0, epoch_ = 0, session_ = 0;
  bool moving_ = false;  ///< numbers of the effects are on their way
};

}  // namespace voxtouch::rendering_node
