#pragma once
/// What one rendering takes over from the one that it stands by for: when the session began, and the energy that was supplied before.
#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::rendering_node {

/// Moving objects are where they are by the time since the session began, and the coupling books what `supplied_energy_j` rises by: neither may
/// jump where another rendering goes on. The loop's, but for `known`. Real-time safe.
class SessionOfAnother {
 public:
  void begin() noexcept {
    known_.store(false, std::memory_order_release);
    recent_ = {};
    offset_j_ = 0.0;
  }
  /// Whether this session's begin is known: this node has answered a sample itself, or has heard the other one do so.
  bool known() const noexcept { return known_.load(std::memory_order_acquire); }

  /// Once: when the session began, on the device's clock [ns], by an answer of the other one.
  std::optional<std::int64_t> session_begin(const msg::ContactState& theirs) noexcept {
    if (known() || (theirs.flags & msg::contact_state::kFlagRefusedSample) != 0) return std::nullopt;
    known_.store(true, std::memory_order_release);
    return theirs.sample_time_ns - theirs.scene_time_ns;
  }
  /// An answer of the other one to a sample that this node has rendered as well.
  void heed(const msg::ContactState& theirs) noexcept {
    const Supplied& own = recent_[theirs.sequence_number % recent_.size()];
    if (own.rendered && own.sequence == theirs.sequence_number) offset_j_ = theirs.supplied_energy_j - own.energy_j;
  }
  /// What this node has rendered, before `carried_on`; `sent`: it answers.
  void note(const msg::ContactState& own, bool sent) noexcept {
    recent_[own.sequence_number % recent_.size()] = {own.sequence_number, own.supplied_energy_j, true};
    if (sent && !known()) known_.store(true, std::memory_order_release);
  }
  /// As the other one would have gone on.
  msg::ContactState carried_on(msg::ContactState own) const noexcept {
    own.supplied_energy_j += offset_j_;
    return own;
  }

 private:
  struct Supplied {
    std::uint64_t sequence = 0;
    double energy_j = 0.0;
    bool rendered = false;
  };
  std::array<Supplied, 16> recent_{};  ///< the other one's answer comes up to some samples later
  double offset_j_ = 0.0;
  std::atomic<bool> known_{false};
};

}  // namespace voxtouch::rendering_node
