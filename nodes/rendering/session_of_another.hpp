#pragma once
/// What one rendering takes over from the one that it stands by for: when the session began, and
/// the energy that was supplied before.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <optional>

#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::rendering_node {

/// Moving objects are where they are by the time since the session began, and the coupling books
/// what `supplied_energy_j` rises by: neither may jump where another rendering goes on. The loop's,
/// but for `known`. Real-time safe.
class SessionOfAnother {
 public:
  void begin() noexcept {
    known_.store(false, std::memory_order_release);
    recent_ = {};
    offset_j_ = 0.0;
    unlike_in_a_row_ = kMaxUnlike;
    agrees_.store(false, std::memory_order_release);
  }
  /// Whether this session's begin is known: this node has answered a sample itself, or has heard
  /// the other one do so.
  bool known() const noexcept { return known_.load(std::memory_order_acquire); }

  /// Once: when the session began, on the device's clock [ns], by an answer of the other one.
  std::optional<std::int64_t> session_begin(const msg::ContactState& theirs) noexcept {
    if (known() || (theirs.flags & msg::contact_state::kFlagRefusedSample) != 0)
      return std::nullopt;
    known_.store(true, std::memory_order_release);
    return theirs.sample_time_ns - theirs.scene_time_ns;
  }
  /// An answer of the other one to a sample that this node has rendered as well.
  void heed(const msg::ContactState& theirs) noexcept {
    const Supplied& own = recent_[theirs.sequence_number % recent_.size()];
    if (!own.rendered || own.sequence != theirs.sequence_number)
      return;
    offset_j_ = theirs.supplied_energy_j - own.energy_j;
    const auto &f = own.force, &g = theirs.wrench.force;
    const double apart_n = std::hypot(f.x - g.x, f.y - g.y, f.z - g.z);
    unlike_in_a_row_ = apart_n <= kAlikeN + kAlikeShare * std::hypot(g.x, g.y, g.z)
                           ? 0
                           : std::min(unlike_in_a_row_ + 1, kMaxUnlike);
    agrees_.store(unlike_in_a_row_ < kMaxUnlike, std::memory_order_release);
  }
  /// Whether what this node renders is what the other one does, by the samples that both have
  /// answered lately: else a takeover would be felt. A virtual tool that was placed within a
  /// contact gives no force, for one. Any thread.
  const std::atomic<bool>& agrees() const noexcept { return agrees_; }
  /// What this node has rendered, before `carried_on`; `sent`: it answers.
  void note(const msg::ContactState& own, bool sent) noexcept {
    recent_[own.sequence_number % recent_.size()] = {own.sequence_number, own.supplied_energy_j,
                                                     own.wrench.force, true};
    if (!sent)
      return;
    known_.store(true, std::memory_order_release);
    unlike_in_a_row_ = 0;
    agrees_.store(true, std::memory_order_release);
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
    msg::geometry_msgs_Vector3 force{};
    bool rendered = false;
  };
  static constexpr double kAlikeN = 0.05, kAlikeShare = 0.1;
  static constexpr int kMaxUnlike =
      8;  ///< in a row: one alone may be a sample that one of the two was not given
  std::array<Supplied, 16> recent_{};  ///< the other one's answer comes up to some samples later
  double offset_j_ = 0.0;
  int unlike_in_a_row_ = kMaxUnlike;
  std::atomic<bool> known_{false}, agrees_{false};
};

}  // namespace voxtouch::rendering_node
