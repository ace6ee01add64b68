#pragma once
/// Binds a role (device, rendering or coupling) to one participant.
#include <atomic>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "nodes/bus/following.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/participant_counts.hpp"

namespace voxtouch::runtime {

/// Binds a role to the participant that claims it.
/// A participant claims a role by its own node status and a writer on each topic of the role. The
/// status must carry the role's name, a session and the state starting, ready or running. A single
/// claimant is bound. If several claim the role, none is bound. In a ring that `voxtouch up`
/// started, only participants in its claim are bound.
/// In a ring started by hand a binding lasts for its session. If the participant leaves, the role
/// stays vacant until another session begins. Samples of all other participants are refused,
/// counted and reported by name.
/// The monitor thread owns the object; any thread may call `session`, `bound` and `binding_epoch`.
class RoleBinding {
 public:
  /// `inputs`: this node's readers of the role's topics. They follow the bound participant.
  RoleBinding(std::string role, std::vector<bus::Following*> inputs)
      : role_(std::move(role)),
        inputs_(std::move(inputs)) {}

  /// `session`: only participants that have confirmed it may claim; empty: for any session.
  void update(const NodeRegistry& registry, std::optional<std::uint64_t> session);

  bool bound() const noexcept { return bound_now_.load(std::memory_order_acquire); }
  const std::optional<bus::Guid>& participant() const noexcept { return participant_; }
  /// The session in which the bound participant left, in a ring started by hand. 0 if it did not
  /// leave or another session has begun.
  std::uint64_t lost_session() const noexcept { return lost_session_; }
  /// Session in the status of the bound participant; 0 if none is bound. Real-time safe.
  std::uint64_t session() const noexcept { return session_.load(std::memory_order_acquire); }
  /// A different number for each binding. Real-time safe.
  std::uint64_t binding_epoch() const noexcept {
    return binding_epoch_.load(std::memory_order_acquire);
  }
  /// Number of samples from other participants received while one was bound.
  std::uint64_t refused() const noexcept;
  /// Participants whose samples were refused, with counts, including departed ones.
  std::string refused_writers() const { return refused_from_.text(); }
  /// Describes conflicting claims and refused participants; empty if there are none.
  std::string diagnostic(const NodeRegistry& registry) const;

 private:
  bool is_claimed_by(const NodeReport& report) const;
  std::vector<bus::Guid> claimants(const NodeRegistry& registry,
                                   std::optional<std::uint64_t> session) const;
  void bind(const bus::Guid& participant);
  void release();
  void follow_again();
  void note_refused(const NodeRegistry& registry);
  void note_others(const NodeRegistry& registry);

  std::string role_;
  std::vector<bus::Following*> inputs_;
  std::optional<bus::Guid> participant_;
  std::vector<bus::Guid> conflicting_;  ///< two or more claimants, while none is bound
  ParticipantCounts refused_from_;
  std::set<bus::Guid> others_;  ///< present participants whose samples or claims have been refused
  std::uint64_t lost_session_ = 0;
  std::atomic<bool> bound_now_{false};
  std::atomic<std::uint64_t> session_{0}, binding_epoch_{0};
};

}  // namespace voxtouch::runtime
