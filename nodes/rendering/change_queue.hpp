#pragma once
/// Lock-free queues for validated changes to the loop and for its reports.
#include <atomic>
#include <cstdint>
#include <optional>
#include <span>

#include "core/effects/effect_change.hpp"
#include "core/rendering/live_scene.hpp"
#include "nodes/runtime/spsc_queue.hpp"

namespace voxtouch::rendering_node {

/// One validated change.
struct Change {
  std::uint64_t ticket = 0;       ///< counts from 1
  std::uint64_t session = 0;      ///< 0: any session
  std::uint64_t from_sample = 0;  ///< 0: as soon as possible
  std::uint64_t epoch = 0;        ///< as last reported; changes of older epochs are dropped
  std::uint32_t following = 0;    ///< number of queued changes that are applied in the same sample
  effects::EffectCommand effect;
  /// Replaces the running scene; `effect` is then unused.
  rendering::BuiltScene* scene = nullptr;
};

struct ChangeReport {
  enum class What : std::uint8_t {
    kApplied,  ///< in effect from `sample` on
    kLate,     ///< its sample had passed: not applied
    kDropped,  ///< an earlier change was not applied, or another session has begun
    kRetired,  ///< `scene` is not rendered any longer
    kAtRest,   ///< the ramps of all effects have ended
  } what = What::kApplied;
  std::uint64_t ticket = 0, sample = 0;
  std::uint64_t epoch = 0;  ///< epoch from this report on
  rendering::BuiltScene* scene = nullptr;
  std::uint64_t session = 0;  ///< of `sample`; 0: no session has begun
};

/// Carries changes from the update server, which validates them, to the loop, which applies them.
/// Changes are applied in order. A change that waits for its sample delays those behind it, so each
/// one meets the values that it was validated with. In a session, the loop applies a change only
/// after the update server has validated all pending changes for the session's device.
/// Each method belongs to one thread: the update server or the loop.
class ChangeQueue {
 public:
  static constexpr std::size_t kCapacity = 64;

  // Called by the update server.
  bool push(const Change& change) noexcept { return changes_.push(change); }
  bool push(std::span<const Change> changes) noexcept { return changes_.push(changes); }
  /// Takes the oldest report. Returns false if there is none.
  bool next_report(ChangeReport& report) noexcept {
    const ChangeReport* oldest = reports_.front();
    if (!oldest)
      return false;
    report = *oldest;
    reports_.pop();
    return true;
  }
  void acknowledge(std::uint64_t ticket) noexcept {
    acknowledged_.store(ticket, std::memory_order_release);
  }
  /// Confirms that all pending changes are valid for the device of this session.
  void approve(std::uint64_t session) noexcept {
    approved_session_.store(session, std::memory_order_release);
  }
  /// Drops the pending changes up to and including this ticket.
  void cancel(std::uint64_t ticket) noexcept {
    cancelled_.store(ticket, std::memory_order_release);
  }
  /// Lockstep: makes the loop wait at this sample until `resume`.
  void pause_before(std::uint64_t sample) noexcept {
    pause_.store(sample, std::memory_order_seq_cst);
  }
  void resume() noexcept { pause_.store(kNoPause, std::memory_order_seq_cst); }
  /// The sample that the loop is answering or has answered last.
  std::uint64_t answering() const noexcept { return answering_.load(std::memory_order_seq_cst); }

  // Called by the loop. All real-time safe.
  /// Applies due changes between two samples. `at_sample`: sample `next` has arrived, so changes
  /// that wait for a sample may apply.
  void apply_due(rendering::LiveScene& live, std::uint64_t next, bool at_sample) noexcept;
  /// Drops changes that wait for a sample of the previous session. Changes queued while no session
  /// had begun remain.
  void begin_session(std::uint64_t session) noexcept;
  /// Ticket of the last applied change; 0 if there is none.
  std::uint64_t applied() const noexcept { return applied_; }
  /// Whether the update server has acknowledged all tickets up to this one.
  bool is_acknowledged(std::uint64_t ticket) const noexcept {
    return acknowledged_.load(std::memory_order_acquire) >= ticket;
  }
  /// Publishes `sample` as the one being answered. Returns whether the loop must wait before it.
  bool announce_sample(std::uint64_t sample) noexcept {
    answering_.store(sample, std::memory_order_seq_cst);
    return sample >= pause_.load(std::memory_order_seq_cst);
  }

 private:
  void retire(rendering::LiveScene& live) noexcept;
  void rest(rendering::LiveScene& live) noexcept;
  static constexpr std::uint64_t kNoPause = ~std::uint64_t{0};
  void report(ChangeReport::What what, const Change& change, std::uint64_t sample) noexcept;
  std::optional<ChangeReport::What> outcome_of(const Change& change,
                                               const rendering::LiveScene& live, std::uint64_t next,
                                               bool at_sample) const noexcept;
  void apply(const Change& change, rendering::LiveScene& live) noexcept;

  runtime::SpscQueue<Change, kCapacity> changes_;
  runtime::SpscQueue<ChangeReport, 4 * kCapacity> reports_;
  std::atomic<std::uint64_t> acknowledged_{0}, pause_{kNoPause}, answering_{0},
      approved_session_{0}, cancelled_{0};
  std::uint64_t applied_ = 0, epoch_ = 0, session_ = 0;
  bool ramping_ = false;  ///< an effect is ramping
};

}  // namespace voxtouch::rendering_node
