#pragma once
/// Changes for the loop and its reports: plain numbers through queues without locks.
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
  std::uint64_t session = 0;      ///< 0: whichever runs
  std::uint64_t from_sample = 0;  ///< 0: at once
  std::uint64_t epoch = 0;        ///< as last reported; an older one is dropped
  std::uint32_t following = 0;    ///< so many behind it are made in the same sample, or none
  effects::EffectCommand effect;
  rendering::BuiltScene* scene = nullptr;  ///< replaces the one that runs; then `effect` is unused
};

struct ChangeReport {
  enum class What : std::uint8_t {
    kApplied,  ///< holds from `sample` on
    kLate,     ///< its sample had passed: not applied
    kDropped,  ///< a change before it was not applied, or another session has begun
    kRetired,  ///< `scene` is not rendered any more
    kAtRest,   ///< all ramps of the effects have ended
  } what = What::kApplied;
  std::uint64_t ticket = 0, sample = 0;
  std::uint64_t epoch = 0;  ///< from now on
  rendering::BuiltScene* scene = nullptr;
  std::uint64_t session = 0;  ///< of `sample`; 0: before any
};

/// From the update server, which validates, to the loop, which applies. Changes are made in order,
/// and one that waits for its sample delays those behind it: so each meets the values that it was
/// validated with. In a session none is made before the update server has judged, for its device,
/// what was requested before.
class ChangeQueue {
 public:
  static constexpr std::size_t kCapacity = 64;

  // Of the update server.
  bool ask(const Change& change) noexcept { return changes_.push(change); }
  bool ask(std::span<const Change> changes) noexcept { return changes_.push(changes); }
  /// The oldest report; false: there is none.
  bool next_report(ChangeReport& report) noexcept {
    const ChangeReport* oldest = reports_.front();
    if (!oldest)
      return false;
    report = *oldest;
    reports_.pop();
    return true;
  }
  void settle(std::uint64_t ticket) noexcept { settled_.store(ticket, std::memory_order_release); }
  /// All pending changes hold on the device of this session.
  void approve(std::uint64_t session) noexcept {
    approved_session_.store(session, std::memory_order_release);
  }
  /// Pending changes up to this ticket are dropped.
  void cancel(std::uint64_t ticket) noexcept {
    cancelled_.store(ticket, std::memory_order_release);
  }
  /// Lockstep: the loop answers no sample from this one on before `resume`.
  void pause_before(std::uint64_t sample) noexcept {
    pause_.store(sample, std::memory_order_seq_cst);
  }
  void resume() noexcept { pause_.store(kNoPause, std::memory_order_seq_cst); }
  /// The sample that is answered, or was last.
  std::uint64_t answering() const noexcept { return answering_.load(std::memory_order_seq_cst); }

  // Of the loop. All real-time safe.
  /// Between two samples. `at_sample`: the sample `next` is there, so that what waits for one may
  /// be taken.
  void apply_due(rendering::LiveScene& live, std::uint64_t next, bool at_sample) noexcept;
  /// Changes that wait for a sample of the last session are dropped; those from before any session
  /// stay.
  void begin_session(std::uint64_t session) noexcept;
  /// Ticket of the last applied change; 0: none.
  std::uint64_t applied() const noexcept { return applied_; }
  /// Whether the update server is done with this ticket and all before it.
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
  std::atomic<std::uint64_t> settled_{0}, pause_{kNoPause}, answering_{0}, approved_session_{0},
      cancelled_{0};
  std::uint64_t applied_ = 0, epoch_ = 0, session_ = 0;
  bool moving_ = false;  ///< effects ramp
};

}  // namespace voxtouch::rendering_node
